"""One result of a check: its state, a sentence, and the cure where there is something to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

State = Literal["ok", "note", "fault"]
"""A note costs something that can be done without; a fault keeps thermicon from working or from being right."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What a check found: one sentence without a full stop, and the cure exactly where the state is not ``ok``.

    >>> print(Finding("voila", "note", "not installed", 'pip install "thermicon[page]"').line)
    note   voila: not installed; pip install "thermicon[page]"
    """

    check: str
    state: State
    text: str
    cure: str | None = None

    def __post_init__(self) -> None:
        if self.state not in get_args(State):
            raise ValueError(f"state {self.state!r} is not one of {', '.join(get_args(State))}")
        if "\n" in f"{self.text}{self.cure}":
            raise ValueError(f"{self.check}: a finding is one line")
        if (self.cure is None) != (self.state == "ok"):
            raise ValueError(f"{self.check}: {self.state} {'without' if self.cure is None else 'with'} a cure")

    @property
    def line(self) -> str:
        """The finding as one line of text."""
        cure = "" if self.cure is None else f"; {self.cure}"
        return readable(f"{self.state:<5}  {self.check}: {self.text}{cure}")

    def to_dict(self) -> dict[str, str | None]:
        """The finding as plain data, for JSON."""
        cure = None if self.cure is None else readable(self.cure)
        return {"check": self.check, "state": self.state, "text": readable(self.text), "cure": cure}


def readable(text: str) -> str:
    """Return text with the letters of paths that Python read without knowing their encoding, as with LC_ALL=C.

    >>> readable("/home/Gr\\udcc3\\udcb6")
    '/home/Grö'
    """
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def first_line(error: BaseException) -> str:
    """Return the kind of an error and the first line of its text.

    >>> first_line(ImportError("no module\\nmore words"))
    'ImportError: no module'
    """
    words = str(error).strip().splitlines()
    return f"{type(error).__name__}: {words[0].strip()}" if words else type(error).__name__
