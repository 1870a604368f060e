"""The keys that stop a play."""

from __future__ import annotations

import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SIGNALS = {"SIGINT": "Ctrl-C", "SIGTERM": "the program was ended", "SIGHUP": "the terminal was closed"}
KEYS = {" ": "Space", "\x1b": "Esc", "\x03": "Ctrl-C"}


def is_watched() -> bool:
    """Whether a person sits at the keyboard."""
    return sys.stdin is not None and sys.stdin.isatty()


@contextmanager
def stop_key() -> Iterator[Callable[[], str]]:
    """A function that says what stops, empty while nothing does: a key, Ctrl-C, or a signal that would end the program.

    A second signal does not interrupt what switches off and ends the log.
    """
    came = list[str]()
    names = [name for name in SIGNALS if hasattr(signal, name)]
    before = [
        (getattr(signal, name), signal.signal(getattr(signal, name), lambda *_, name=name: came.append(SIGNALS[name])))
        for name in names
    ]
    try:
        with _keys() as typed:
            yield lambda: came[0] if came else typed()
    finally:
        for number, handler in before:
            signal.signal(number, handler)


@contextmanager
def _keys() -> Iterator[Callable[[], str]]:
    """A function that says which key stops; nothing is shown of what is typed meanwhile."""
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
