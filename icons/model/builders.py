"""Statements written in Python as they are in a cue text: ``cool(by=6, at=3)``, in K, K/s, s, °C and A."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, get_args

from .builder_arguments import documented, given, number, one_of
from .shapes import Heading
from .statements import (
    Bound,
    Current,
    Hold,
    Play,
    Ramp,
    Repeat,
    Rest,
    Return,
    Statement,
    Total,
)

if TYPE_CHECKING:
    from .icon import Icon


CHANGE = """Parameters
----------
by
    Difference in K, positive for `cool` and `warm`, signed for `ramp`; give `by` or `to`.
to
    Temperature in °C.
at
    Positive rate in K/s; give `at` or `over`.
over
    Time in s.

Returns
-------
Ramp
    The statement ``cool``, ``warm`` or ``change``.

Raises
------
ValueError
    Unless one of each pair is given, within the limits of the language.
"""
"""What the docstrings of `cool`, `warm` and `ramp` share."""


@documented(CHANGE)
def cool(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Cool by a difference or to a temperature, at a rate or over a time.

    Examples
    --------
    >>> cool(by=6, at=3) == Ramp("cool", by_K=6, rate_K_per_s=3)
    True
    """
    return _change("cool", "cool", by, to, at, over)


@documented(CHANGE)
def warm(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Warm by a difference or to a temperature, at a rate or over a time.

    Examples
    --------
    >>> warm(to=38, over=2) == Ramp("warm", to_C=38, duration_s=2)
    True
    """
    return _change("warm", "warm", by, to, at, over)


@documented(CHANGE)
def ramp(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Change by a signed difference or to a temperature, at a rate or over a time.

    Examples
    --------
    >>> ramp(by=-6, at=3) == Ramp("change", by_K=-6, rate_K_per_s=3)
    True
    """
    return _change("ramp", "change", by, to, at, over)


def current(*, to: float, at: float | None = None, over: float | None = None) -> Current:
    """Go to a current, at a rate or over a time; only under current control.

    Parameters
    ----------
    to
        Current in A, within ±20 A.
    at
        Positive rate in A/s; give `at` or `over`.
    over
        Time in s.

    Returns
    -------
    Current
        The statement ``to``.

    Raises
    ------
    ValueError
        Unless one of `at` and `over` is given, and all are within the limits of the language.

    Examples
    --------
    >>> current(to=0.5, at=1) == Current(0.5, rate_A_per_s=1)
    True
    """
    one_of("current", {"at": at, "over": over})
    rate, time = number("current", "at", at, "current_rate"), number("current", "over", over, "time")
    return Current(given("current", "to", to, "current"), rate, time)


def hold(duration: float) -> Hold:
    """Stay at the present level.

    Parameters
    ----------
    duration
        Time in s, from 1 µs to an hour.

    Returns
    -------
    Hold
        The statement ``hold``.

    Raises
    ------
    ValueError
        For a time outside this range.

    Examples
    --------
    >>> hold(4) == Hold(duration_s=4)
    True
    """
    return Hold(given("hold", "duration", duration, "time"))


def rest(duration: float) -> Rest:
    """Stay at baseline.

    Parameters
    ----------
    duration
        Time in s, from 1 µs to an hour.

    Returns
    -------
    Rest
        The statement ``rest``, which is an error away from baseline.

    Raises
    ------
    ValueError
        For a time outside this range.

    Examples
    --------
    >>> rest(1) == Rest(duration_s=1)
    True
    """
    return Rest(given("rest", "duration", duration, "time"))


def back(*, at: float | None = None, over: float | None = None) -> Return:
    """Return to baseline, at a rate or over a time.

    Parameters
    ----------
    at
        Positive rate in K/s, or in A/s under current control; give `at` or `over`.
    over
        Time in s.

    Returns
    -------
    Return
        The statement ``return``.

    Raises
    ------
    ValueError
        Unless one of them is given, and positive.

    Examples
    --------
    >>> back(at=3) == Return(rate_per_s=3), back(over=2) == Return(duration_s=2)
    (True, True)
    """
    one_of("back", {"at": at, "over": over})
    return Return(number("back", "at", at, "rate"), number("back", "over", over, "time"))


def repeat(count: int, *body: Statement) -> Repeat:
    """Play statements several times.

    Parameters
    ----------
    count
        Number of plays, a positive whole number.
    *body
        The statements.

    Returns
    -------
    Repeat
        The statement ``repeat``.

    Raises
    ------
    ValueError
        Without a statement, and for a bad count.

    Examples
    --------
    >>> repeat(3, cool(by=2, at=1), back(at=1)).count
    3
    """
    if not body:
        raise ValueError("repeat() needs statements after the count, such as repeat(3, hold(1))")
    return Repeat(int(given("repeat", "count", count, "count")), _statements(body))


def play(icon: "Icon") -> Play:
    """Play all statements of another icon, from baseline.

    Parameters
    ----------
    icon
        The other icon.

    Returns
    -------
    Play
        The statement ``play``.

    Raises
    ------
    ValueError
        For anything but an icon.

    Examples
    --------
    >>> from thermicon.icons import Icon
    >>> play(Icon("wait", (rest(1),))).icon.name
    'wait'
    """
    if not hasattr(icon, "statements"):
        raise ValueError(f"play() needs an Icon, not {icon!r}")
    return Play(icon)


def total(duration: float, bound: Bound = "exactly") -> Total:
    """State how long the whole icon lasts; this is checked, and changes nothing.

    Parameters
    ----------
    duration
        Time in s, from 1 µs to an hour.
    bound
        ``exactly``, ``at most`` or ``at least``.

    Returns
    -------
    Total
        The statement ``total``.

    Raises
    ------
    ValueError
        For another bound, or a time outside its range.

    Examples
    --------
    >>> total(10, "at most") == Total(10, "at most")
    True
    """
    if bound not in get_args(Bound):
        raise ValueError(f'total(bound={bound!r}): "exactly", "at most" or "at least" is needed')
    return Total(given("total", "duration", duration, "time"), bound)


def _change(
    call: str, direction: Heading, by: float | None, to: float | None, at: float | None, over: float | None
) -> Ramp:
    one_of(call, {"by": by, "to": to})
    one_of(call, {"at": at, "over": over})
    size = number(call, "by", by, "change" if direction == "change" else "difference")
    target = number(call, "to", to, "absolute")
    return Ramp(direction, size, target, number(call, "at", at, "rate"), number(call, "over", over, "time"))


def _statements(parts: Sequence[object]) -> tuple[Statement, ...]:
    """Return parts that are all statements; ValueError names the first that is not."""
    for part in parts:
        if not isinstance(part, Statement) or isinstance(part, Total):
            what = "total() concerns the whole icon" if isinstance(part, Total) else f"{part!r} is not a statement"
            raise ValueError(f"repeat(): {what}")
    return tuple(part for part in parts if isinstance(part, Statement))
