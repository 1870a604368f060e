"""Identifiability of rig parameters from a log."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.faults import unit_of
from ..rig.rig import Rig
from .keys import value_of
from .problem import FitProblem
from .runs import Channel
from .solve import Solution, covariance_of, inverse_of

T95 = 1.96
"""Half of a 95 % interval in standard deviations, of a normal distribution."""
NOISE_K, NOISE_V = 0.02, 0.005
"""Noise of a further channel that is only considered: a thermistor and a 16-bit voltage input."""

BOUND = 1e-3
"""A parameter within this share of its room from a bound is at the bound."""

FURTHER = ("display_C", "voltage_V", "hot_plate_C", "skin_C")
"""Columns that a log without them may be advised to have."""
CLOSE = 0.9
"""Correlation from which on two parameters are named as a pair that the log does not separate."""

WORSE = 1.5
"""A key is not told along with others if one of them is then known so many times worse."""

WHOLE = 1.0
"""A scale is not known to its own size: however small it was fitted, nothing is said of it."""


@dataclass(frozen=True, slots=True)
class FittedParameter:
    """One fitted parameter: what the rig had (`start`), what was fitted, and the ends of its 95 % interval.

    `log`: a scale, with a relative interval. `identified`: the interval is narrower than what is assumed anyway;
    otherwise `cure` says which measurement would identify it.
    """

    key: str
    words: str
    unit: str
    start: float
    value: float
    low: float
    high: float
    log: bool
    identified: bool
    cure: str = ""

    @property
    def half_width(self) -> float:
        """Half of the interval: the larger side as a share for a scale, otherwise in the unit of the key."""
        most = max(self.high - self.value, self.value - self.low)
        return most / self.value if self.log else most

    @property
    def interval(self) -> str:
        """The half width as people write it, ±3 % or ±0.4 K."""
        return width_text(self.log, self.half_width, self.unit)


def width_text(log: bool, width: float, unit: str) -> str:
    """Half of an interval as people write it."""
    if not log:
        return f"±{width:.2g} {'K' if unit == '°C' else unit}"
    return f"±{100 * width:.2g} %" if width < WHOLE else "unknown"


def half_width(log: bool, sd: float) -> float:
    """Half of a 95 % interval from the standard deviation of a fitted number, as `FittedParameter.half_width`."""
    return math.expm1(min(T95 * sd, 50.0)) if log else T95 * sd


def identified(
    problem: FitProblem, solution: Solution, start: Rig, *, mend: str = ""
) -> tuple[tuple[FittedParameter, ...], Array]:
    """The free keys with intervals, against the rig as given, and correlations; none is known of a fit to `mend`."""
    count, theta = len(problem.keys), solution.theta
    deviation = np.sqrt(np.diag(solution.covariance)[:count])
    correlation = solution.covariance[:count, :count] / np.outer(deviation, deviation)
    # a scale that is fitted smaller is known as a share of what the rig had
    share = [math.exp(min(0.0, theta[k] - problem.first[k])) if key.log else 1.0 for k, key in enumerate(problem.keys)]
    wanting = [
        k
        for k, key in enumerate(problem.keys)
        if mend
        or not half_width(key.log, share[k] * float(deviation[k])) < key.usual
        or (key.log and half_width(True, float(deviation[k])) >= WHOLE)
        or _at_bound(problem, theta, k)
    ]
    advice = dict.fromkeys(wanting, mend) if mend else cures(problem, theta, wanting, correlation)
    parameters = []
    for k, key in enumerate(problem.keys):
        half, before = T95 * float(deviation[k]), value_of(start, key.key)
        ends = (float(theta[k]) - half, float(theta[k]), float(theta[k]) + half)
        low, value, high = (math.exp(min(end, 500.0)) for end in ends) if key.log else ends
        if key.key.endswith("lag_s"):
            low = max(low, 0.0)
        assert before is not None
        parameters.append(
            FittedParameter(
                key.key, key.words, unit_of(key.key), before, value, low, high, key.log, k not in wanting,
                advice.get(k, ""),
            )
        )  # fmt: skip
    return tuple(parameters), correlation


def _at_bound(problem: FitProblem, theta: Array, place: int) -> bool:
    item = problem.unknowns[place]
    near = BOUND * (item.high - item.low)
    low = theta[place] - item.low < near and not problem.keys[place].key.endswith("lag_s")
    return bool(low or item.high - theta[place] < near)


def with_channels(problem: FitProblem, theta: Array, columns: Sequence[str], only: bool = False) -> FitProblem:
    """Return the problem with further channels in every run, read on the drive's clock; `only`: in place of its own."""
    found = problem.simulated(theta)
    runs = []
    for run, rows in zip(problem.runs, found, strict=True):
        kept, clocks, time_s = ((), (), run.time_s) if only else (run.channels, run.clocks, run.time_s)
        extra = (Channel(each, run.name, 0, time_s + run.begin_s, rows.at(each, time_s)) for each in columns)
        runs.append(replace(run, channels=(*kept, *extra), clocks=clocks))
    return problem.again(problem.rig, problem.keys, tuple(runs))


def expected_sd(problem: FitProblem, theta: Array) -> Array:
    """Standard deviations of the keys to expect from a problem's channels with white noise."""
    count = len(problem.keys)
    point = problem.first.copy()
    point[:count] = theta[:count]
    sigma = [NOISE_K if channel.temperature else NOISE_V for _, _, channel in problem.channels()]
    covariance = covariance_of(problem, problem.jacobian(point, sigma), [1.0] * len(sigma))
    return np.sqrt(np.diag(covariance)[:count])


def tellable(problem: FitProblem) -> tuple[str, ...]:
    """Free keys that the channels tell together: all better known than assumed, none much worse than without another.

    Noise is that of ten independent readings a second.
    """
    count, sigma = len(problem.keys), list[float]()
    for _, _, channel in problem.channels():
        share = 0.1 / max(float(np.median(np.diff(channel.time_s))), 1e-6)
        sigma.append((NOISE_K if channel.temperature else NOISE_V) * math.sqrt(max(1.0, share)))
    jacobian = problem.jacobian(problem.first, sigma)
    information, along = jacobian.T @ jacobian, range(count, len(problem.unknowns))
    told = dict[int, float]()
    for place in range(count):
        columns = [*told, place, *along]
        deviations = np.sqrt(np.abs(np.diag(inverse_of(information[np.ix_(columns, columns)]))))
        keys = [problem.keys[k] for k in (*told, place)]
        wide = [half_width(key.log, float(sd)) for key, sd in zip(keys, deviations, strict=False)]
        good = all(width < key.usual for key, width in zip(keys, wide, strict=True))
        if (
            good
            and jacobian[:, place].any()
            and all(new <= WORSE * old for new, old in zip(wide, told.values(), strict=False))
        ):
            told = dict(zip((*told, place), wide, strict=True))
    return tuple(problem.keys[k].key for k in told)


def cures(problem: FitProblem, theta: Array, wanting: Sequence[int], correlation: Array) -> dict[int, str]:
    """Return for each parameter that is not identified which measurement would identify it."""
    if not wanting:
        return {}
    logged = {channel.column for _, _, channel in problem.channels()}
    options = [name for name in (("skin_C",) if problem.alone else FURTHER) if name not in logged]
    gains = {name: expected_sd(with_channels(problem, theta, [name]), theta) for name in options}
    return {place: _cure(problem, place, gains, correlation) for place in wanting}


def _cure(problem: FitProblem, place: int, gains: dict[str, Array], correlation: Array) -> str:
    key = problem.keys[place]
    widths = {name: half_width(key.log, float(sd[place])) for name, sd in gains.items()}
    good = {name: width for name, width in widths.items() if width < key.usual}
    with_what = [
        problem.keys[other].words
        for other in range(len(problem.keys))
        if other != place and abs(correlation[place, other]) > CLOSE
    ]
    why = f"cannot be separated from {' and '.join(with_what)} here; " if with_what else ""
    if good:
        best = min(good, key=lambda name: good[name])
        size = width_text(key.log, good[best], unit_of(key.key))
        return f"{why}log {best} as well: it would then be known to about {size}"
    return f"{why}measure it directly: {key.direct}"
