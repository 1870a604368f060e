"""One laboratory's view of a set of constants: drives of its stimuli, sensitivities of its people, answers.

Everything that a published experiment needs is asked of `Laboratory`: what receptors do under its thermode, how
sensitive its people are at its site, area and age, and when or whether they answer. Its people and trials have the same
quasi-random numbers for every set of constants: a change of a constant then changes a prediction smoothly, which a
search for a maximum needs.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..observer.channels import CHANNELS, Channel, sign_of
from ..observer.constants import Both
from ..observer.observer import Observer
from ..sensation.detection import quarters
from ..sensation.sensation import area_factor
from .skin_modes import Corner, SkinModes, course_of, skin_modes

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
Samples = NDArray[np.int64]
"""Numbers of the samples of a drive that are enough to count passages."""


@dataclass(frozen=True, slots=True)
class Crowd:
    """Standard normal numbers: `people` (people, 5) for cold and warm sensitivity, cold and warm criterion, and
    decision; `decisions` (people, TRIALS) for decision times; `gains` (4,) for the gain of a presentation.
    """

    people: Array
    decisions: Array
    gains: Array

    def __len__(self) -> int:
        return int(self.people.shape[0])


@lru_cache(maxsize=4)
def draw_crowd(people: int = PEOPLE, seed: int = SEED) -> Crowd:
    """A crowd whose columns have mean 0 and SD 1."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    points = qmc.Sobol(5, seed=seed).random_base2(int(np.ceil(np.log2(people))))[:people]
    normal = ndtri(np.clip(points, 1e-6, 1.0 - 1e-6))
    normal = (normal - normal.mean(axis=0)) / normal.std(axis=0)
    middles = ndtri((np.arange(TRIALS) + 0.5) / TRIALS)
    decisions = np.random.default_rng(seed).permuted(np.tile(middles, (people, 1)), axis=1)
    return Crowd(normal, decisions, quarters(1.0))


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


@dataclass(frozen=True)
class Laboratory:
    """Constants, and how much more sensitive (ln) its people are under each name; `people` of a seed take part."""

    constants: Observer
    offsets: Mapping[str, Both[float]]
    people: int = PEOPLE
    seed: int = SEED

    @property
    def crowd(self) -> Crowd:
        """The people that take part in every experiment."""
        return draw_crowd(self.people, self.seed)

    @cached_property
    def sensitivity(self) -> dict[Channel, Array]:
        """Sensitivity of each person (people,) over the median person's, by channel."""
        normal = self._correlated(0)
        return {c: np.exp(self.constants.sensitivity_between.of(c) * normal[c]) for c in CHANNELS}

    @cached_property
    def caution(self) -> dict[Channel, Array]:
        """Criterion of each person (people,) over the median person's, by channel."""
        normal = self._correlated(2)
        return {c: np.exp(self.constants.criterion_between * normal[c]) for c in CHANNELS}

    def _correlated(self, column: int) -> dict[Channel, Array]:
        """Standard normal numbers of both channels, correlated as people's sensitivities and criteria are."""
        shared, z = self.constants.correlation, self.crowd.people
        warm: Array = shared * z[:, column] + math.sqrt(1.0 - shared**2) * z[:, column + 1]
        return {"cold": z[:, column], "warm": warm}

    @cached_property
    def _lanes(self) -> dict[Channel, tuple[Array, Array, Samples]]:
        """Gains (ln) and criteria (people x gains) over the median person's, and which row is each person's.

        People stand in the order of their criteria, since the kernel is fastest where neighbours are alike.
        """
        lanes = {}
        for channel in CHANNELS:
            order = np.argsort(self.caution[channel])
            gains = np.log(self.sensitivity[channel][order])[:, None] + self.constants.gain_noise * self.crowd.gains
            cautions = np.repeat(self.caution[channel][order], self.crowd.gains.size)
            lanes[channel] = gains.ravel(), cautions, np.argsort(order)
        return lanes

    @cached_property
    def _responses(self) -> dict[tuple[str, Channel], tuple[Array, float]]:
        """What each site's receptors respond to a unit ramp, as long as was needed, and to a unit step in the end."""
        return {}

    def _response(
        self, site_rig: str, channel: Channel, skin: SkinModes, depth_m: float, rows: int
    ) -> tuple[Array, float]:
        known = self._responses.get((site_rig, channel))
        if known is None or known[0].size < rows:
            ramp = skin.ramp_response(depth_m, DT_S, max(rows, LEAST_ROWS), self.constants.variable)
            known = ramp, skin.at(depth_m, self.constants.variable)[0]
            self._responses[site_rig, channel] = known
        return known

    @cached_property
    def _psi_table(self) -> Array:
        from ..kernels import passage as first_passage

        logs = first_passage.LOG_U_FROM + first_passage.LOG_U_STEP * np.arange(first_passage.LOG_U_POINTS)
        return self.constants.psi(np.exp(logs))

    def drive(
        self, site_rig: str, channel: Channel, baseline_C: float, corners: Sequence[Corner], end_s: float
    ) -> Array:
        """Receptor drive (rows,) of one channel, every DT_S, under a thermode that goes from corner to corner."""
        from ..kernels.kernels import adapted_drive

        constants = self.constants
        skin = skin_modes(site_rig, constants.contact_m2K_per_W, constants.effusivity)
        depth = skin.corneum_m + constants.depth_m.of(channel)
        rows = round(end_s / DT_S) + 1
        ramp, steady = self._response(site_rig, channel, skin, depth, rows)
        baseline = skin.resting(baseline_C, steady, constants.variable)
        received = course_of(ramp, baseline, corners, DT_S, rows)
        neutral = constants.neutral_C
        if constants.variable == "heat flow":
            flows = sorted(skin.baseline(level, depth, "heat flow") for level in neutral)
            neutral = flows[0], flows[1]
        drive = np.empty((1, rows))
        adapted_drive(
            received[None],
            DT_S,
            sign_of(channel),
            constants.limit_C.of(channel),
            constants.softness_K,
            *neutral,
            constants.integration_s,
            constants.adaptation_s,
            drive,
        )
        row: Array = drive[0]
        return row

    def gain(self, channel: Channel, area_cm2: float, laboratory: str, site: str, age_years: float) -> float:
        """Multiples of threshold per unit of drive of the median person of a laboratory at a site, area and age."""
        constants = self.constants
        gain = area_factor(area_cm2, constants.reference_area_m2 * 1e4, constants.area_exponent.of(channel))
        gain /= constants.threshold_drive.of(channel) * constants.site_factor(channel, site)
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
        middle = self.constants.decision_s + (self.constants.choice_s if choice else 0.0)
        between = self.constants.decision_between * self.crowd.people[:, 4]
        within = self.constants.decision_noise * self.crowd.decisions
        times: Array = middle * np.exp(between[:, None] + within)
        return times

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
