"""Start of the command without a traceback."""

import os
import sys
from types import TracebackType

INTERRUPTED = 130
BAD_INPUT = 1
COMMANDS = ("thermicon", "thermicon.exe", "thermicon-script.py")
MODULES = ("thermicon", "thermicon.notebooks.cli.main")


def guard() -> None:
    """Have an interrupt or a missing library, which nothing catches, end the command; nobody else's program."""
    first = os.path.basename(sys.argv[0]) if sys.argv else ""  # noqa: PTH119 - pathlib takes too long to import
    words = sys.orig_argv
    if first in COMMANDS or ("-m" in words[:-1] and words[words.index("-m") + 1] in MODULES):
        sys.excepthook = end


def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Say the last word on an error that nothing catches, and leave with its exit code."""
    if issubclass(kind, KeyboardInterrupt):
        message, code = "interrupted", INTERRUPTED
    elif isinstance(error, ImportError) and (error.name or "").partition(".")[0] != "thermicon":
        cure = f"{sys.executable} -m pip check says what is missing"
        message, code = f"thermicon cannot start: {str(error).partition(chr(10))[0]}; {cure}", BAD_INPUT
    else:
        sys.__excepthook__(kind, error, trace)
        return
    try:
        os.write(2, f"{message}\n".encode())
    finally:
        os._exit(code)
