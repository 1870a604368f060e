"""The identification task with the noise of memory.

People distinguish two rates that differ by a fixed fraction, whatever rate and span (Bergmann Tiest & Kappers 2009).
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.records import Record, RecordTable
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig

from ..observer.channels import source_of
from ..observer.constants import QUANTITIES
from ..observer.mechanisms.memory import NOISE
from ..observer.observer import MEMORY_FORMS, MemoryForm, Observer
from ..sensation.bench import Bench, ramp
from ..sensation.percept import perceive_many
from .episodes import Episodes, episode_distances

RIG = "thenar"
TAIL_S = 10.0
LOG_NOISE = (math.log(1e-3), math.log(20.0))
"""Logs of the least and largest noise that is tried."""


def memory_noise(known: RecordTable, observer: Observer) -> Record:
    """Memory noise at which the rate task comes out as published."""
    fraction = known.one("rate Weber fraction")
    rates, spans = known.one("rate of the rate task").interval, known.one("span of the rate task").interval
    criteria = known.one("criterion of the rate task").interval
    cases = [Episodes.of(cold[None], warm[None], dt, observer) for cold, warm, dt in _felt(known, observer)]
    found = [[_noise_of(case, proportion, observer) for case in cases] for proportion in criteria]
    ends = [math.sqrt(sum(v * v for v in values) / len(values)) for values in found]  # variances are averaged
    every = [v for values in found for v in values]
    spread = max(max(values) / min(values) for values in found)
    conditions = (
        f"skin-surface coolings at {rates[0]:g} and {rates[1]:g} K/s over {spans[0]:g} and {spans[1]:g} K against "
        f"{1 + fraction.central:g} times the rate; {criteria[0]:g} and {criteria[1]:g} correct are the ends; "
        f"largest over smallest condition {spread:.3f}, all {min(every):.3f} to {max(every):.3f}"
    )
    middle = math.sqrt(sum(v * v for v in ends) / len(ends))
    made = memory_record(source_of(observer.variable), middle, min(ends), max(ends))
    return replace(made, source=f"calibrated on: {fraction.source}", conditions=conditions)


def memory_record(variant: str, value: float, low: float, high: float) -> Record:
    """A record of the memory noise of a variant, by the ending of its names; not calibrated yet."""
    return Record(
        quantity=f"{QUANTITIES[NOISE]}{variant}",
        unit="log units",
        source="not calibrated yet",
        value=value,
        low=low,
        high=high,
        channel="both",
        method="episodes",
        confidence="low",
        use="calibrate",
    )


def _noise_of(episodes: Episodes, proportion: float, observer: Observer) -> float:
    """Memory noise at which a condition comes out with a proportion correct, Φ(d′/√2) in a two-interval choice."""
    from scipy.optimize import brentq

    wanted = math.sqrt(2.0) * NormalDist().inv_cdf(proportion)

    def missed(log_noise: float) -> float:
        person = replace(observer, timing_noise=math.exp(log_noise), rated_share=0.0)
        return float(episode_distances(episodes, episodes, person, "episodes")[0, 0, 1]) - wanted

    low, high = LOG_NOISE
    if missed(high) > 0.0 or missed(low) < 0.0:
        raise ValueError(
            f"no memory noise of {math.exp(low):.2g} to {math.exp(high):.2g} log units gives the rate task "
            f"{proportion:g} correct"
        )
    return math.exp(float(brentq(missed, low, high, xtol=1e-6)))


def _felt(known: RecordTable, observer: Observer) -> Iterator[tuple[Array, Array, float]]:
    """Cold and warm sensations (2, n_time) of every rate and span of the task, and the step of their clock in s."""
    bench, fraction = Bench(Rig.load(RIG)), known.one("rate Weber fraction").central
    rates, spans = known.one("rate of the rate task").interval, known.one("span of the rate task").interval
    for rate, span in itertools.product(rates, spans):
        both = [ramp("cold", span, own) for own in (rate, rate * (1.0 + fraction))]
        played = bench.play(both, round(span / rate + TAIL_S, 2))
        yield *perceive_many(*played.received(observer), played.dt_s, observer), played.dt_s


LONGEST_GAP_S = 600.0


@checked
@dataclass(frozen=True, slots=True)
class Task:
    """An identification task; the default has a long pause before every icon, after which all has faded.

    There is no thermal record of what a gap changes. `rank` fills in the other fields for the icons at hand.

    Attributes
    ----------
    gap_s
        Time from the end of one icon to the next, 0 to 600 s; None: all has faded.
    carried
        What the icons before change of each (forms, icons), d′.
    counted
        Places of the icons that will be played; none: all.

    Raises
    ------
    InputError
        For a gap out of its range.

    Examples
    --------
    >>> Task(gap_s=-1.0)
    Traceback (most recent call last):
    ...
    thermicon.base.checks.arguments.InputError: Task: a gap of -1 s between icons must lie in 0 to 600 s
    """

    gap_s: float | None = None
    carried: tuple[tuple[float, ...], ...] = ()
    counted: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.gap_s is not None and not 0.0 <= self.gap_s <= LONGEST_GAP_S:
            raise ValueError(f"a gap of {self.gap_s:g} s between icons must lie in 0 to {LONGEST_GAP_S:g} s")

    def between(self, noise: Array, form: MemoryForm) -> Array:
        """Noise (people, icons, icons) between icons that also vary with what was felt before them."""
        own = np.array(self.carried[MEMORY_FORMS.index(form)])
        return np.asarray(np.sqrt(noise**2 + 0.5 * (own[:, None] ** 2 + own[None, :] ** 2)))

    def louder(self, memory: Array, form: MemoryForm) -> Array | float:
        """Multiples (people, icons) of the noise of icons that also vary with what was felt before them."""
        if not self.carried:
            return 1.0
        own = np.array(self.carried[MEMORY_FORMS.index(form)])
        return np.asarray(np.hypot(1.0, own[None, :] / memory[:, None]))


USUAL = Task()
"""A long pause before every icon."""
