"""Statements written in Python as they are in a cue text: ``cool(by=6, at=3)``, in K, K/s, s, °C and A."""

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING

from .shapes import Pulse, Shape, Start, Step, Wave
from .statements import (
    Bound,
    Current,
    Direction,
    Hold,
    Play,
    Ramp,
    Repeat,
    Rest,
    Return,
    Statement,
    Total,
)
from .units import UNITS, Kind
from .value_limits import fault

if TYPE_CHECKING:
    from .icon import Icon


def cool(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Cool by a difference (K) or to a temperature (°C), at a rate (K/s) or over a time (s).

    Raises ValueError unless one of each pair is given and lies within what the language takes.

    >>> cool(by=6, at=3) == Ramp("cool", by_K=6, rate_K_per_s=3)
    True
    """
    return _change("cool", "cool", by, to, at, over)


def warm(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Warm by a difference (K) or to a temperature (°C), at a rate (K/s) or over a time (s); ValueError as ``cool``.

    >>> warm(to=38, over=2) == Ramp("warm", to_C=38, duration_s=2)
    True
    """
    return _change("warm", "warm", by, to, at, over)


def ramp(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """``change``: by a signed difference (K) or to a temperature (°C), at a rate (K/s) or over a time (s).

    Raises ValueError as ``cool`` does.

    >>> ramp(by=-6, at=3) == Ramp("change", by_K=-6, rate_K_per_s=3)
    True
    """
    return _change("ramp", "change", by, to, at, over)


def current(*, to: float, at: float | None = None, over: float | None = None) -> Current:
    """``to`` under control current: to a current (A), at a rate (A/s) or over a time (s); ValueError as ``cool``.

    >>> current(to=0.5, at=1) == Current(0.5, rate_A_per_s=1)
    True
    """
    _one_of("current", {"at": at, "over": over})
    rate, time = _number("current", "at", at, "current_rate"), _number("current", "over", over, "time")
    return Current(_given("current", "to", to, "current"), rate, time)


def hold(duration: float) -> Hold:
    """Stay at the present level for a time (s); ValueError unless it lies between 1 µs and an hour.

    >>> hold(4) == Hold(duration_s=4)
    True
    """
    return Hold(_given("hold", "duration", duration, "time"))


def rest(duration: float) -> Rest:
    """Stay at baseline for a time (s); ValueError unless it lies between 1 µs and an hour.

    >>> rest(1) == Rest(duration_s=1)
    True
    """
    return Rest(_given("rest", "duration", duration, "time"))


def back(*, at: float | None = None, over: float | None = None) -> Return:
    """``return``: go back to baseline at a rate (K/s, A/s under control current) or over a time (s).

    Raises ValueError unless one of them is given, and positive.

    >>> back(at=3) == Return(rate_per_s=3), back(over=2) == Return(duration_s=2)
    (True, True)
    """
    _one_of("back", {"at": at, "over": over})
    return Return(_number("back", "at", at, "rate"), _number("back", "over", over, "time"))


def step(
    *, by: float | None = None, to: float | None = None, by_A: float | None = None, to_A: float | None = None
) -> Step:
    """Step as fast as the driver can: by a signed difference (K, A) or to a level (°C, A).

    Raises ValueError unless exactly one is given and lies within what the language takes.

    >>> step(by=-6) == Step(by_K=-6), step(to_A=0.5) == Step(to_A=0.5)
    (True, True)
    """
    _one_of("step", {"by": by, "to": to, "by_A": by_A, "to_A": to_A})
    by, to = _number("step", "by", by, "change"), _number("step", "to", to, "absolute")
    amount = _amperes("step", by_A)
    return Step("change", by, to, amount, _number("step", "to_A", to_A, "current"))


def pulse(*, by: float | None = None, by_A: float | None = None, duration: float) -> Pulse:
    """Step by a signed difference (K, or A), hold for a time (s) and step back; ValueError as ``step``.

    >>> pulse(by=-3, duration=0.5) == Pulse(by_K=-3, duration_s=0.5)
    True
    """
    _one_of("pulse", {"by": by, "by_A": by_A})
    by, amount = _number("pulse", "by", by, "change"), _amperes("pulse", by_A)
    return Pulse("change", by, amount, _given("pulse", "duration", duration, "time"))


def sine(
    *,
    by: float | None = None,
    every: float,
    duration: float,
    starting: Start | None = None,
    cut: bool = False,
    by_A: float | None = None,
) -> Wave:
    """A sine about the present level: amplitude (K, or A), period (s) and duration (s).

    The duration holds whole periods unless ``cut``. ``starting`` is "warm" or "cool", with amperes "up" or "down".
    Raises ValueError for anything else and for numbers outside what the language takes.

    >>> sine(by=3, every=4, duration=12, starting="cool")
    Wave(shape='sine', by_K=3.0, by_A=None, period_s=4.0, duration_s=12.0, start='cool', cut=False)
    """
    return _wave("sine", by, every, duration, starting, cut, by_A)


def square(
    *,
    by: float | None = None,
    every: float,
    duration: float,
    starting: Start | None = None,
    cut: bool = False,
    by_A: float | None = None,
) -> Wave:
    """A square wave about the present level; arguments and errors as those of ``sine``.

    >>> square(by=3, every=4, duration=10, cut=True) == Wave("square", by_K=3, period_s=4, duration_s=10, cut=True)
    True
    """
    return _wave("square", by, every, duration, starting, cut, by_A)


def triangle(
    *,
    by: float | None = None,
    every: float,
    duration: float,
    starting: Start | None = None,
    cut: bool = False,
    by_A: float | None = None,
) -> Wave:
    """A triangle wave about the present level; arguments and errors as those of ``sine``.

    >>> triangle(by=3, every=4, duration=8) == Wave("triangle", by_K=3, period_s=4, duration_s=8)
    True
    """
    return _wave("triangle", by, every, duration, starting, cut, by_A)


def sawtooth(
    *,
    by: float | None = None,
    every: float,
    duration: float,
    starting: Start | None = None,
    cut: bool = False,
    by_A: float | None = None,
) -> Wave:
    """A wave that rises slowly and falls in a step, or the other way; arguments and errors as those of ``sine``.

    >>> sawtooth(by_A=0.5, every=1, duration=3, starting="down").start
    'down'
    """
    return _wave("sawtooth", by, every, duration, starting, cut, by_A)


def repeat(count: int, *body: Statement) -> Repeat:
    """Play statements ``count`` times over; ValueError without a statement or a positive whole count.

    >>> repeat(3, hold(1), pulse(by=2, duration=1)).count
    3
    """
    if not body:
        raise ValueError("repeat() needs statements behind the count, such as repeat(3, hold(1))")
    return Repeat(int(_given("repeat", "count", count, "count")), _statements(body))


def play(icon: "Icon") -> Play:
    """Play all statements of another icon, which begins at baseline; ValueError for anything but an icon.

    >>> from thermicon.icons import Icon
    >>> play(Icon("wait", (rest(1),))).icon.name
    'wait'
    """
    if not hasattr(icon, "statements"):
        raise ValueError(f"play() needs an Icon, not {icon!r}")
    return Play(icon)


def total(duration: float, bound: Bound = "exactly") -> Total:
    """How long (s) the whole icon must last, "exactly", "at most" or "at least": checked, nothing is filled up.

    Raises ValueError for another bound, and unless the time lies between 1 µs and an hour.

    >>> total(10, "at most") == Total(10, "at most")
    True
    """
    if bound not in ("exactly", "at most", "at least"):
        raise ValueError(f'total(bound={bound!r}): "exactly", "at most" or "at least" is needed')
    return Total(_given("total", "duration", duration, "time"), bound)


def _change(
    call: str, direction: Direction, by: float | None, to: float | None, at: float | None, over: float | None
) -> Ramp:
    _one_of(call, {"by": by, "to": to})
    _one_of(call, {"at": at, "over": over})
    size = _number(call, "by", by, "change" if direction == "change" else "difference")
    target = _number(call, "to", to, "absolute")
    return Ramp(direction, size, target, _number(call, "at", at, "rate"), _number(call, "over", over, "time"))


def _wave(
    shape: Shape,
    by: float | None,
    every: float,
    duration: float,
    starting: Start | None,
    cut: bool,
    by_A: float | None,
) -> Wave:
    _one_of(shape, {"by": by, "by_A": by_A})
    size, amount = _number(shape, "by", by, "difference"), _amperes(shape, by_A)
    ways = ("warm", "cool") if by_A is None else ("up", "down")
    if amount is not None and amount < 0:
        raise ValueError(f'{shape}(by_A={by_A!r}): an amplitude is positive; to begin downwards, say starting="down"')
    if starting not in (None, *ways):
        raise ValueError(f'{shape}(starting={starting!r}): "{ways[0]}" or "{ways[1]}" is needed')
    if not isinstance(cut, bool):
        raise ValueError(f"{shape}(cut={cut!r}): True or False is needed")
    period, time = _given(shape, "every", every, "time"), _given(shape, "duration", duration, "time")
    return Wave(shape, size, amount, period, time, starting, cut)


def _statements(parts: Sequence[object]) -> tuple[Statement, ...]:
    """Return parts that are all statements; ValueError names the first that is not."""
    for part in parts:
        if not isinstance(part, Statement) or isinstance(part, Total):
            what = "total() concerns the whole icon" if isinstance(part, Total) else f"{part!r} is not a statement"
            raise ValueError(f"repeat(): {what}")
    return tuple(part for part in parts if isinstance(part, Statement))


def _one_of(call: str, given: Mapping[str, object]) -> None:
    """Raise ValueError unless exactly one of these arguments of a call is given."""
    names = [name for name, value in given.items() if value is not None]
    if not names:
        *most, last = given
        raise ValueError(f"{call}() needs either {', '.join(most)} or {last}")
    if len(names) > 1:
        raise ValueError(f"{call}() takes only one of {', '.join(names[:-1])} and {names[-1]}")


def _number(call: str, name: str, value: float | None, kind: Kind) -> float | None:
    """Return an argument as a float, None as it is; ValueError for what this kind of quantity may not be."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, Real):
        unit = next(iter(UNITS[kind]))
        raise ValueError(f"{call}({name}={value!r}): a number is needed{f', in {unit}' if unit else ''}")
    if found := fault(float(value), kind):
        raise ValueError(f"{call}({name}={value!r}): {found[1]}")
    return float(value)


def _given(call: str, name: str, value: float, kind: Kind) -> float:
    """As ``number``, for an argument that may not be None."""
    found = _number(call, name, value, kind)
    if found is None:
        raise ValueError(f"{call}() needs {name}")
    return found


def _amperes(call: str, value: float | None) -> float | None:
    """Return the argument ``by_A`` as a float, None as it is; ValueError for 0 and beyond ±20 A."""
    found = _number(call, "by_A", value, "current")
    if found == 0:
        raise ValueError(f"{call}(by_A={value!r}): a change must not be zero")
    return found
