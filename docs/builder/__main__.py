"""The build of the docs site: ``python docs/builder`` writes it to build/site/html without a warning.

``--no-execute`` leaves out what computes for minutes: outputs of the tutorials, predictions in the gallery,
pictures of pages.
"""

from __future__ import annotations

import argparse
import hashlib
import shutil
import sys
from pathlib import Path
from types import ModuleType
from typing import cast

from command_options import command_options
from data_tables import DATA_TABLES
from gallery import gallery
from key_tables import KEY_TABLES
from moving_percept import moving_percept
from paper_figures import circuit_diagram, paper_figures
from posterior_tables import TABLES as POSTERIOR_TABLES
from python_names import python_index, python_pages
from rig_stack import rig_stack
from staging import ROOT, Staging

from thermicon.perception.kernels.cluster import code_digest


def build(folder: Path, *, execute: bool) -> int:
    """Stage the sources below a folder, build the site there, and return Sphinx's exit code."""
    # The check of IRIs in jsonschema, which no page needs, builds 38 grammars on import: seconds of every build.
    sys.modules.setdefault("rfc3987_syntax", cast(ModuleType, None))
    from sphinx.cmd.build import build_main

    code = code_digest()
    gallery_digest = hashlib.sha256(code.encode() + Path(__file__).with_name("gallery.py").read_bytes()).hexdigest()
    kept = folder / "predicted" / gallery_digest[:16] if execute else None
    site = Staging(folder / "source", {}, kept)
    site.slots.update(POSTERIOR_TABLES | KEY_TABLES | DATA_TABLES)
    site.slots.update(
        {
            "options of commands": command_options,
            "python names": python_index,
            "gallery": lambda: gallery(kept, site.write),
            "paper figures": lambda: paper_figures(site.write),
            "circuit diagram": lambda: circuit_diagram(site.write),
            "moving percept": lambda: moving_percept(site.write),
            "rig stack": lambda: rig_stack(site.write),
        }
    )
    site.stage(dict(python_pages()))
    words = ["-b", "html", "-q", "-W", "--keep-going", "-t", "staged", "-c", str(ROOT / "docs")]
    words += ["-D", f"nb_execution_mode={'cache' if execute else 'off'}"]
    words += ["-D", f"nb_execution_cache_path={folder / 'executed' / code[:16]}"]
    doctrees = html_folder(folder, execute=execute).with_name("doctrees") / code[:16]
    for stale in set(doctrees.parent.glob("*")) - {doctrees}:  # what Sphinx has read shows another state of the program
        shutil.rmtree(stale)
    words += ["-d", str(doctrees), str(folder / "source"), str(html_folder(folder, execute=execute))]
    return build_main(words)


def html_folder(folder: Path, *, execute: bool) -> Path:
    """Return where the pages are written: those without outputs are kept away from the others."""
    return folder / "html" if execute else folder / "plain" / "html"


def main() -> int:
    """Read the command line and build."""
    parser = argparse.ArgumentParser(prog="python docs/builder", description="Build the docs site.")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build" / "site", help="folder for the site")
    parser.add_argument("--no-execute", action="store_true", help="leave out outputs, predictions and their pictures")
    chosen = parser.parse_args()
    code = build(chosen.output.resolve(), execute=not chosen.no_execute)
    if code == 0:
        sys.stderr.write(f"wrote {html_folder(chosen.output, execute=not chosen.no_execute) / 'index.html'}\n")
    return code


if __name__ == "__main__":
    sys.exit(main())
