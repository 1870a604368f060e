"""The ``%%cue`` cell magic: cue text in a notebook cell becomes a set with its picture, or a list of its mistakes.

``%load_ext thermicon.notebooks`` switches it on, and small pictures of matplotlib figures with it.
"""

from __future__ import annotations

import argparse
import inspect
import keyword
import re
import shlex
from typing import TYPE_CHECKING, Any, NoReturn

from ..figures.print_figure import small_png

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from thermicon.icons import IconSet

DEFAULT_NAME = "cues"
USAGE = "usage: %%cue [NAME] [--rig RIG]"
# Blank lines and comments, then the word that begins a version line.
_VERSION = re.compile(r"(?:[ \t\u00a0\u202f]*(?:#[^\n]*)?[;\n])*[ \t\u00a0\u202f]*cue(?![^\W_]|-)")


class CueMagicError(ValueError):
    """A line after ``%%cue`` that cannot be followed; IPython shows its words, without a traceback."""

    def _render_traceback_(self) -> list[str]:
        return str(self).split("\n")


class _Line(argparse.ArgumentParser):
    """Reads what stands behind ``%%cue``; argparse would end the kernel on a mistake."""

    def __init__(self) -> None:
        super().__init__(prog="%%cue", usage=USAGE, add_help=False, allow_abbrev=False)
        self.add_argument("name", nargs="?", default=DEFAULT_NAME)
        self.add_argument("--rig")

    def error(self, message: str) -> NoReturn:
        raise CueMagicError(f"%%cue: {message}\n{USAGE}")


def cue(shell: InteractiveShell, line: str, cell: str) -> IconSet:
    """Read the cue text of a cell, bind the set to a name, and show its picture.

        %%cue [NAME] [--rig RIG]

    NAME is the variable that holds the set, ``cues`` unless said otherwise. With --rig RIG, a shipped rig or a path to
    a .toml file, what that rig cannot do with the icons is printed as well; the set is bound all the same.

    A cell may leave out the version line: it is then read as version 1 of the language. A file always needs the line,
    and ``str(cues)``, the text to save, has it. Lines in messages are counted as the notebook counts them, from
    ``%%cue``. When something is wrong with the cell, all of it is reported, the cell fails so that "Run all" stops, and
    NAME keeps what it held before.

    JupyterLab colours the cell as if it were Python: it takes no other language from a magic unless one of its own
    extensions brings it. Text in Markdown blocks marked ``cue`` is coloured by tools that use Pygments, such as
    mkdocs and Sphinx.
    """
    from thermicon.icons import parse

    name, rig_name = _read_line(line)
    rig = None
    if rig_name is not None:
        from ..messages import is_ours, load_rig

        try:
            rig = load_rig(rig_name, [])
        except Exception as error:
            if not (is_ours(error) or isinstance(error, OSError)):
                raise
            raise CueMagicError(f"%%cue: {error}") from None
    # The version takes the place of the magic's own line, so that lines count as in the notebook.
    first = "\n" if _VERSION.match(cell) else "cue 1\n"
    icons = parse(first + cell, "cell")
    shell.user_ns[name] = icons
    if rig is not None:
        from ..cli.check import against_rig

        print(
            "\n\n".join(against_rig(icons, rig, "cell")) or f"{rig.name} can hold every level of {name} (static check)"
        )
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


def _read_line(line: str) -> tuple[str, str | None]:
    words = shlex.shlex(line, posix=True)
    words.whitespace_split, words.escape, words.commenters = True, "", ""  # paths may hold backslashes
    try:
        said = _Line().parse_args(list(words))
    except ValueError as error:
        if isinstance(error, CueMagicError):
            raise
        raise CueMagicError(f"%%cue: {error}\n{USAGE}") from None
    if not said.name.isidentifier() or keyword.iskeyword(said.name):
        plain = re.sub(r"\W", "_", said.name)
        help = f"; try {plain}" if plain.isidentifier() and not keyword.iskeyword(plain) else ""
        raise CueMagicError(f"%%cue: {said.name!r} is not a valid variable name{help}\n{USAGE}")
    return said.name, said.rig
