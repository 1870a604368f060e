"""The extension that colours ``.cue`` files in JupyterLab, in which the workbench's own tokens do the colouring.

``python -m thermicon.notebooks.workbench.labextension`` writes it anew after a change of the language; a test compares.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

from .canvas import cue_words

ENTRY = "static/remoteEntry.js"


def entry_text() -> str:
    """Return the script that JupyterLab loads: the words of the language, the tokens, and the plugin.

    >>> entry_text().splitlines()[0]
    '(() => {'
    """
    notebooks = files("thermicon.notebooks")
    words = {name: value for name, value in cue_words().items() if name != "next"}
    tokens = (notebooks / "canvas_parts" / "highlight.js").read_text(encoding="utf-8")
    tokens = tokens[tokens.index("const NUMBER_PATTERN") : tokens.index("/** Where a column")]
    plugin = (notebooks / "labextension" / "entry.js").read_text(encoding="utf-8")
    constant = f"const CUE_WORDS = {json.dumps(words, ensure_ascii=False)};"
    return "\n".join(("(() => {", constant, tokens.strip(), plugin.strip(), "})();", ""))


if __name__ == "__main__":
    Path(str(files("thermicon.notebooks") / "labextension" / ENTRY)).write_text(entry_text(), encoding="utf-8")
