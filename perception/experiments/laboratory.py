"""A laboratory with one set of constants.

The quasi-random numbers of people and trials are the same for every set of constants, so that predictions change
smoothly with the constants, as a search for a maximum needs.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.circuit.solver.modes import thermode_modes

from ..observer.channels import CHANNELS, Channel
from ..observer.constants import Both
from ..observer.mechanisms.summation import CM2
from ..observer.observer import Observer
from ..observer.people import People, draw_people
from ..sensation.detection import quarters, strata

DT_S = 0.025
"""Step of drives: times of answers are interpolated within it."""
RAMP_GROWTH, HOLD_GROWTH = 0.03, 0.1
"""Steps in which passages are counted, as shares of the time since the last corner, where that is more than DT_S."""
EVERY = 4
"""Of so many samples one is enough for the noise of a channel that is at rest."""
LEAST_ROWS = 600
"""Samples of a response to a ramp that are computed at once: most stimuli take no more."""
FEEBLE = 1e-9
"""Least drive whose logarithm is taken."""
PEOPLE = 48
SEED = 7
SHARES = np.array([0.125, 0.375, 0.625, 0.875])
"""Middles of four equal parts of a distribution: sizes of gain, and shares of trials that have answered."""
TRIALS = SHARES.size**2
SHARES.setflags(write=False)
Corner = tuple[float, float]
"""A corner of a stimulus: time in s and change of the display from the baseline in K."""
Samples = NDArray[np.int64]
"""Numbers of the samples of a drive that are enough to count passages."""
Receptor = tuple[Array, float, float]
"""Response of a receptor to a unit ramp, its rest at 0 °C, and the change of that per K."""


@lru_cache(maxsize=4)
def trials_of(people: int, seed: int) -> Array:
    """Standard normal numbers (people, TRIALS), the same for every person, in an order of each person's own."""
    return np.random.default_rng(seed).permuted(np.tile(strata(TRIALS), (people, 1)), axis=1)


load_rig = lru_cache(maxsize=16)(Rig.load)


@lru_cache(maxsize=64)
def samples_of(corners: tuple[Corner, ...], end_s: float) -> Samples:
    """Samples between which the drive of a course from corner to corner, then held until `end_s`, changes little.

    >>> samples_of(((0.1, 1.0),), 1.6).size
    38
    """
    rows = round(end_s / DT_S)
    chosen, level = [0], 0.0
    for time_s, size in (*corners, (end_s, None)):
        first, last = chosen[-1], min(round(time_s / DT_S), rows)
        growth = HOLD_GROWTH if size is None or size == level else RAMP_GROWTH
        while chosen[-1] < last:
            step = max(1, int(growth * (chosen[-1] - first)))
            chosen.append(min(chosen[-1] + step, last))
        level = level if size is None else size
    samples = np.array(chosen, dtype=np.int64)
    samples.setflags(write=False)
    return samples


def course_of(rise: Array, rest: float, corners: Sequence[Corner], dt_s: float, rows: int) -> Array:
    """A course (rows,) by corners of the display: a sum of ramps, of the skin's response `rise` to 1 K/s."""
    course, clock, known = np.full(rows, rest), np.arange(rows), np.arange(rise.size)
    slope, start = 0.0, (0.0, 0.0)
    for corner in (*corners, None):
        rate = 0.0 if corner is None else (corner[1] - start[1]) / (corner[0] - start[0])
        if rate != slope:
            course += (rate - slope) * np.interp(clock - start[0] / dt_s, known, rise)
        if corner is not None:
            slope, start = rate, corner
    return course


@dataclass(frozen=True)
class Laboratory:
    """Constants, and how much more sensitive (ln) its people are under each name."""

    constants: Observer
    offsets: Mapping[str, Both[float]]
    people: People
    seed: int = SEED
    _receptors: dict[tuple[str, Channel], Receptor] = field(default_factory=dict, init=False, repr=False, compare=False)

    @classmethod
    def of(
        cls, constants: Observer, offsets: Mapping[str, Both[float]], people: int = PEOPLE, seed: int = SEED
    ) -> Self:
        """A laboratory with so many quasi-random people."""
        return cls(constants, offsets, draw_people(people, seed, observer=constants, how="sobol"), seed)

    @cached_property
    def _lanes(self) -> dict[Channel, tuple[Array, Array]]:
        """Gains, raised to the power p, and criteria (people x gains,) over the median person's."""
        gains, lanes = np.exp(self.constants.gain_noise * quarters(1.0)), {}
        for channel in CHANNELS:
            own = gains / self.people.threshold(channel)[:, None]
            lanes[channel] = own.ravel() ** self.constants.p, np.repeat(self.people.criterion(channel), gains.size)
        return lanes

    def _receptor(self, site_rig: str, channel: Channel, rows: int) -> Receptor:
        known = self._receptors.get((site_rig, channel))
        if known is None or known[0].size < rows:
            constants, rig, row = self.constants, load_rig(site_rig), CHANNELS.index(channel)
            row += 0 if constants.variable == "temperature" else len(CHANNELS)
            depths_m = constants.depths_m(rig.skin.corneum_m)
            skin = thermode_modes(rig, depths_m, constants.contact_m2K_per_W, constants.effusivity)
            at_0, at_1 = skin.rest(row, 0.0), skin.rest(row, 1.0)
            known = skin.rise(row, DT_S, max(rows, LEAST_ROWS)), at_0, at_1 - at_0
            self._receptors[site_rig, channel] = known
        return known

    def drive(
        self, site_rig: str, channel: Channel, baseline_C: float, corners: Sequence[Corner], end_s: float
    ) -> Array:
        """Receptor drive (rows,) of one channel, every DT_S, under a thermode that goes from corner to corner."""
        constants, rows = self.constants, round(end_s / DT_S) + 1
        rise, at_0, per_K = self._receptor(site_rig, channel, rows)
        if constants.variable == "heat flow":
            low, high = sorted(at_0 + per_K * level for level in constants.neutral_C)
            constants = replace(constants, neutral_flux=Both((low, high), (low, high)))
        received = course_of(rise, at_0 + per_K * baseline_C, corners, DT_S, rows)
        return constants.drive(received, DT_S, channel)

    def gain(self, channel: Channel, area_cm2: float, laboratory: str, site: str, age_years: float) -> float:
        """Multiples of threshold per unit of drive of the median person of a laboratory at a site, area and age."""
        constants = self.constants
        gain = constants.sensitivity(channel, area_cm2 * CM2, site) / constants.threshold_drive.of(channel)
        gain *= math.exp(self.offsets[laboratory].of(channel))
        return gain / constants.age_factor(age_years, channel)

    def passages(
        self, drive: Array, samples: Samples, channel: Channel, gain: float, criterion: float
    ) -> tuple[Array, Array]:
        """Times (people, TRIALS) at which sensation passes the criterion; probabilities (people, 4) that it does."""
        from ..kernels.crossing import passage

        constants, (raised, cautions) = self.constants, self._lanes[channel]
        times, risen = np.empty((raised.size, SHARES.size)), drive[samples] ** constants.p / constants.b
        passed = passage(
            risen, DT_S * samples, gain**constants.p * raised, constants.a, constants.criteria(criterion, cautions),
            constants.noise_correlation_s, SHARES, times,
        )  # fmt: skip
        return times.reshape(-1, TRIALS), passed.reshape(-1, SHARES.size)

    def outrun(self, drive: Array, samples: Samples, channel: Channel, gain: float, *, site: str) -> Array:
        """Share (people,) of speeded choices that noise of the other channel decides, or a guess at the end."""
        from ..kernels.crossing import outrun

        constants, both = self.constants, (channel, CHANNELS[1 - CHANNELS.index(channel)])
        (raised, cautions), (_, others) = (self._lanes[each] for each in both)
        late, other_late = (float(constants.delay_s(each, constants.path_m(site))) for each in both)
        time, risen = DT_S * samples, drive[samples] ** constants.p / constants.b
        moments, wrong = time[::EVERY], np.empty(raised.size)
        together = moments + other_late - late
        outrun(
            risen, time, gain**constants.p * raised, constants.a, constants.criteria(constants.criterion, cautions),
            constants.noise_correlation_s, constants.criteria(constants.criterion, others), moments,
            np.interp(together, time, np.arange(float(time.size))), wrong,
        )  # fmt: skip
        shares: Array = wrong.reshape(len(self.people), -1).mean(axis=1)
        return shares

    def answers_s(
        self,
        drive: Array,
        samples: Samples,
        channel: Channel,
        gain: float,
        *,
        site: str,
        choice: bool = False,
        caution: float = 1.0,
    ) -> Array:
        """Times (people, TRIALS) in s from the first sample of a drive to the answer; inf where there is none."""
        constants = self.constants
        crossed, _ = self.passages(drive, samples, channel, gain, caution * constants.criterion)
        longer = 1.0 + (constants.choice_s / constants.decision_s if choice else 0.0)
        decided = longer * np.exp(constants.decision_noise * trials_of(len(self.people), self.seed))
        late = constants.delay_s(channel, constants.path_m(site))
        return np.asarray(crossed + late + decided * self.people.decision_s[:, None])
