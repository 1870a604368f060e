"""The draggable corners of an icon."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal

from thermicon.icons import Family, Icon
from thermicon.icons.model.icon import rest_level
from thermicon.icons.model.motion import advance, amplitude, pieces
from thermicon.icons.model.parameter import Path
from thermicon.icons.model.statements import Current, Hold, Play, Pulse, Ramp, Repeat, Rest, Return, Step, Total, Wave

if TYPE_CHECKING:
    from thermicon.icons.model.statements import Leaf

MOST_HANDLES = 150
"""More corners than a pointer can separate; a repeat may have a billion."""
Part = Literal["end", "top", "last", "peak"]
PEAK_AT = {"sine": Fraction(1, 4), "triangle": Fraction(1, 4), "sawtooth": Fraction(1, 2), "square": Fraction(1, 2)}
"""The share of a period at which a wave has its handle: at its peak, a square wave at the end of its first half."""
LEVELS = ("by_K", "to_C", "by_A", "to_A")
RATES = ("rate_K_per_s", "rate_A_per_s", "rate_per_s")


@dataclass(frozen=True, slots=True)
class IconCorner:
    """One corner as played, exact: its statement, the part of it, where that begins, and the corner; s and °C or A.

    ``path`` leads to the statement through repeats; None in a played icon, which ``played`` then names.
    """

    leaf: Leaf
    part: Part
    path: Path | None
    played: str | None
    line: int
    begin_s: Fraction
    begin: Fraction
    time_s: Fraction
    level: Fraction


@dataclass(frozen=True, slots=True)
class Handle:
    """A draggable corner: s, °C or A, the directions in which it moves, and why not, if it does not move in both."""

    time_s: float
    level: float
    moves_time: bool
    moves_level: bool
    why: str | None
    line: int


@dataclass(frozen=True, slots=True)
class Grip:
    """The fields of a statement that a corner depends on; None for a direction that does not move, with the reason."""

    time: str | None
    level: str | None
    why: str | None


def handles_of(icon: Icon, family: Family | None = None, start: float | None = None) -> tuple[Handle, ...]:
    """Return the corners of an icon, at most 150; in a member of a ``family``, values set by a parameter do not move.

    ``start`` is the level of rest if the text gives none, as in ``Icon.corners``.

    >>> from thermicon.icons import load_library
    >>> for handle in handles_of(load_library("six-icons")["cooling-step"]):
    ...     print(handle.time_s, handle.level, handle.moves_time, handle.moves_level)
    2.0 26.0 True True
    6.0 26.0 True False
    8.0 32.0 True False
    """
    written = slots_of(family)
    found = []
    for corner in corners_of(icon, start):
        grip = grip_of(corner, written)
        place = float(corner.time_s), float(corner.level)
        found.append(Handle(*place, grip.time is not None, grip.level is not None, grip.why, corner.line))
    return tuple(found)


def corners_of(icon: Icon, start: float | None = None) -> tuple[IconCorner, ...]:
    """Return the corners that handles stand for, in the order in which they are played."""
    time, level = Fraction(0), (rest := rest_level(icon.context, start))
    found: list[IconCorner] = []
    for leaf, path, played, line in _leaves(icon.statements, (), None, 0):
        for part, after, to in _parts(leaf, level, rest):
            found.append(IconCorner(leaf, part, path, played, line, time, level, time + after, to))
        if len(found) >= MOST_HANDLES:
            break
        level, took = advance(leaf, level, rest)
        time += took
    return tuple(found[:MOST_HANDLES])


def slots_of(family: Family | None) -> dict[tuple[Path, str], str]:
    """Return which fields the parameters of a family write, with their names."""
    return {} if family is None else {(slot.path, slot.field): slot.parameter for slot in family.slots}


def grip_of(corner: IconCorner, written: dict[tuple[Path, str], str]) -> Grip:
    """Return the numbers that a corner depends on, or the reason why it does not move."""
    if corner.path is None:
        return Grip(None, None, f"this is played from {corner.played}; select that icon to move its corners")
    if corner.leaf.span is None:
        return Grip(None, None, "this corner is not written in the text")
    time, level, why = _fields(corner.leaf, corner.part)
    said = [why] if why else []
    held = {name: written[corner.path, name] for name in (time, level) if name and (corner.path, name) in written}
    if isinstance(corner.leaf, Wave) and time == "period_s" and not corner.leaf.cut:
        # The time of a wave is a whole number of its periods, so the two change together.
        held |= {"period_s": written[corner.path, "duration_s"]} if (corner.path, "duration_s") in written else {}
    said += [f"the parameter {name} of the family writes this {_NOUNS[field]}" for field, name in held.items()]
    return Grip(None if time in held else time, None if level in held else level, "; ".join(said) or None)


_NOUNS = {
    **dict.fromkeys(("by_K", "by_A"), "amount"),
    **dict.fromkeys(("to_C", "to_A"), "level"),
    **dict.fromkeys(RATES, "rate"),
    **{"duration_s": "time", "period_s": "period"},
}


def _fields(leaf: Leaf, part: Part) -> tuple[str | None, str | None, str | None]:
    """Fields that time and level of a part depend on, and why one of them does not move."""
    given = [name for name in (*LEVELS, *RATES) if getattr(leaf, name, None) is not None]
    level = next((name for name in given if name in LEVELS), None)
    pace = next((name for name in given if name in RATES), "duration_s")
    match leaf:
        case Ramp() | Current():
            return pace, level, None
        case Return():
            return pace, None, "a return ends at baseline"
        case Hold():
            return "duration_s", None, "a hold keeps its level: move the corner before it"
        case Rest():
            return "duration_s", None, "a rest stays at baseline"
        case Step():
            return None, level, "a step takes no time: move the corner before it"
        case Pulse() if part == "top":
            return None, level, "a pulse begins where the statement before it ends"
        case Pulse():
            return "duration_s", level, None
        case Wave() if part == "peak":
            return "period_s", level, None
        case Wave():
            ends = "where it began" if not leaf.cut else "where its period is cut"
            return "duration_s", None, f"a wave ends {ends}: move its first peak"
    return None, None, "this moves nothing"


def _leaves(
    body: Sequence[Any], path: Path, played: str | None, line: int
) -> Iterator[tuple[Leaf, Path | None, str | None, int]]:
    """Yield every statement as it is played, with its path, or with the name of the played icon that it stands in."""
    for place, part in enumerate(body):
        own = line if played else (part.span or (0, 0))[0]
        if isinstance(part, Repeat):
            for _ in range(part.count):
                yield from _leaves(part.body, (*path, place), played, own)
        elif isinstance(part, Play):
            yield from _leaves(part.icon.statements, (), played or part.icon.name, own)
        elif not isinstance(part, Total):
            yield part, None if played else (*path, place), played, own


def _parts(leaf: Leaf, level: Fraction, rest: Fraction) -> Iterator[tuple[Part, Fraction, Fraction]]:
    """Yield the corners of a statement: which part, the time after its beginning, the level."""
    end, took = advance(leaf, level, rest)
    if isinstance(leaf, Pulse):
        top = next(pieces(leaf, level, rest))[0]
        yield "top", Fraction(0), top
        yield "last", took, top
        return
    if isinstance(leaf, Wave):
        peak = PEAK_AT[leaf.shape] * Fraction(leaf.period_s).limit_denominator(10**9)
        if peak < took:
            yield "peak", peak, level + leaf.sign * amplitude(leaf)
    yield "end", took, end
