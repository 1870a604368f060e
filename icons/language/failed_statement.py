"""A statement that failed to parse."""

from collections.abc import Iterable
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from ..model.words import DASHES, FILLERS, STARTS
from .source import Finding, Patch, Piece

_BOUNDS = "<>≤≥±"
"""Characters that are not idle."""


@dataclass(frozen=True, slots=True)
class FailedStatement:
    """A statement as ``pieces`` that broke at ``pieces[index]``, or at its end; ``at`` is the offset.

    ``accepts`` are the terminals that the grammar could take there, ``where`` is "file", "set", "icon" or "repeat".
    ``names`` are the parameters of the icon around it, None when they could not be read; ``listing`` says that it
    broke between the parentheses of a family, where pieces are cut finer.
    """

    pieces: list[Piece]
    index: int
    at: int
    accepts: frozenset[str]
    where: str
    names: AbstractSet[str] | None = frozenset()
    listing: bool = False

    @property
    def bad(self) -> Piece:
        """The piece that does not fit; at the end of the statement an empty one."""
        if self.index < len(self.pieces):
            return self.pieces[self.index]
        before = self.before
        end = before.end if before is not None else self.at
        return Piece("end", "", end, end)

    @property
    def before(self) -> Piece | None:
        """The piece before it."""
        return self.pieces[self.index - 1] if self.index else None

    @property
    def first(self) -> str:
        """The word that the statement begins with."""
        return self.pieces[0].text if self.pieces else ""

    @property
    def rest(self) -> list[Piece]:
        """The pieces behind the one that does not fit."""
        return self.pieces[self.index + 1 :]

    def idle(self, pieces: Iterable[Piece]) -> bool:
        """Tell whether nothing is left out without these pieces: fillers, repeated words, and where the change goes."""
        said = (piece.text.casefold() for piece in pieces if piece.kind != "other" or piece.text in _BOUNDS)
        repeated = self.before.text if self.before is not None else ""
        return all(word in FILLERS or word == repeated or STARTS.get(word) == self.first for word in said)

    def next(self, count: int = 1) -> str:
        """Return the text of a piece behind the one that does not fit, or ""."""
        place = self.index + count
        return self.pieces[place].text if place < len(self.pieces) else ""

    def quantity(self, place: int) -> tuple[float, str] | None:
        """Return number and unit that stand at a place, or None."""
        if place + 1 >= len(self.pieces) or self.pieces[place].kind != "number":
            return None
        try:
            return float(self.pieces[place].text.replace("−", "-")), self.pieces[place + 1].text
        except ValueError:
            return None

    def find(self, word: str) -> int | None:
        """Return the place of a word in the statement, or None."""
        return next((place for place, piece in enumerate(self.pieces) if piece.text == word), None)

    def text_from(self, start: int) -> str:
        """Return the pieces from a place on as text with single spaces between them."""
        return " ".join(piece.text for piece in self.pieces[start:])


def at(piece: Piece, code: str, what: str, help: str = "", *cures: Patch) -> Finding:
    """Return a finding under the whole of a piece."""
    return Finding(code, piece.start, max(piece.end, piece.start + 1), what, help, cures)


def signed(case: FailedStatement) -> Finding | None:
    """An invalid sign, or one separated from its number: the cure keeps it."""
    bad, number = case.bad, case.rest[0] if case.rest else None
    if bad.text not in (*DASHES, "+") or number is None or number.kind != "number" or number.text[0] in "+-−":
        return None
    what = f'"{bad.text}" (U+{ord(bad.text):04X}) is not a minus sign'
    if bad.text in "+-−":
        what = "there is a space between the sign and its number"
    cure = Patch(bad.start, number.end, ("+" if bad.text == "+" else "-") + number.text)
    help = 'a minus sign is a plain hyphen, "-", right before the digits'
    return Finding("E106", bad.start, number.end, what, help, (cure,))


def swap(piece: Piece, text: str) -> Patch:
    """Return the edit that puts a text in the place of a piece."""
    return Patch(piece.start, piece.end, text)


def short(text: object) -> str:
    """Return a text as messages quote it."""
    return str(text) if len(str(text)) <= 30 else str(text)[:29] + "…"


def either(words: list[str]) -> str:
    """Return words in quotation marks with "or" between them."""
    return " or ".join(f'"{word}"' for word in words)
