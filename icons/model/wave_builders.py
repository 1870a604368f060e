"""Steps, pulses and waves written in Python as they are in a cue text: ``pulse(by=-3, duration=0.5)``."""

from typing import get_args

from .builder_arguments import amperes, given, number, one_of
from .shapes import Pulse, Shape, Start, Step, Wave


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
    one_of("step", {"by": by, "to": to, "by_A": by_A, "to_A": to_A})
    by, to = number("step", "by", by, "change"), number("step", "to", to, "absolute")
    amount = amperes("step", by_A)
    return Step("change", by, to, amount, number("step", "to_A", to_A, "current"))


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
    one_of("pulse", {"by": by, "by_A": by_A})
    by, amount = number("pulse", "by", by, "change"), amperes("pulse", by_A)
    return Pulse("change", by, amount, given("pulse", "duration", duration, "time"))


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
    if shape not in get_args(Shape):
        raise ValueError(f'wave({shape!r}): "sine", "square", "triangle" or "sawtooth" is needed')
    one_of("wave", {"by": by, "by_A": by_A})
    size, amount = number("wave", "by", by, "difference"), amperes("wave", by_A)
    ways = ("warm", "cool") if by_A is None else ("up", "down")
    if amount is not None and amount < 0:
        raise ValueError(f'wave(by_A={by_A!r}): an amplitude is positive; to begin downwards, say starting="down"')
    if starting not in (None, *ways):
        raise ValueError(f'wave(starting={starting!r}): "{ways[0]}" or "{ways[1]}" is needed')
    if not isinstance(cut, bool):
        raise ValueError(f"wave(cut={cut!r}): True or False is needed")
    period, time = given("wave", "every", every, "time"), given("wave", "duration", duration, "time")
    return Wave(shape, size, amount, period, time, starting, cut)
