"""``thermicon lab``: the notebooks copied to a folder and opened in JupyterLab, or the workbench served as a page."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from thermicon.icons.atomic import check_folder, complete_or_absent, stopped_cleanly

from ..files.document import Document
from ..files.outputs import FILE, OBSERVER, PAGE_FOLDER, RIG
from ..messages import fail, interrupted, load_observer, load_rig, note, usage
from .options import flag, opt, out, rigs_like

FOLDER = Path("thermicon-notebooks")
FILES = (".cue", ".csv", ".ipynb", ".json", ".py", ".toml", ".txt")
"""Endings of files: who gives one wants something else than a folder of that name."""
CUE = ".cue"
FIRST, PAGE = "01_first_icon.ipynb", "workbench.ipynb"
PROMPT = "--ServerApp.kernel_websocket_connection_class=thermicon.notebooks.cli.prompt_socket.PromptSocket"
"""Option of JupyterLab by which answers of a kernel on this machine do not wait; a gateway has a socket of its own."""
ENDS_ITSELF_S, TIDIES_UP_S = 3.0, 10.0


def lab_command(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR",
            readable=False,
            help="Folder for the notebooks; it is created if missing. With --page also a cue file to work on.",
        ),
    ] = FOLDER,
    page: Annotated[
        bool, flag("--page", "Serve the workbench as a web page (with Voila) instead of opening JupyterLab.")
    ] = False,
    rig: Annotated[
        str | None, opt("RIG", "With --page: rig of the page, by name or path.", autocompletion=rigs_like)
    ] = None,
    observer: Annotated[
        Path | None,
        out("FILE", "With --page: predict with another observer, such as the lab.csv of pilot --keep.", "--observer"),
    ] = None,
    files_only: Annotated[bool, flag("--files-only", "Only copy the notebooks, for use in your own Jupyter.")] = False,
    no_browser: Annotated[bool, flag("--no-browser", "Print the address and open no browser.")] = False,
    port: Annotated[int | None, opt("N", "Port on this machine.  [default: 8888; 8866 with --page]", 1, 65535)] = None,
    allow_root: Annotated[bool, flag("--allow-root", "Let JupyterLab run as root, as in a container.")] = False,
    force: Annotated[bool, flag("--force", "Also replace notebooks that are there by the shipped ones.")] = False,
) -> None:
    """Copy the notebooks to a folder and open JupyterLab there; Ctrl-C stops it.

    Notebooks that are there already are kept.
    """
    if page and files_only:
        raise usage("opens nothing, so no page can be served", "--files-only")
    if rig is not None and not page:
        raise usage("is for --page; in a notebook, write Workbench(rig=...)", "--rig")
    file = folder if page and folder.suffix.lower() == CUE else None
    if observer is not None and not page:
        raise usage("is for --page; in a notebook, write Workbench(observer=...)", "--observer")
    if allow_root and (page or files_only):
        raise usage("is for JupyterLab; nothing else refuses to run as root", "--allow-root")
    if file is None and folder.suffix.lower() in FILES:
        raise usage(f"{str(folder)!r} is the name of a file, not of a folder; give one, such as {FOLDER}", "DIR")
    program = "voila" if page else "jupyterlab"
    if not files_only and find_spec(program) is None:
        extra = "thermicon[page]" if page else "jupyterlab"
        fail(f"{'--page' if page else 'lab'} needs {program}, which is not installed: pip install '{extra}'")
    if page:
        shown = page_environment(file or folder, file, rig, observer)
    if file is not None:
        serve_file(file, shown, no_browser, port)
        return
    written, kept = copy_notebooks(folder, force)
    there = f", {len(kept)} there already (--force replaces them)" if kept else ""
    note(f"{folder}: wrote {len(written)} notebooks{there}")
    if not files_only:
        command = command_of(folder, page, no_browser, port)
        serve([*command, *(["--allow-root"] if allow_root else [])], program, shown if page else {})


def page_environment(place: Path, file: Path | None, rig: str | None, observer: Path | None = None) -> dict[str, str]:
    """Environment of the kernels of a page: its folder, the cue file, the rig and the observer that it shows.

    Raises OutputError for a file, RigError for a rig, RecordError for an observer that cannot be read.
    """
    told = {PAGE_FOLDER: str((place if file is None else place.parent).resolve())}
    if file is not None:
        Document.open(file)
        told[FILE] = str(file.resolve())
    # The page says beside its curves what is doubtful about the module.
    used = load_rig(rig, [], module_matters=False) if rig is not None or observer is not None else None
    if observer is not None:
        load_observer(observer, used)
        told[OBSERVER] = str(observer.resolve())
    if rig is not None:
        told[RIG] = str(Path(rig).resolve()) if rig.endswith(".toml") else rig
    return told


def serve_file(file: Path, shown: Mapping[str, str], no_browser: bool, port: int | None) -> None:
    """Serve the workbench on one file; the notebook that it is made of stays out of the file's folder."""
    note(f"{file}: the page opens, saves and exports below {shown[PAGE_FOLDER]}")
    with tempfile.TemporaryDirectory(prefix="thermicon-page-", ignore_cleanup_errors=True) as own:
        (Path(own) / PAGE).write_bytes(shipped_notebooks()[PAGE])
        serve(command_of(Path(own), True, no_browser, port), "voila", shown)


def copy_notebooks(folder: Path, force: bool = False) -> tuple[list[str], list[str]]:
    """Put the shipped notebooks into a folder, which is made if missing; names of those written, and of those kept.

    All that are not there are written, or none; with ``force``, those too that are there. Raises OutputError where the
    folder cannot be used.
    """
    check_folder(folder)
    shipped = shipped_notebooks()
    kept = [name for name in shipped if (folder / name).exists() and not force]
    written = [name for name in shipped if name not in kept]
    made = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
        with stopped_cleanly(), ExitStack() as drafts:  # all are written before the first gets its name
            for name in written:
                drafts.enter_context(complete_or_absent(folder / name)).write_bytes(shipped[name])
    except BaseException:
        if made:
            with suppress(OSError):
                folder.rmdir()
        raise
    return written, kept


def shipped_notebooks() -> dict[str, bytes]:
    """The notebooks of this version by name, in order."""
    found = [path for path in resources.files("thermicon.notebooks").iterdir() if path.name.endswith(".ipynb")]
    return {path.name: path.read_bytes() for path in sorted(found, key=lambda path: path.name)}


def command_of(folder: Path, page: bool, no_browser: bool, port: int | None) -> list[str]:
    """The command that opens JupyterLab on the first notebook, or the page's server on the workbench, in a folder.

    With -P, Python imports nothing from the folder that it is started in.
    """
    module, notebook = ("thermicon.notebooks.cli.page_server", PAGE) if page else ("jupyterlab", FIRST)
    words = [sys.executable, "-P", "-m", module, str(folder.resolve() / notebook)]
    if not page and "JUPYTER_GATEWAY_URL" not in os.environ:
        words.append(PROMPT)
    words += ["--no-browser"] if no_browser else []
    return words + ([f"--port={port}"] if port is not None else [])


def serve(command: list[str], program: str, told: Mapping[str, str]) -> None:
    """Run a server until it ends or Ctrl-C ends it; it is given the time to stop its kernels.

    It runs in an empty folder, since servers of Jupyter take settings, which are programs, from where they are started;
    kernels run in the folder of their notebooks, and import nothing from there (PYTHONSAFEPATH).
    """
    note("press Ctrl-C to stop")
    own = {**os.environ, "PYTHONSAFEPATH": "1", **told}
    # Without a terminal to ask at, a server ends at once on Ctrl-C, which reaches it as well as this process.
    with (
        stopped_cleanly(),
        tempfile.TemporaryDirectory(prefix="thermicon-", ignore_cleanup_errors=True) as empty,
        subprocess.Popen(command, cwd=empty, env=own, stdin=subprocess.DEVNULL) as server,
    ):
        try:
            code = server.wait()
        except KeyboardInterrupt:
            for end, wait_s in ((server.terminate, ENDS_ITSELF_S), (server.kill, TIDIES_UP_S)):
                try:
                    server.wait(wait_s)
                    break
                except subprocess.TimeoutExpired:
                    end()
            raise interrupted() from None
    if code != 0:
        fail(f"{program} ended with an error (exit code {code}); its messages are above")
