"""The keys that stop a play."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

KEYS = {" ": "Space", "\x1b": "Esc", "\x03": "Ctrl-C"}


def is_watched() -> bool:
    """Whether a person sits at the keyboard."""
    return sys.stdin is not None and sys.stdin.isatty()


@contextmanager
def stop_key() -> Iterator[Callable[[], str]]:
    """A function that says which key stops, empty while none does; nothing is shown of what is typed meanwhile."""
    if not is_watched():
        yield str
    elif sys.platform == "win32":
        import msvcrt

        yield lambda: meant(msvcrt.getwch() if msvcrt.kbhit() else "")
    else:
        import termios
        import tty

        keyboard = sys.stdin.fileno()
        before = termios.tcgetattr(keyboard)
        try:
            tty.setcbreak(keyboard)
            yield lambda: meant(os.read(keyboard, 64).decode("utf-8", "replace") if _is_typed(keyboard) else "")
        finally:
            termios.tcsetattr(keyboard, termios.TCSADRAIN, before)


def _is_typed(keyboard: int) -> bool:
    return bool(select.select([keyboard], [], [], 0.0)[0])


def meant(typed: str) -> str:
    """Which of the keys that stop is among what was typed, in words."""
    return next((f"{KEYS[letter]} was pressed" for letter in typed if letter in KEYS), "")
