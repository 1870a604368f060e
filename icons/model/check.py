"""Semantic checks of an icon's statements in the order in which they play."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from .motion import advance, amplitude, piece_count, reach, whole_periods
from .statements import (
    Broken,
    Current,
    Leaf,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Shape,
    Statement,
    Step,
    Total,
    Wave,
)
from .units import HIGHEST_A, HIGHEST_C, LONGEST_S, LOWEST_C, SHORTEST_S, Control, decimal_text, exact

# Of one icon, written out: 28 a second for the hour that it may last.
MOST_CORNERS = 100_000
# A bare thenar eminence rests near 32 °C; taken where neither the set nor the caller says what baseline is.
ASSUMED_BASELINE_C = 32.0
Played = dict[int, tuple[Fraction | None, Fraction]]
# The steepest slope of a wave, as a multiple of amplitude over period.
_STEEPNESS: dict[Shape, float] = {"sine": 2 * math.pi, "triangle": 4.0, "sawtooth": 2.0, "square": 0.0}


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem: statement (None: the icon), part, what is wrong, cures by part, and how far a total is off in s."""

    statement: Statement | None
    code: str
    part: str
    what: str
    help: str = ""
    cures: tuple[tuple[str, str], ...] = ()
    off_s: float = 0.0


def corner_count(body: Sequence[Statement | Broken], known: dict[int, int] | None = None) -> int:
    """Return how many corners a body can have at most once its repeats are written out."""
    known = {} if known is None else known
    count = 0
    for part in body:
        if isinstance(part, Repeat):
            count += part.count * corner_count(part.body, known)
        elif isinstance(part, Play):
            if id(part.icon) not in known:
                known[id(part.icon)] = corner_count(part.icon.statements, known)
            count += known[id(part.icon)]
        else:
            count += 1 if isinstance(part, Broken) else piece_count(part)
    return count


def survey(
    body: Sequence[Statement | Broken], control: Control, rest: Fraction | None, played: Played | None = None
) -> "_Survey":
    """The summary of a body from the level ``rest`` (None: not known) on; ``played`` caches played icons."""
    if (corners := corner_count(body)) > MOST_CORNERS:
        worst = max(
            (part for part in body if isinstance(part, Repeat | Wave | Play)),
            key=lambda part: corner_count([part]),
            default=None,
        )
        many = f"{corners:,}" if corners < 10**15 else "more than 10^15"
        what = f"written out, this icon has {many} corners"
        part = "count" if isinstance(worst, Repeat) else "whole"
        problem = Problem(worst, "E220", part, what, f"an icon has at most {MOST_CORNERS:,} corners")
        return _Survey(control, rest, [problem])
    found = _Survey(control, rest, played={} if played is None else played)
    if rest is not None:
        found.lowest = found.highest = float(rest)
    found.level, duration = found.run(body, rest)
    found.duration = duration
    found.duration_s = seconds = float(duration)  # Fractions are compared only where floats leave a doubt
    if seconds >= LONGEST_S and duration > LONGEST_S:
        what = f"this icon lasts {seconds:,.6g} s"
        found.problems.append(Problem(None, "E221", "name", what, "an icon lasts at most one hour (3600 s)"))
    if found.timed and seconds == 0 and body and not found.problems:
        help = 'a step takes no time; follow it with a line such as "hold for 2 s"'
        found.problems.append(Problem(None, "E223", "name", "this icon lasts 0 s", help))
    if found.timed:
        found.totals(body, duration)
    return found


@dataclass(slots=True)
class _Survey:
    """What a body does: its problems, duration (s), levels (°C or A: last, extreme) and steepest slope (K/s or A/s)."""

    control: Control
    rest: Fraction | None
    problems: list[Problem] = field(default_factory=list)
    blamed: set[int] = field(default_factory=set)
    played: Played = field(default_factory=dict)
    # Behind a statement that could not be read, the duration of the icon is unknown.
    timed: bool = True
    duration_s: float = 0.0
    duration: Fraction = Fraction(0)
    level: Fraction | None = None
    lowest: float = math.inf
    highest: float = -math.inf
    steepest_per_s: float = 0.0

    def run(self, body: Sequence[Statement | Broken], level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        total = Fraction(0)
        for part in body:
            if isinstance(part, Repeat):
                level, duration = self.repeat(part, level)
            elif isinstance(part, Broken):
                level, duration = None, Fraction(0)
            elif isinstance(part, Play):
                level, duration = self.play(part, level)
            else:
                level, duration = self.leaf(part, level)
            total += duration
            self.timed &= level is not None and self.rest is not None
        return level, total

    def repeat(self, part: Repeat, level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        # Two passes stand for all: what a body does to the level is either a fixed step or a fixed target.
        after, duration = self.run(part.body, level)
        if part.count == 1 or after == level or level is None or after is None:
            return after, duration * part.count
        if absolute(part.body):
            after, later = self.run(part.body, after)
            return after, duration + later * (part.count - 1)
        step = after - level
        self.run(part.body, level + step * (part.count - 1))
        return level + step * part.count, duration * part.count

    def play(self, part: Play, level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        # Every icon begins at baseline, so that what it was proven to do alone is what it does here.
        if level is not None and level != self.rest:
            what = f"the level is {self.say(level)} here; {part.icon.name} begins at baseline"
            self.blame(part, "E224", "whole", what, "go back first, with a line such as: return at 3 °C/s")
        if id(part.icon) not in self.played:
            self.played[id(part.icon)] = self.run(part.icon.statements, self.rest)
        return self.played[id(part.icon)]

    def leaf(self, part: Leaf, level: Fraction | None) -> tuple[Fraction | None, Fraction]:
        if not self.fits(part):
            return None, Fraction(0)
        if isinstance(part, Wave) and not part.cut and not whole_periods(part):
            period, lasts = exact(part.period_s, "time"), exact(part.duration_s, "time")
            near = f"{decimal_text(float(max(1, round(lasts / period)) * period))} s"
            what = f"{float(lasts):.6g} s hold {float(lasts / period):.4g} periods of {float(period):.6g} s"
            help = f'whole periods last, for example, {near}; to stop within one, add "cut"'
            self.blame(part, "E225", "time", what, help, ("time", near))
        if level is None or self.rest is None:
            # Behind a statement that could not be read only an absolute target tells where the icon is.
            known = self.rest if isinstance(part, Return) else advance_blind(part) if absolute([part]) else None
            return known, Fraction(0)
        self.side(part, level, self.rest)
        target, duration = advance(part, level, self.rest)
        low, high = (-HIGHEST_A, HIGHEST_A) if self.control == "current" else (LOWEST_C, HIGHEST_C)
        if isinstance(part, Wave | Pulse):
            least, most = reach(part, level, self.rest)
        else:
            least, most = level, target
        # Fractions are compared only where floats leave a doubt: that takes most of the time of a family.
        bottom, top, seconds = float(least), float(most), float(duration)
        bottom, top = min(bottom, top), max(bottom, top)
        self.lowest, self.highest = min(self.lowest, bottom), max(self.highest, top)
        if isinstance(part, Wave):
            slope = _STEEPNESS[part.shape] * float(amplitude(part)) / part.period_s
        else:
            slope = (top - bottom) / seconds if seconds and not isinstance(part, Pulse) else 0.0
        self.steepest_per_s = max(self.steepest_per_s, slope)
        if (bottom <= low or top >= high) and (min(least, most) < low or max(least, most) > high):
            beyond = bottom if bottom < low else top
            unit = "A" if self.control == "current" else "°C"
            help = f"the language allows {low:g} to {high:g} {unit}; a rig may allow less"
            self.blame(part, "E219", "target", f"this leads to {beyond:.6g} {unit}", help)
        if 0 < seconds < 2 * SHORTEST_S and duration < Fraction(SHORTEST_S):
            self.blame(part, "E203", "pace", "this takes less than a microsecond", "take a smaller rate")
        return target, duration

    def fits(self, part: Leaf) -> bool:
        """Tell whether a statement moves what the set controls; blame it when not."""
        current = self.control == "current"
        if current and isinstance(part, Ramp):
            help = 'prescribe the current, for example: "to 0.5 A at 1 A/s"'
            what = f'"{part.direction}" moves a temperature; this set controls the current'
            self.blame(part, "E208", "word", what, help)
            return False
        if not current and isinstance(part, Current):
            help = 'say "warm" or "cool", or put "control current" into the set'
            self.blame(part, "E209", "word", f'"to" alone moves a current; this set controls the {self.control}', help)
            return False
        if isinstance(part, Step | Pulse | Wave):
            amperes = part.by_A is not None or (isinstance(part, Step) and part.to_A is not None)
            if amperes != current:
                what = f"this is in {'A' if amperes else '°C'}; this set controls the {self.control}"
                self.blame(part, "E210", "target", what, f"write an amount in {'A' if current else '°C'}")
                return False
        return True

    def totals(self, body: Sequence[Statement | Broken], duration: Fraction) -> None:
        """Blame every ``total`` that the whole icon does not keep."""
        for part in body:
            if isinstance(part, Total):
                wanted, least = exact(part.duration_s, "time"), Fraction(SHORTEST_S)
                off = duration - wanted
                if (off > least and part.bound != "at least") or (off < -least and part.bound != "at most"):
                    bound = "" if part.bound == "exactly" else f"{part.bound} "
                    what = f"this icon lasts {float(duration):.6g} s, not {bound}{decimal_text(part.duration_s)} s"
                    few = f"it is {float(abs(off)):.6g} s too {'short' if off < 0 else 'long'}"
                    text = f"{decimal_text(float(f'{float(duration):.9g}'))} s"
                    help = f"a total is checked, nothing is filled up or cut: {few}"
                    self.problems.append(Problem(part, "E222", "time", what, help, (("time", text),), float(abs(off))))

    def side(self, part: Leaf, level: Fraction, rest: Fraction) -> None:
        unit = "A" if self.control == "current" else "°C"
        if isinstance(part, Ramp | Step) and part.to_C is not None:
            target = exact(part.to_C, "absolute")
            if target == level:
                what = f"the level is {self.say(level)} already"
                self.blame(part, "E201", "target", what, 'to stay there, write "hold for 2 s"')
            elif part.direction != "change" and (target > level) != (part.direction == "warm"):
                other = "cool" if part.direction == "warm" else "warm"
                side = "below" if target < level else "above"
                what = f"{part.to_C:.6g} °C is {side} the {self.say(level)} reached so far"
                help = f'"{part.direction}" leads the other way; for a change of level, write "by"'
                self.blame(part, "E201", "target", what, help, ("direction", other))
        elif isinstance(part, Current | Step) and absolute([part]) and advance_blind(part) == level:
            what = f"the current is {self.say(level)} already"
            self.blame(part, "E201", "target", what, 'to stay there, write "hold for 2 s"')
        elif isinstance(part, Rest) and level != rest:
            what = f"the level is {self.say(level)} here, baseline is {float(rest):.6g} {unit}"
            help = 'rest is at baseline: return first, or write "hold" to stay at this level'
            self.blame(part, "E205", "whole", what, help, ("word", "hold"))
        elif isinstance(part, Return) and level == rest:
            help = 'to stay there, write "rest for 2 s"'
            cures = (("whole", f"rest for {part.duration_s:g} s"),) if part.duration_s else ()
            self.blame(part, "E206", "whole", f"the level is at baseline already, {self.say(level)}", help, *cures)

    def say(self, level: Fraction) -> str:
        return f"{float(level):.6g} {'A' if self.control == 'current' else '°C'}"

    def blame(self, part: Leaf | Play, code: str, where: str, what: str, help: str, *cures: tuple[str, str]) -> None:
        if id(part) not in self.blamed:
            self.blamed.add(id(part))
            self.problems.append(Problem(part, code, where, what, help, cures))


def advance_blind(part: Leaf) -> Fraction:
    """Return the absolute target of a statement that has one, in °C or A, exact."""
    return advance(part, Fraction(0), Fraction(0))[0]


def absolute(body: Sequence[Statement | Broken]) -> bool:
    """Tell whether a body holds a statement that leads to a fixed level, wherever it begins."""
    return any(
        isinstance(part, Return | Current | Play)
        or (isinstance(part, Ramp | Step) and part.to_C is not None)
        or (isinstance(part, Step) and part.to_A is not None)
        or (isinstance(part, Repeat) and absolute(part.body))
        for part in body
    )
