"""A dragged corner: the one or two numbers of its statement that change."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

from thermicon.base.words.number_text import number
from thermicon.icons import CueErrors, Icon
from thermicon.icons.model.changes import with_values
from thermicon.icons.model.motion import periods_of
from thermicon.icons.model.parameter import Path
from thermicon.icons.model.statements import Wave

from ..editing.cue_check import read_text
from ..editing.number_literals import Amount, WrittenStatement, keyword_of, kind_of, replaced, written
from .handles import PEAK_AT, RATES, Grip, IconCorner, corners_of, grip_of, slots_of

ROUNDS = 12
CLOSE = 1e-9
NEAR = 1e-6
"""A corner is where it is dragged to within so many s, °C or A: far below any number that is written."""
_WORDS = {"cool": "warm", "warm": "cool"}


@dataclass(frozen=True, slots=True)
class DragResult:
    """The text after a drag; ``refused`` says why it is the text before."""

    text: str
    refused: str | None = None


class _Refused(Exception):
    """A drag that leads nowhere; the sentence says why."""


def drag(text: str, icon: str, index: int, time_s: float, level: float, start: float | None = None) -> DragResult:
    """Move a corner of an icon to a time (s) and level (°C or A), as near as rounded numbers come.

    ``index`` counts the handles of the icon, ``start`` is the level of rest as in ``handles_of``. A ramp at a rate
    keeps its corner under the pointer: dragged up or down, its rate changes with its size.

    >>> text = "cue 1\\nicon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s } # six"
    >>> drag(text, "dip", 0, 2.0, 27.0).text.splitlines()[1]
    'icon dip { cool by 5 °C at 2.5 °C/s; hold for 4 s; return at 3 °C/s } # six'
    >>> drag(text, "dip", 1, 1.5, 26.0).refused
    'the corner cannot come before 2 s, where its statement begins'
    """
    try:
        reading = read_text(text)
        if (found := reading.find(icon)) is None:
            cause = f"line {reading.troubles[0].line} has an error" if reading.troubles else f"no icon is called {icon}"
            raise _Refused(f"the corner stays where it is: {cause}")
        corners = corners_of(found, start)
        if not 0 <= index < len(corners):
            raise _Refused(f"{icon} has {len(corners)} corners now, so there is none to move at {index + 1}")
        if not (math.isfinite(time_s) and math.isfinite(level)):
            raise _Refused("the corner was not moved: the message has no target position")
        corner = corners[index]
        grip = grip_of(corner, slots_of(reading.family_of(icon)))
        if (grip.time is None and grip.level is None) or corner.path is None or corner.leaf.span is None:
            raise _Refused(grip.why or "this corner does not move")
        move = _Move(found, index, corner, corner.path, grip, start, written(text, corner.leaf.span))
        new = replaced(text, move.edits(time_s, level))
        if troubles := read_text(new).troubles:
            hint = f"; {troubles[0].hint}" if troubles[0].hint else ""
            raise _Refused(f"line {troubles[0].line} would be wrong: {troubles[0].headline}{hint}")
        return DragResult(new)
    except _Refused as why:
        return DragResult(text, str(why))


@dataclass(frozen=True, slots=True)
class _Move:
    """A corner about to be moved: its icon and index, the fields it depends on, and its statement in the text."""

    icon: Icon
    index: int
    corner: IconCorner
    path: Path
    grip: Grip
    start: float | None
    place: WrittenStatement

    def amount(self, field: str) -> Amount:
        """Return the position of a number of the statement in the text."""
        found = self.place.amounts.get(keyword_of(self.corner.leaf, field))
        if found is None:
            raise _Refused("this corner is not written in the text")
        return found

    def edits(self, time_s: float, level: float) -> dict[tuple[int, int], str]:
        """Return the replacements in the text that move the corner to a time and level."""
        grip, now = self.grip, self.corner
        place = float(now.level), float(now.time_s)
        to_level = level if grip.level and abs(level - place[0]) > 0.5 * self.step(grip.level) else place[0]
        to_time = time_s if grip.time and abs(time_s - place[1]) > 0.5 * self.step(grip.time) else place[1]
        return {} if (to_level, to_time) == place else self.in_words(*self.solve(to_level, to_time))

    def step(self, field: str) -> float:
        """Return the rounding step of a field in SI; for a rate, that of the duration of its ramp."""
        leaf = self.corner.leaf
        if field in RATES:
            return 0.05 if self.corner.time_s - self.corner.begin_s >= 0.25 else 0.01
        return self.amount(field).step(getattr(leaf, field), kind_of(leaf, field, self.icon.context.control))

    def solve(self, to_level: float, to_time: float) -> tuple[float, float]:
        """Return the size and the duration of the change that bring the corner to a level and time, over all rounds."""
        now, grip = self.corner, self.grip
        size, took = float(now.level - now.begin), float(now.time_s - now.begin_s)
        place = float(now.level), float(now.time_s)
        slope = [1.0, 1.0]
        for _ in range(ROUNDS):
            miss = [to_level - place[0] if grip.level else 0.0, to_time - place[1] if grip.time else 0.0]
            if max(map(abs, miss)) < NEAR:
                break
            old, before = (size, took), place
            size, took = size + miss[0] / slope[0], took + miss[1] / slope[1]
            place = self.replay(size, took)
            for n, (new, was) in enumerate(zip((size, took), old, strict=True)):
                if abs(new - was) > CLOSE and abs(change := (place[n] - before[n]) / (new - was)) > CLOSE:
                    slope[n] = change
        return size, took

    def replay(self, size: float, took: float) -> tuple[float, float]:
        """The place of the corner with a statement of another size and time."""
        self.check(size, took)
        try:
            body = with_values(self.icon.statements, self.path, self.fields(size, took))
            found = corners_of(replace(self.icon, statements=body), self.start)
        except CueErrors as wrong:
            first = wrong.errors[0]
            raise _Refused(f"{first.title}: {first.what}{f'; {first.help}' if first.help else ''}") from None
        except ValueError as wrong:  # in the words of its last part: the place is known
            raise _Refused(str(wrong).rpartition(": ")[2]) from None
        if len(found) <= self.index:
            raise _Refused("the statement would no longer have this corner")
        return float(found[self.index].level), float(found[self.index].time_s)

    def check(self, size: float, took: float) -> None:
        """Refuse an invalid statement: no time, no size."""
        now, grip = self.corner, self.grip
        if grip.time is not None:
            self.check_time(took)
        if grip.level is not None and abs(size) < CLOSE:
            raise _Refused("the corner cannot be at the level at which its statement begins: that would be no change")
        if isinstance(now.leaf, Wave) and grip.level is not None and size * now.leaf.sign < 0:
            first = {"warm": "cool", "cool": "warm", "up": "down", "down": "up"}[str(now.leaf.start)]
            raise _Refused(f'to begin the other way, write "starting {first}": an amplitude is positive')

    def fields(self, size: float, took: float) -> dict[str, Any]:
        """Values (SI) of the statement's fields for a size and time."""
        leaf, grip, found = self.corner.leaf, self.grip, dict[str, Any]()
        if grip.level is not None:
            found |= self.level_fields(size)
        if grip.time in RATES:
            found[grip.time] = round(abs(size) / took, 9)
        elif grip.time == "period_s" and isinstance(leaf, Wave):
            found["period_s"] = round(took / float(PEAK_AT[leaf.shape]), 9)
            if not leaf.cut:
                found["duration_s"] = round(found["period_s"] * float(periods_of(leaf)), 9)
        elif grip.time is not None:
            found[grip.time] = round(self.whole(took), 9)
        return found

    def level_fields(self, size: float) -> dict[str, Any]:
        """Direction and amount for a signed size, the amount without sign where a word tells the direction."""
        leaf, field = self.corner.leaf, str(self.grip.level)
        to = field.startswith("to")
        value = float(self.corner.begin) + size if to else size
        direction = getattr(leaf, "direction", "change")
        if isinstance(leaf, Wave):
            return {field: round(abs(size), 9)}
        if direction == "change":
            return {field: round(value, 9)}
        word = "cool" if size < 0 else "warm"
        return {"direction": word, field: round(value if to else abs(size), 9)}

    def whole(self, took: float) -> float:
        """A time of a wave that is not cut in whole periods, at least one; any other time as it is."""
        leaf = self.corner.leaf
        if not isinstance(leaf, Wave) or leaf.cut:
            return took
        return max(1, round(took / leaf.period_s)) * leaf.period_s

    def in_words(self, size: float, took: float) -> dict[tuple[int, int], str]:
        """The edits that write a size and time, rounded; a number that rounds to what it was stays as it is written."""
        leaf, grip, control = self.corner.leaf, self.grip, self.icon.context.control
        edits: dict[tuple[int, int], str] = {}
        resized = False
        if grip.level is not None:
            fields = self.level_fields(size)
            kind, where = kind_of(leaf, grip.level, control), self.amount(grip.level)
            value = where.rounded(fields[grip.level], kind)
            turned = fields.get("direction", "") != getattr(leaf, "direction", "") and "direction" in fields
            resized = turned or value != where.rounded(getattr(leaf, grip.level), kind)
            if resized:
                written_size = where.si(value, kind) - (float(self.corner.begin) if grip.level[:2] == "to" else 0.0)
                size = math.copysign(written_size, size)
                self.check(size if abs(written_size) >= CLOSE else 0.0, took)
                edits[where.start, where.end] = where.text(value)
            else:
                size = float(self.corner.level - self.corner.begin)
            if turned and self.place.direction is not None:
                edits[self.place.direction] = _WORDS[getattr(leaf, "direction")]  # noqa: B009
        if grip.time in RATES:
            before = float(self.corner.time_s - self.corner.begin_s)
            if resized or abs(took - before) > 0.2 * self.step(grip.time):
                where = self.amount(grip.time)
                value = where.rate(abs(size), took, kind_of(leaf, grip.time, control))
                edits[where.start, where.end] = where.text(value)
        elif grip.time is not None:
            edits |= self.time_in_words(took)
        return edits

    def time_in_words(self, took: float) -> dict[tuple[int, int], str]:
        """The edits that write the time of a statement that has one of its own; a wave stays one of whole periods."""
        leaf, field = self.corner.leaf, str(self.grip.time)
        where, now = self.amount(field), getattr(leaf, field)
        if field == "period_s" and isinstance(leaf, Wave):
            period = where.rounded(took / float(PEAK_AT[leaf.shape]), "time")
            if period == where.rounded(now, "time"):
                return {}
            self.check_time(period)
            edits = {(where.start, where.end): where.text(period)}
            if not leaf.cut:
                total = self.amount("duration_s")
                edits[total.start, total.end] = total.exactly(
                    where.si(period, "time") * float(periods_of(leaf)), "time"
                )
            return edits
        if isinstance(leaf, Wave) and not leaf.cut:
            whole = self.whole(took)
            return {} if abs(whole - now) < CLOSE else {(where.start, where.end): where.exactly(whole, "time")}
        value = where.rounded(took, "time")
        self.check_time(value)
        return {} if value == where.rounded(now, "time") else {(where.start, where.end): where.text(value)}

    def check_time(self, value: float | Decimal) -> None:
        """Refuse a time that is none, or rounded to none."""
        if value <= 0:
            begin = number(float(self.corner.begin_s), 2)
            raise _Refused(f"the corner cannot come before {begin} s, where its statement begins")
