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
from ..observer.channels import CHANNELS, Channel, Variable, sign_of
from ..observer.observer import load_thresholds
from ..observer.parts import Transducer, conduction_s
from ..observer.people import YOUNG_YEARS
from ..sensation.detection import quarters
from ..sensation.sensation import NO_LIMIT_C, area_factor
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
    """Constants by name, as `priors.toml` names them, for one sensory variable; `people` of a seed take part."""

    values: Mapping[str, float]
    variable: Variable = "temperature"
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
        return {c: np.exp(self.values[f"{c} sensitivity between people"] * normal[c]) for c in CHANNELS}

    @cached_property
    def caution(self) -> dict[Channel, Array]:
        """Criterion of each person (people,) over the median person's, by channel."""
        normal = self._correlated(2)
        return {c: np.exp(self.values["criterion between people"] * normal[c]) for c in CHANNELS}

    def _correlated(self, column: int) -> dict[Channel, Array]:
        """Standard normal numbers of both channels, correlated as people's sensitivities and criteria are."""
        shared, z = self.values["correlation of cold and warm"], self.crowd.people
        warm: Array = shared * z[:, column] + math.sqrt(1.0 - shared**2) * z[:, column + 1]
        return {"cold": z[:, column], "warm": warm}

    @cached_property
    def transducer(self) -> Transducer:
        """How drive becomes sensation."""
        return Transducer(self.values["slope of sensation"], self.values["transducer exponent"])

    @cached_property
    def _lanes(self) -> dict[Channel, tuple[Array, Array, Samples]]:
        """Gains (ln) and criteria (people x gains) over the median person's, and which row is each person's.

        People stand in the order of their criteria, since the kernel is fastest where neighbours are alike.
        """
        lanes = {}
        for channel in CHANNELS:
            order = np.argsort(self.caution[channel])
            gains = np.log(self.sensitivity[channel][order])[:, None] + self.values["gain noise"] * self.crowd.gains
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
            ramp = skin.ramp_response(depth_m, DT_S, max(rows, LEAST_ROWS), self.variable)
            known = ramp, skin.at(depth_m, self.variable)[0]
            self._responses[site_rig, channel] = known
        return known

    @cached_property
    def _psi_table(self) -> Array:
        from ..kernels import passage as first_passage

        logs = first_passage.LOG_U_FROM + first_passage.LOG_U_STEP * np.arange(first_passage.LOG_U_POINTS)
        return self.transducer.psi(np.exp(logs))

    def drive(
        self, site_rig: str, channel: Channel, baseline_C: float, corners: Sequence[Corner], end_s: float
    ) -> Array:
        """Receptor drive (rows,) of one channel, every DT_S, under a thermode that goes from corner to corner."""
        from ..kernels.kernels import adapted_drive

        values = self.values
        skin = skin_modes(site_rig, values["contact resistance of a thermode"], values["effusivity of living skin"])
        depth = skin.corneum_m + 1e-3 * values[f"{channel} receptor depth"]
        rows = round(end_s / DT_S) + 1
        ramp, steady = self._response(site_rig, channel, skin, depth, rows)
        baseline = skin.resting(baseline_C, steady, self.variable)
        received = course_of(ramp, baseline, corners, DT_S, rows)
        neutral = _published().neutral_C
        if self.variable == "heat flow":  # whose limits are so far away that they do nothing
            flows = sorted(skin.baseline(level, depth, "heat flow") for level in neutral)
            limit, neutral = -NO_LIMIT_C * sign_of(channel), (flows[0], flows[1])
        else:
            limit = values[f"{channel} limit"]
        drive = np.empty((1, rows))
        adapted_drive(
            received[None],
            DT_S,
            sign_of(channel),
            limit,
            values["softness of the limits"],
            *neutral,
            values["integration time"],
            values["slow adaptation time"],
            drive,
        )
        row: Array = drive[0]
        return row

    def gain(self, channel: Channel, area_cm2: float, laboratory: str, site: str, age_years: float) -> float:
        """Multiples of threshold per unit of drive of the median person of a laboratory at a site, area and age."""
        values = self.values
        gain = area_factor(area_cm2, _published().area_cm2, values[f"{channel} area exponent"])
        gain /= values[f"{channel} threshold drive"]
        if site == "forearm":
            gain /= values[f"{channel} threshold on the forearm"]
        gain *= math.exp(values["sensitivity between laboratories"] * values[f"{laboratory} {channel}"])
        decades = (age_years - YOUNG_YEARS) / 10.0
        return gain * math.exp(-values[f"{channel} sensitivity lost per decade"] * decades)

    def delay_s(self, channel: Channel, site: str) -> float:
        """Conduction from a site to the brain, s."""
        return float(conduction_s(channel, self.values[f"{channel} conduction velocity"], _published().path_m[site]))

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
            self.values["noise correlation time"],
            self._psi_table,
            SHARES,
            times,
        )
        return times.reshape(-1, TRIALS)[back], passed.reshape(back.size, -1)[back]

    def decision_s(self, *, choice: bool) -> Array:
        """Decision times (people, TRIALS) in s, with the time that a choice takes where there is one."""
        middle = self.values["decision time"] + (self.values["choice time"] if choice else 0.0)
        between = self.values["decision time between people"] * self.crowd.people[:, 4]
        within = self.values["decision time between trials"] * self.crowd.decisions
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
        criterion = caution * self.values["criterion of speeded answers"]
        crossed, _ = self.passages(drive, samples, channel, gain, criterion)
        return crossed + self.delay_s(channel, site) + self.decision_s(choice=choice)


@dataclass(frozen=True, slots=True)
class _Published:
    """Numbers of thresholds.toml that are not inferred: reference area, neutral zone, paths to the cord by site."""

    area_cm2: float
    neutral_C: tuple[float, float]
    path_m: Mapping[str, float]


@lru_cache(maxsize=1)
def _published() -> _Published:
    known = load_thresholds()
    return _Published(
        known.one("thermode area of the forced-choice thresholds").central,
        known.one("complete adaptation").interval,
        {site: known.one("path length to the cord", site=site).central for site in ("hand", "forearm")},
    )
