"""Statements written in Python as they are in a cue text: ``cool(by=6, at=3)``, in K, K/s, s, °C and A.

The statements themselves check what they are made of, and name their fields: a `by` is ``by_K``, an `at` a rate.
"""

from collections.abc import Callable
from inspect import cleandoc
from typing import TYPE_CHECKING

from .shapes import Pulse, Shape, Start, Step, Wave
from .statements import Bound, Current, Hold, Play, Ramp, Repeat, Rest, Return, Statement, Total

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


def _of_a_change(builder: Callable[..., Ramp]) -> Callable[..., Ramp]:
    """Put what they share before the examples of a docstring."""
    summary, _, examples = cleandoc(builder.__doc__ or "").partition("Examples\n")
    builder.__doc__ = f"{summary}{CHANGE}\nExamples\n{examples}"
    return builder


@_of_a_change
def cool(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Cool by a difference or to a temperature, at a rate or over a time.

    Examples
    --------
    >>> cool(by=6, at=3) == Ramp("cool", by_K=6, rate_K_per_s=3)
    True
    """
    return Ramp("cool", by, to, at, over)


@_of_a_change
def warm(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Warm by a difference or to a temperature, at a rate or over a time.

    Examples
    --------
    >>> warm(to=38, over=2) == Ramp("warm", to_C=38, duration_s=2)
    True
    """
    return Ramp("warm", by, to, at, over)


@_of_a_change
def ramp(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Change by a signed difference or to a temperature, at a rate or over a time.

    Examples
    --------
    >>> ramp(by=-6, at=3) == Ramp("change", by_K=-6, rate_K_per_s=3)
    True
    """
    return Ramp("change", by, to, at, over)


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
    return Current(to, at, over)


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
    return Hold(duration)


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
    return Rest(duration)


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
    return Return(at, over)


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
    return Repeat(count, body)


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
    return Total(duration, bound)


def step(
    *, by: float | None = None, to: float | None = None, by_A: float | None = None, to_A: float | None = None
) -> Step:
    """Step as fast as the driver can; give exactly one argument.

    Parameters
    ----------
    by
        Signed difference in K.
    to
        Temperature in °C.
    by_A
        Signed difference in A, under current control.
    to_A
        Current in A, under current control.

    Returns
    -------
    Step
        The statement ``step``.

    Raises
    ------
    ValueError
        Unless exactly one is given, within the limits of the language.

    Examples
    --------
    >>> step(by=-6) == Step(by_K=-6), step(to_A=0.5) == Step(to_A=0.5)
    (True, True)
    """
    return Step("change", by, to, by_A, to_A)


def pulse(*, by: float | None = None, by_A: float | None = None, duration: float) -> Pulse:
    """Step by a signed difference, hold, and step back.

    Parameters
    ----------
    by
        Difference in K; give `by` or `by_A`.
    by_A
        Difference in A, under current control.
    duration
        Time between the steps in s.

    Returns
    -------
    Pulse
        The statement ``pulse``.

    Raises
    ------
    ValueError
        Unless one difference is given, within the limits of the language.

    Examples
    --------
    >>> pulse(by=-3, duration=0.5) == Pulse(by_K=-3, duration_s=0.5)
    True
    """
    return Pulse("change", by, by_A, duration)


def wave(
    shape: Shape,
    *,
    by: float | None = None,
    every: float,
    duration: float,
    starting: Start | None = None,
    cut: bool = False,
    by_A: float | None = None,
) -> Wave:
    """Play a wave about the present level.

    Parameters
    ----------
    shape
        ``sine``, ``square``, ``triangle`` or ``sawtooth``, which rises slowly and falls in a step, or the reverse.
    by
        Amplitude in K; give `by` or `by_A`.
    every
        Period in s.
    duration
        Duration in s: a whole number of periods, unless `cut` is true.
    starting
        Direction at the start: ``warm`` or ``cool``, with `by_A` ``up`` or ``down``; None: the first of them.
    cut
        Whether the last period may be incomplete.
    by_A
        Amplitude in A, under current control.

    Returns
    -------
    Wave
        The statement ``sine``, ``square``, ``triangle`` or ``sawtooth``.

    Raises
    ------
    ValueError
        For another shape or direction, and for numbers outside the limits of the language.

    Examples
    --------
    >>> wave("sine", by=3, every=4, duration=12, starting="cool")
    Wave(shape='sine', by_K=3.0, by_A=None, period_s=4.0, duration_s=12.0, start='cool', cut=False)
    >>> wave("sawtooth", by_A=0.5, every=1, duration=3, starting="down").start
    'down'
    """
    return Wave(shape, by, by_A, every, duration, starting, cut)
