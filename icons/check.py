"""Meaning: run an icon's statements in thought and find what cannot be, without writing repeats out."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from thermicon.icons.statements import (
    HIGHEST_A,
    HIGHEST_C,
    LONGEST_S,
    LOWEST_C,
    SHORTEST_S,
    Broken,
    Change,
    Control,
    Drive,
    Leaf,
    Repeat,
    Rest,
    Return,
    Statement,
    advance,
)

MOST_CORNERS = 100_000
# A bare thenar eminence rests near 32 °C; taken where neither the set nor the caller says what baseline is.
ASSUMED_BASELINE_C = 32.0


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that cannot be: the statement (None for the icon), which part of it, and what is wrong.

    ``cures`` holds pairs of a part and the text to put in its place.
    """

    statement: Statement | None
    code: str
    part: str
    what: str
    help: str = ""
    cures: tuple[tuple[str, str], ...] = ()


def corner_count(body: Sequence[Statement | Broken]) -> int:
    """Return how many corners a body can have at most once its repeats are written out.

    >>> from thermicon.icons.statements import Hold
    >>> corner_count([Repeat(1000, (Repeat(1000, (Hold(1),)),))])
    1000000
    """
    return sum(part.count * corner_count(part.body) if isinstance(part, Repeat) else 1 for part in body)


def problems(body: Sequence[Statement | Broken], control: Control, rest: Fraction | None) -> list[Problem]:
    """Return what cannot be in a body that starts at the level ``rest`` (°C or A; None when that is not known)."""
    if (corners := corner_count(body)) > MOST_CORNERS:
        worst = max(
            (part for part in body if isinstance(part, Repeat)), key=lambda part: corner_count([part]), default=None
        )
        what = f"written out, this icon has {_count(corners)} corners"
        return [Problem(worst, "E220", "count", what, f"an icon has at most {MOST_CORNERS:,} corners")]
    walker = _Walker(control, rest)
    _, duration = walker.run(body, rest)
    if duration > Fraction(LONGEST_S):
        what = f"this icon lasts {float(duration):,.6g} s"
        walker.found.append(Problem(None, "E221", "name", what, "an icon lasts at most one hour (3600 s)"))
    return walker.found


@dataclass(slots=True)
class _Walker:
    control: Control
    rest: Fraction | None
    found: list[Problem] = field(default_factory=list)
    blamed: set[int] = field(default_factory=set)

    def run(self, body: Sequence[Statement | Broken], level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        total = Fraction(0)
        for part in body:
            if isinstance(part, Repeat):
                level, duration = self.repeat(part, level)
            elif isinstance(part, Broken):
                level, duration = None, Fraction(0)
            else:
                level, duration = self.leaf(part, level)
            total += duration
        return level, total

    def repeat(self, part: Repeat, level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        # At most three passes stand for all: what a body does to the level is either a fixed step or a fixed target.
        after, duration = self.run(part.body, level)
        if part.count == 1 or after == level or level is None or after is None:
            return after, duration * part.count
        if _absolute(part.body):
            after, later = self.run(part.body, after)
            return after, duration + later * (part.count - 1)
        step = after - level
        self.run(part.body, after)
        if part.count > 2:
            self.run(part.body, level + step * (part.count - 1))
        return level + step * part.count, duration * part.count

    def leaf(self, part: Leaf, level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        if self.control == "current" and isinstance(part, Change):
            help = 'prescribe the current, for example: "to 0.5 A at 1 A/s"'
            self.blame(
                part, "E208", "word", f'"{part.direction}" moves a temperature; this set controls the current', help
            )
            return None, Fraction(0)
        if self.control != "current" and isinstance(part, Drive):
            help = 'say "warm" or "cool", or put "control current" into the set'
            self.blame(part, "E209", "word", f'"to" alone moves a current; this set controls the {self.control}', help)
            return None, Fraction(0)
        if level is None or self.rest is None:
            return self.blind(part), Fraction(0)
        self.side(part, level, self.rest)
        target, duration = advance(part, level, self.rest)
        low, high = (-HIGHEST_A, HIGHEST_A) if self.control == "current" else (LOWEST_C, HIGHEST_C)
        if not low <= target <= high:
            unit = "A" if self.control == "current" else "°C"
            help = f"the language allows {low:g} to {high:g} {unit}; a rig may allow less"
            self.blame(part, "E219", "target", f"this leads to {float(target):.6g} {unit}", help)
        if 0 < duration < Fraction(SHORTEST_S):
            self.blame(part, "E203", "pace", "this takes less than a microsecond", "take a smaller rate")
        return target, duration

    def blind(self, part: Leaf) -> Fraction | None:
        # Behind a statement that could not be read only an absolute target tells where the icon is.
        if isinstance(part, Return):
            return self.rest
        if (isinstance(part, Change) and part.to_C is not None) or isinstance(part, Drive):
            return advance_blind(part)
        return None

    def side(self, part: Leaf, level: Fraction, rest: Fraction) -> None:
        unit = "A" if self.control == "current" else "°C"
        now = f"{float(level):.6g} {unit}"
        if isinstance(part, Change) and part.to_C is not None:
            target = Fraction(str(part.to_C))
            if target == level:
                self.blame(part, "E201", "target", f"the level is {now} already", 'to stay there, write "hold for 2 s"')
            elif (target > level) != (part.direction == "warm"):
                other = "cool" if part.direction == "warm" else "warm"
                side = "below" if target < level else "above"
                what = f"{part.to_C:.6g} °C is {side} the {now} reached so far"
                help = f'"{part.direction}" leads the other way; for a change of level, write "by"'
                self.blame(part, "E201", "target", what, help, ("word", other))
        elif isinstance(part, Drive) and advance_blind(part) == level:
            self.blame(part, "E201", "target", f"the current is {now} already", 'to stay there, write "hold for 2 s"')
        elif isinstance(part, Rest) and level != rest:
            what = f"the level is {now} here, baseline is {float(rest):.6g} {unit}"
            help = 'rest is at baseline: return first, or write "hold" to stay at this level'
            self.blame(part, "E205", "whole", what, help, ("word", "hold"))
        elif isinstance(part, Return) and level == rest:
            help = 'to stay there, write "rest for 2 s"'
            cures = (("whole", f"rest for {part.duration_s:g} s"),) if part.duration_s else ()
            self.blame(part, "E206", "whole", f"the level is at baseline already, {now}", help, *cures)

    def blame(self, part: Leaf, code: str, where: str, what: str, help: str, *cures: tuple[str, str]) -> None:
        if id(part) not in self.blamed:
            self.blamed.add(id(part))
            self.found.append(Problem(part, code, where, what, help, cures))


def advance_blind(part: Change | Drive) -> Fraction:
    """Return the absolute target of a statement that has one, in °C or A, exact."""
    return advance(part, Fraction(0), Fraction(0))[0]


def _absolute(body: Sequence[Statement | Broken]) -> bool:
    return any(
        isinstance(part, Return | Drive)
        or (isinstance(part, Change) and part.to_C is not None)
        or (isinstance(part, Repeat) and _absolute(part.body))
        for part in body
    )


def _count(number: int) -> str:
    return f"{number:,}" if number < 10**15 else "more than 10^15"
