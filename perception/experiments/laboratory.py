"""One laboratory's view of a set of constants: drives of its stimuli, sensitivities of its people, answers.

Everything that a published experiment needs is asked of `Laboratory`: what receptors do under its thermode, how
sensitive its people are at its site, area and age, and when or whether they answer. Its people and trials have the same
quasi-random numbers for every set of constants: a change of a constant then changes a prediction smoothly, which a
search for a maximum needs.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from statistics import NormalDist
from typing import Self

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit import Rig
from thermicon.circuit.solver.modes import FELT, SkinModes, thermode_modes

from ..arrays import Array
from ..observer.channels import CHANNELS, Channel
from ..observer.constants import Both
from ..observer.mechanisms.summation import CM2
from ..observer.observer import Observer
from ..observer.people import People, draw_people
from ..sensation.detection import quarters

DT_S = 0.025
"""Step of drives: times of answers are interpolated within it."""
RAMP_GROWTH, HOLD_GROWTH = 0.03, 0.1
"""Steps in which passages are counted, as shares of the time since the last corner, where that is more than DT_S."""
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


@lru_cache(maxsize=4)
def trials_of(people: int, seed: int) -> Array:
    """Standard normal numbers (people, TRIALS), the same for every person, in an order of each person's own."""
    middles = [NormalDist().inv_cdf((trial + 0.5) / TRIALS) for trial in range(TRIALS)]
    return np.random.default_rng(seed).permuted(np.tile(middles, (people, 1)), axis=1)


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
    """A course (rows,) from rest by corners of the display, for skin with a response `rise` (rows or more,) to 1 K/s.

    It is a sum of ramps, one from every corner on, by how much the slope changes there.
    """
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

    @classmethod
    def of(
        cls, constants: Observer, offsets: Mapping[str, Both[float]], people: int = PEOPLE, seed: int = SEED
    ) -> Self:
        """A laboratory with so many quasi-random people."""
        return cls(constants, offsets, draw_people(people, seed, observer=constants, how="sobol"), seed)

    @cached_property
    def _lanes(self) -> dict[Channel, tuple[Array, Array, Samples]]:
        """Gains (ln) and criteria (people x gains) over the median person's, and which row is each person's.

        People stand in the order of their criteria, since the kernel is fastest where neighbours are alike.
        """
        lanes = {}
        for channel in CHANNELS:
            caution, middles = self.people.criterion(channel), quarters(1.0)
            order = np.argsort(caution)
            gains = self.constants.gain_noise * middles - np.log(self.people.threshold(channel)[order])[:, None]
            cautions = np.repeat(caution[order], middles.size)
            lanes[channel] = gains.ravel(), cautions, np.argsort(order)
        return lanes

    def _skin(self, site_rig: str) -> SkinModes:
        """Skin of a shipped rig under the laboratory's thermode."""
        constants, rig = self.constants, load_rig(site_rig)
        depths_m = constants.depths_m(rig.skin.corneum_m)
        return thermode_modes(rig, depths_m, constants.contact_m2K_per_W, constants.effusivity)

    @cached_property
    def _rises(self) -> dict[tuple[str, int], Array]:
        """What each site's receptors respond to a unit ramp, as long as was needed."""
        return {}

    def received(
        self, site_rig: str, channel: Channel, baseline_C: float, corners: Sequence[Corner], rows: int
    ) -> Array:
        """What receptors go by (rows,), every DT_S, under a thermode that goes from corner to corner."""
        skin, row = self._skin(site_rig), self._row(channel)
        rise = self._rises.get((site_rig, row))
        if rise is None or rise.size < rows:
            rise = self._rises[site_rig, row] = skin.rise(row, DT_S, max(rows, LEAST_ROWS))
        return course_of(rise, skin.rest(row, baseline_C), corners, DT_S, rows)

    def _row(self, channel: Channel) -> int:
        """The reading of a receptor: those of temperature come after FELT, then those of heat flow."""
        return len(FELT) + CHANNELS.index(channel) + (0 if self.constants.variable == "temperature" else len(CHANNELS))

    @cached_property
    def _psi_table(self) -> Array:
        from ..kernels import passage as first_passage

        logs = first_passage.LOG_U_FROM + first_passage.LOG_U_STEP * np.arange(first_passage.LOG_U_POINTS)
        return self.constants.psi(np.exp(logs))

    def drive(
        self, site_rig: str, channel: Channel, baseline_C: float, corners: Sequence[Corner], end_s: float
    ) -> Array:
        """Receptor drive (rows,) of one channel, every DT_S, under a thermode that goes from corner to corner."""
        constants, rows = self.constants, round(end_s / DT_S) + 1
        received = self.received(site_rig, channel, baseline_C, corners, rows)
        if constants.variable == "heat flow":
            skin, place = self._skin(site_rig), self._row(channel)
            low, high = sorted(skin.rest(place, level) for level in constants.neutral_C)
            constants = replace(constants, neutral_flux=Both((low, high), (low, high)))
        return constants.drive(received, DT_S, channel)

    def gain(self, channel: Channel, area_cm2: float, laboratory: str, site: str, age_years: float) -> float:
        """Multiples of threshold per unit of drive of the median person of a laboratory at a site, area and age."""
        constants = self.constants
        gain = constants.sensitivity(channel, area_cm2 * CM2, site) / constants.threshold_drive.of(channel)
        gain *= math.exp(self.offsets[laboratory].of(channel))
        return gain / constants.age_factor(age_years, channel)

    def delay_s(self, channel: Channel, site: str) -> float:
        """Conduction from a site to the brain, s."""
        return float(self.constants.delay_s(channel, self.constants.path_m(site)))

    def passages(
        self, drive: Array, samples: Samples, channel: Channel, gain: float, criterion: float
    ) -> tuple[Array, Array]:
        """Times (people, TRIALS) at which sensation passes the criterion; probabilities (people, 4) that it does."""
        from ..kernels import passage as first_passage

        log_gains, cautions, back = self._lanes[channel]
        times = np.empty((log_gains.size, SHARES.size))
        passed = first_passage.passage(
            np.log(np.maximum(drive[samples], FEEBLE)),
            DT_S * samples,
            log_gains + math.log(gain),
            criterion * cautions,
            self.constants.noise_correlation_s,
            self._psi_table,
            SHARES,
            times,
        )
        return times.reshape(-1, TRIALS)[back], passed.reshape(back.size, -1)[back]

    def decision_s(self, *, choice: bool) -> Array:
        """Decision times (people, TRIALS) in s, with the time that a choice takes where there is one."""
        constants, own = self.constants, self.people.decision_s[:, None]
        longer = 1.0 + (constants.choice_s / constants.decision_s if choice else 0.0)
        trials = trials_of(len(self.people), self.seed)
        return np.asarray(longer * own * np.exp(constants.decision_noise * trials))

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
        criterion = caution * self.constants.criterion
        crossed, _ = self.passages(drive, samples, channel, gain, criterion)
        return crossed + self.delay_s(channel, site) + self.decision_s(choice=choice)
