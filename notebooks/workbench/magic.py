"""The ``%%cue`` cell magic for cue text in a notebook.

``%load_ext thermicon.notebooks`` switches it on, and small pictures of matplotlib figures with it.
"""

from __future__ import annotations

import inspect
import keyword
import re
from typing import TYPE_CHECKING, Any

from ..figures.print_figure import small_png

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from thermicon.icons import IconSet

DEFAULT_NAME = "cues"
# Blank lines and comments, then the word that begins a version line.
_VERSION = re.compile(r"(?:[ \t\u00a0\u202f]*(?:#[^\n]*)?[;\n])*[ \t\u00a0\u202f]*cue(?![^\W_]|-)")


def cue(shell: InteractiveShell, line: str, cell: str) -> IconSet:
    """Read the cue text of a cell, bind the set to a name, and show its picture.

        %%cue [NAME]

    NAME is the variable that holds the set, ``cues`` unless said otherwise.

    A cell may leave out the version line: it is then read as version 1 of the language. A file always needs the line,
    and ``str(cues)``, the text to save, has it. Lines in messages are counted as the notebook counts them, from
    ``%%cue``. When something is wrong with the cell, all of it is reported, the cell fails so that "Run all" stops, and
    NAME keeps what it held before.

    JupyterLab colours the cell as if it were Python: it takes no other language from a magic.
    """
    from IPython.core.error import UsageError

    from thermicon.icons import parse

    name = line.strip() or DEFAULT_NAME
    if not name.isidentifier() or keyword.iskeyword(name):
        raise UsageError(f"%%cue [NAME]: {name!r} is not a valid variable name")
    # The version takes the place of the magic's own line, so that lines count as in the notebook.
    first = "\n" if _VERSION.match(cell) else "cue 1\n"
    icons = parse(first + cell, "cell")
    shell.user_ns[name] = icons
    return icons


def register(shell: InteractiveShell) -> None:
    """Make ``%%cue`` known to an IPython shell, and show figures small; matplotlib is not imported for it."""

    def magic(line: str, cell: str) -> IconSet:
        return cue(shell, line, cell)

    magic.__doc__ = inspect.getdoc(cue)
    shell.magics_manager.register_function(magic, "cell", "cue")
    _pictures(shell).for_type_by_name("matplotlib.figure", "Figure", small_png)


def unregister(shell: InteractiveShell) -> None:
    """Take ``%%cue`` away again, and leave figures to IPython."""
    shell.magics_manager.magics["cell"].pop("cue", None)
    _pictures(shell).pop("matplotlib.figure.Figure", None)


def _pictures(shell: InteractiveShell) -> Any:
    formatter = shell.display_formatter
    assert formatter is not None
    return formatter.formatters["image/png"]
