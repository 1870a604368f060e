"""The check of a cue text at every keystroke of an editor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import islice

from thermicon.icons import CueErrors, Family, Icon, IconSet, parse
from thermicon.icons.model.errors import CueError
from thermicon.icons.model.iconset import SeveralElements

MOST_NAMES = 200
"""Names that a list of icons shows; a family may have 100,000 members."""
KEPT = 16


@dataclass(frozen=True, slots=True)
class Trouble:
    """One error of a text: lines and columns from 1, what is wrong, what would fit, and one line that was tried out."""

    line: int
    column: int
    end_column: int
    code: str
    headline: str
    hint: str
    suggestion: str | None = None


@dataclass(frozen=True, slots=True)
class Reading:
    """A text read: the set, or its troubles with how many ``more`` there are than are listed."""

    icons: IconSet | None
    troubles: tuple[Trouble, ...] = ()
    more: int = 0

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the icons in the order of the text, members of families among them, the first 200."""
        return () if self.icons is None else tuple(icon.name for icon in islice(self.icons, MOST_NAMES))

    def find(self, name: str | None) -> Icon | None:
        """The icon, or the member of a family, of this name; None when there is none."""
        return None if self.icons is None or name is None else self.icons.find(name)

    def family_of(self, name: str) -> Family | None:
        """The family that an icon of this name is a member of, None for an icon of its own."""
        if self.icons is None or any(entry.name == name for entry in self.icons.entries):
            return None
        return next((family for family in self.icons.families if family.find(name) is not None), None)


@lru_cache(maxsize=KEPT)
def read_text(text: str) -> Reading:
    """Read a cue text; what is wrong with it is part of the answer, so nothing is raised.

    >>> read_text("cue 1; icon dip { cool by 6 at 3 K/s }").troubles[0].headline
    'missing unit: this number has no unit'
    """
    try:
        icons = parse(text, "text")
        icons.check_one_element()
        return Reading(icons)
    except SeveralElements as refusal:
        return Reading(None, (Trouble(1, 1, 2, "", str(refusal), ""),))
    except CueErrors as found:
        return Reading(None, tuple(map(trouble_of, found.errors)), found.more)


def trouble_of(error: CueError) -> Trouble:
    """An error as the editor shows it; one that concerns the text as a whole stands on line 1."""
    column = max(error.column, 1)
    said = f"{error.title}: {error.what}" if error.what else error.title
    return Trouble(
        max(error.line, 1), column, column + max(error.length, 1), error.code, said, error.help, error.suggestion
    )


def mended(text: str, line: int) -> str | None:
    """The text with the suggestion for a line taken; None where there is none that helps.

    >>> mended("cue 1\\nicon dip {\\n  cool by 6 at 3 K/s # deep\\n}", 3)
    'cue 1\\nicon dip {\\n  cool by 6 °C at 3 K/s # deep\\n}'
    """
    before = read_text(text)
    trouble = next((each for each in before.troubles if each.line == line and each.suggestion), None)
    if trouble is None or trouble.suggestion is None:
        return None
    rows = text.splitlines(keepends=True)
    old = rows[line - 1] if line <= len(rows) else ""
    body = old.rstrip("\r\n")
    indent = body[: len(body) - len(body.lstrip())]
    instead = indent + trouble.suggestion + old[len(body) :]
    # A missing version line is put above the line that it is reported for, all others replace theirs.
    above = trouble.suggestion + "\n" + old
    tried = ["".join([*rows[: line - 1], new, *rows[line:]]) for new in (instead, above)]
    counts = [len(reading.troubles) + reading.more for reading in map(read_text, tried)]
    best = min(range(2), key=counts.__getitem__)
    return tried[best] if counts[best] <= len(before.troubles) + before.more and tried[best] != text else None
