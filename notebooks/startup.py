"""Start of the command: Ctrl-C during imports, libraries that are missing, and a copy that hides the installed one."""

import io
import os
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from types import TracebackType

INTERRUPTED = 130
BAD_INPUT = 1
COMMANDS = ("thermicon", "thermicon.exe", "thermicon-script.py")
MODULES = ("thermicon.notebooks", "thermicon.notebooks.cli.main")
DOCTOR = "doctor"


def is_command() -> bool:
    """Whether this process is the ``thermicon`` command, and not somebody's own program."""
    first = os.path.basename(sys.argv[0]) if sys.argv else ""  # noqa: PTH119 - pathlib takes too long to import
    words = sys.orig_argv
    return first in COMMANDS or ("-m" in words[:-1] and words[words.index("-m") + 1] in MODULES)


def guard(examine: Callable[[BaseException], int]) -> None:
    """Let an interrupt or a missing library, which nothing catches, end the command without a traceback.

    Where the command line itself cannot be imported, ``thermicon doctor`` is ``examine``, which gives the exit code.
    """
    if is_command():
        sys.excepthook = _ending(examine)


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

    folders = []
    for distribution in distributions(name="thermicon"):
        origin = json.loads(distribution.read_text("direct_url.json") or "{}")
        if origin.get("dir_info", {}).get("editable"):
            folders.append(os.path.join(_path_in(urlparse(origin["url"]).path), "notebooks"))  # noqa: PTH118
        elif os.path.isdir(folder := str(distribution.locate_file("thermicon/notebooks"))):  # noqa: PTH112
            folders.append(folder)
    return folders


def _path_in(url_path: str) -> str:
    """What `urllib.request.url2pathname` says; elsewhere than on Windows without its import, a tenth of a start."""
    if sys.platform == "win32":
        from urllib.request import url2pathname

        return url2pathname(url_path)
    from urllib.parse import unquote

    return unquote(url_path)


def warn_if_hidden() -> None:
    """Say on stderr, in one line, when a checkout hides the installed package; never fail because of it."""
    with suppress(Exception):
        sentence = hidden_by(os.path.dirname(__file__), installed_folders())  # noqa: PTH120
        if sentence is not None:
            print(sentence, file=sys.stderr)


def print_anywhere() -> None:
    """Let text be printed wherever the output goes: characters that it has no code for become question marks."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def cannot_import(error: BaseException) -> str | None:
    """Return a message if the error is a failed import of a library, otherwise None.

    >>> cannot_import(ImportError("No module named 'lark'", name="lark"))
    "thermicon cannot start: No module named 'lark'; thermicon doctor says what is missing and how to install it"
    >>> cannot_import(ImportError("cannot import name 'x'", name="thermicon.icons"))
    """
    if not isinstance(error, ImportError) or (error.name or "").partition(".")[0] == "thermicon":
        return None
    words = str(error).strip().splitlines() or ["a library cannot be imported"]
    return f"thermicon cannot start: {words[0]}; thermicon doctor says what is missing and how to install it"


def _ending(examine: Callable[[BaseException], int]) -> Callable[..., None]:
    """Return the last word on an error that nothing catches."""

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            try:
                os.write(2, b"interrupted\n")
            finally:
                os._exit(INTERRUPTED)
        if sys.argv[1:2] == [DOCTOR]:
            with suppress(Exception):
                code = examine(error)
                sys.stdout.flush()
                os._exit(code)
        message = cannot_import(error)
        if message is None:
            sys.__excepthook__(kind, error, trace)
            return
        print(message, file=sys.stderr, flush=True)
        os._exit(BAD_INPUT)

    return end
