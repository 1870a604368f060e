"""Ctrl-C while the command is still being imported: one word and exit code 130, as later. Imports nothing of weight."""

import os
import sys
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


def _end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
        return
    try:
        os.write(2, b"interrupted\n")
    finally:
        os._exit(INTERRUPTED)
