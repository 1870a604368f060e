"""Statements written in Python with the words of a cue text.

The statements themselves check what they are made of, and name their fields: a `by` is ``by_K``, an `at` a rate.
"""

import re
from collections.abc import Callable
from functools import wraps
from inspect import cleandoc, signature
from typing import TYPE_CHECKING, TypeVar, cast

from thermicon.base.checks.arguments import InputError, checked

from .statements import (
    Bound,
    Current,
    Hold,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Shape,
    Start,
    Statement,
    Step,
    Total,
    Wave,
)

if TYPE_CHECKING:
    from .icon import Icon

Builder = TypeVar("Builder", bound=Callable[..., object])
_TIME = "Time in s, from 1 µs to an hour."
ARGUMENTS = {
    "by": "Difference in K: signed, but positive for `cool` and `warm`, and for waves, whose amplitude it is.",
    "to": "Temperature in °C.",
    "by_A": "Signed difference, or amplitude of a wave, in A, under current control.",
    "to_A": "Current in A, under current control.",
    "current.to": "Current in A, within ±20 A.",
    "at": "Positive rate in K/s, or in A/s under current control; give `at` or `over`.",
    "over": "Time in s.",
    "duration": _TIME,
    "every": "Period in s.",
    "wave.duration": "Duration in s: a whole number of periods, unless `cut` is true.",
    "shape": "``sine``, ``square``, ``triangle`` or ``sawtooth``, which rises slowly and falls in a step, or reversed.",
    "starting": "Direction at the start: ``warm`` or ``cool``, with `by_A` ``up`` or ``down``; None: the first.",
    "cut": "Whether the last period may be incomplete.",
    "count": "Number of plays, a positive whole number.",
    "body": "The statements.",
    "icon": "The other icon.",
    "bound": "``exactly``, ``at most`` or ``at least``.",
}
"""What an argument of a builder is, by its name, or by builder and name where one is different."""
FIELDS = r"\b(by_K|to_C|to_A|rate_\w+|period_s|duration_s)\b"
"""Fields of statements that errors name, and builders call otherwise."""


def _described(builder: Builder) -> Builder:
    """Put arguments, result and errors before the example of a docstring."""
    call = signature(builder)
    summary, _, example = cleandoc(builder.__doc__ or "").partition("\n\n")
    rows = [
        f"{'*' * (argument.kind is argument.VAR_POSITIONAL)}{name}\n"
        f"    {ARGUMENTS.get(f'{builder.__name__}.{name}', ARGUMENTS[name])}"
        for name, argument in call.parameters.items()
    ]
    sections = {
        "Parameters": "\n".join(rows),
        "Returns": f"{call.return_annotation.__name__}\n    The statement.",
        "Raises": "ValueError\n    Unless what is given makes one statement within the limits of the language.",
        "Examples": example,
    }
    texts = [f"{title}\n{'-' * len(title)}\n{text}" for title, text in sections.items()]
    builder.__doc__ = "\n\n".join([summary, *texts])
    told = checked(builder)
    ours = {"rate": "at", "period": "every", "duration": "over" if "over" in call.parameters else "duration"}

    def spoken(field: re.Match[str]) -> str:
        stem = field[0].partition("_")[0]
        return field[0] if field[0] in call.parameters else ours.get(stem, stem)

    @wraps(told)
    def made(*args: object, **given: object) -> object:
        try:
            return told(*args, **given)
        except InputError as wrong:
            text = re.sub(": [A-Z][a-z]+[. ]", ": ", str(wrong), count=1)
            raise InputError(re.sub(FIELDS, spoken, text)) from None

    return cast(Builder, made)


@_described
def cool(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Cool by a difference or to a temperature, at a rate or over a time.

    >>> cool(by=6, at=3) == Ramp("cool", by_K=6, rate_K_per_s=3)
    True
    """
    return Ramp("cool", by, to, at, over)


@_described
def warm(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Warm by a difference or to a temperature, at a rate or over a time.

    >>> warm(to=38, over=2) == Ramp("warm", to_C=38, duration_s=2)
    True
    """
    return Ramp("warm", by, to, at, over)


@_described
def ramp(
    *, by: float | None = None, to: float | None = None, at: float | None = None, over: float | None = None
) -> Ramp:
    """Change by a signed difference or to a temperature, at a rate or over a time: the statement ``change``.

    >>> ramp(by=-6, at=3) == Ramp("change", by_K=-6, rate_K_per_s=3)
    True
    """
    return Ramp("change", by, to, at, over)


@_described
def current(*, to: float, at: float | None = None, over: float | None = None) -> Current:
    """Go to a current, at a rate or over a time; only under current control.

    >>> current(to=0.5, at=1) == Current(0.5, rate_A_per_s=1)
    True
    """
    return Current(to, at, over)


@_described
def hold(duration: float) -> Hold:
    """Stay at the present level.

    >>> hold(4) == Hold(duration_s=4)
    True
    """
    return Hold(duration)


@_described
def rest(duration: float) -> Rest:
    """Stay at baseline; an error away from it.

    >>> rest(1) == Rest(duration_s=1)
    True
    """
    return Rest(duration)


@_described
def back(*, at: float | None = None, over: float | None = None) -> Return:
    """Return to baseline, at a rate or over a time.

    >>> back(at=3) == Return(rate_per_s=3), back(over=2) == Return(duration_s=2)
    (True, True)
    """
    return Return(at, over)


@_described
def repeat(count: int, *body: Statement) -> Repeat:
    """Play statements several times.

    >>> repeat(3, cool(by=2, at=1), back(at=1)).count
    3
    """
    return Repeat(count, body)


@_described
def play(icon: "Icon") -> Play:
    """Play all statements of another icon, from baseline.

    >>> from thermicon.icons import Icon
    >>> play(Icon("wait", (rest(1),))).icon.name
    'wait'
    """
    return Play(icon)


@_described
def total(duration: float, bound: Bound = "exactly") -> Total:
    """State how long the whole icon lasts; this is checked, and changes nothing.

    >>> total(10, "at most") == Total(10, "at most")
    True
    """
    return Total(duration, bound)


@_described
def step(
    *, by: float | None = None, to: float | None = None, by_A: float | None = None, to_A: float | None = None
) -> Step:
    """Step as fast as the driver can; give exactly one argument.

    >>> step(by=-6) == Step(by_K=-6), step(to_A=0.5) == Step(to_A=0.5)
    (True, True)
    """
    return Step("change", by, to, by_A, to_A)


@_described
def pulse(*, by: float | None = None, by_A: float | None = None, duration: float) -> Pulse:
    """Step by a signed difference in K or A, hold for a time, and step back.

    >>> pulse(by=-3, duration=0.5) == Pulse(by_K=-3, duration_s=0.5)
    True
    """
    return Pulse("change", by, by_A, duration)


@_described
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

    >>> wave("sine", by=3, every=4, duration=12, starting="cool")
    Wave(shape='sine', by_K=3.0, by_A=None, period_s=4.0, duration_s=12.0, start='cool', cut=False)
    >>> wave("sawtooth", by_A=0.5, every=1, duration=3, starting="down").start
    'down'
    """
    return Wave(shape, by, by_A, every, duration, starting, cut)
