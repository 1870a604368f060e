"""Start of the command: Ctrl-C during imports, and a warning when another copy of thermicon hides the installed one."""

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from types import TracebackType

INTERRUPTED = 130
COMMANDS = ("thermicon", "thermicon.exe", "thermicon-script.py")


def is_command() -> bool:
    """Whether this process is the ``thermicon`` command, and not somebody's own program."""
    first = os.path.basename(sys.argv[0]) if sys.argv else ""  # noqa: PTH119 - pathlib takes too long to import
    return first in COMMANDS or sys.orig_argv[1:3] == ["-m", "thermicon.notebooks.cli.main"]


def guard() -> None:
    """Let an interrupt that nothing catches end the command without a traceback."""
    if is_command():
        sys.excepthook = _end


def hidden_by(imported: str, known: Iterable[str]) -> str | None:
    """Return a sentence when the imported folder of this package is not one of the installed ones.

    >>> hidden_by("/home/a/thermicon/notebooks", ["/usr/lib/thermicon/notebooks"])
    'warning: this runs /home/a/thermicon/notebooks, which hides the installed /usr/lib/thermicon/notebooks; \
start Python in another folder, or with -P'
    >>> hidden_by("/usr/lib/thermicon/notebooks", ["/usr/lib/thermicon/notebooks"])
    """
    folders = [os.path.realpath(folder) for folder in known]
    if not folders or os.path.realpath(imported) in folders:
        return None
    cure = "start Python in another folder, or with -P"
    return f"warning: this runs {imported}, which hides the installed {folders[0]}; {cure}"


def installed_folders() -> list[str]:
    """Folders of this package in all installed distributions, wheels and editable ones."""
    import json
    from importlib.metadata import distributions
    from urllib.parse import urlparse
    from urllib.request import url2pathname

    folders = []
    for distribution in distributions(name="thermicon"):
        origin = json.loads(distribution.read_text("direct_url.json") or "{}")
        if origin.get("dir_info", {}).get("editable"):
            folders.append(os.path.join(url2pathname(urlparse(origin["url"]).path), "notebooks"))  # noqa: PTH118
        elif os.path.isdir(folder := str(distribution.locate_file("thermicon/notebooks"))):  # noqa: PTH112
            folders.append(folder)
    return folders


def warn_if_hidden() -> None:
    """Say on stderr, in one line, when a checkout hides the installed package; never fail because of it."""
    with suppress(Exception):
        sentence = hidden_by(os.path.dirname(__file__), installed_folders())  # noqa: PTH120
        if sentence is not None:
            print(sentence, file=sys.stderr)


def _end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
        return
    try:
        os.write(2, b"interrupted\n")
    finally:
        os._exit(INTERRUPTED)
