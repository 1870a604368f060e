"""What the people of a laboratory reach in measurements: logs of thresholds, reaction times and ratings.

The measurements are played and asked as the published experiments are that the constants were inferred from (see
`inference.experiments`), on the skin of the rig's site, with its contact and area, and with the laboratory's own offset
of sensitivity. People are a quasi-random crowd with the spreads of the draw.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..experiments.crowd import PEOPLE, SEED, Crowd, draw_crowd
from ..experiments.laboratory import FEEBLE, Laboratory, Samples, samples_of
from ..experiments.published import psychometric_logs
from ..experiments.task_constants import UNSTATED
from ..kernels.parallel import in_order
from ..observer.channels import CHANNELS, sign_of
from ..observer.draws import BETWEEN_LABORATORIES
from ..observer.observer import on_forearm
from ..observer.people import YOUNG_YEARS
from .measurements import Condition
from .states import OFFSETS, Laboratories, LaboratoryPrior

if TYPE_CHECKING:
    from thermicon.circuit import Rig

OWN = "own"
"""Name of the laboratory whose offset is the user's."""
SITES = ("thenar", "forearm", "hand-dorsum", "fingertip")
"""Sites whose skin is shipped, as rigs of the same name."""
CHOICE_SIZES_K = np.geomspace(0.01, 8.0, 10)
YES_NO_SIZES_K = np.geomspace(0.05, 12.0, 9)
AFTER_S = 3.0
"""Seconds after a timed ramp in which an answer still counts."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Skin, contact and area under which measurements were made."""

    site_rig: str
    contact_m2K_per_W: float
    area_cm2: float

    @classmethod
    def of(cls, rig: Rig) -> Setting:
        """The setting of a rig; a ValueError for a site whose skin is not known."""
        if rig.site not in SITES:
            raise ValueError(
                f"measurements can be simulated at {', '.join(SITES)}; {rig.name} is at {rig.site!r}: give a rig of "
                "one of these sites"
            )
        return cls(rig.site, rig.contact.resistance_m2K_per_W, rig.contact.area_m2 * 1e4)

    @property
    def path_site(self) -> str:
        """Site by which thresholds and paths to the cord differ."""
        return "forearm" if on_forearm(self.site_rig) else "hand"


@dataclass(frozen=True)
class MeasuringLaboratory(Laboratory):
    """A laboratory with a crowd of its own, instead of the one that the inference uses."""

    people: int = PEOPLE
    seed: int = SEED

    @property
    def crowd(self) -> Crowd:
        """The people that take part."""
        return draw_crowd(self.people, self.seed)

    def measure(self, setting: Setting, condition: Condition) -> tuple[Array, float]:
        """Log value of each person (people,), and the SD of the log of one trial (UNSTATED where there is none)."""
        gain = self.gain(condition.channel, setting.area_cm2, OWN, setting.path_site, YOUNG_YEARS)
        if condition.kind == "reaction_time" or condition.method == "limits":
            return self._timed(setting, condition, gain)
        if condition.kind == "rating":
            return self._rated(setting, condition, gain)
        if condition.method == "yes_no":
            return self._reported(setting, condition, gain), UNSTATED
        return self._chosen(setting, condition, gain), UNSTATED

    def _drive(self, setting: Setting, condition: Condition, size_K: float, hold_s: float) -> tuple[Array, Samples]:
        """Drive of a ramp that is held, and the samples that are enough to count passages."""
        top_s = size_K / condition.rate_K_per_s
        corners = ((top_s, sign_of(condition.channel) * size_K),)
        drive = self.drive(setting.site_rig, condition.channel, condition.baseline_C, corners, top_s + hold_s)
        return drive, samples_of(corners, top_s + hold_s)

    def _timed(self, setting: Setting, condition: Condition, gain: float) -> tuple[Array, float]:
        limits = condition.method == "limits"
        size, rate = condition.size_K or 0.0, condition.rate_K_per_s
        drive, samples = self._drive(setting, condition, size, 0.0 if limits else max(condition.hold_s, AFTER_S))
        times = self.answers_s(
            drive, samples, condition.channel, gain, site=setting.path_site, choice=condition.method == "choice"
        )
        if limits:
            logs = np.log(np.minimum(rate * times, size + rate))
            return logs.mean(axis=1), float(np.median(logs.std(axis=1)))
        logs = np.log(np.minimum(times, size / rate + AFTER_S + 1.0))
        return np.median(logs, axis=1), float(np.median(logs.std(axis=1)))

    def _chosen(self, setting: Setting, condition: Condition, gain: float) -> Array:
        peaks = np.array(
            [float(self._drive(setting, condition, size, condition.hold_s)[0].max()) for size in CHOICE_SIZES_K]
        )
        wanted = -np.log(gain * self.sensitivity[condition.channel])
        logs = np.maximum.accumulate(np.log(np.maximum(peaks, FEEBLE)))
        rising = np.append(True, np.diff(logs) > 0.0)
        return np.asarray(np.interp(wanted, logs[rising], np.log(CHOICE_SIZES_K)[rising]), dtype=np.float64)

    def _reported(self, setting: Setting, condition: Condition, gain: float) -> Array:
        reported = []
        for size in YES_NO_SIZES_K.tolist():
            drive, samples = self._drive(setting, condition, size, condition.hold_s)
            criterion = self.values["criterion of yes and no"]
            reported.append(self.passages(drive, samples, condition.channel, gain, criterion)[1].mean(axis=1))
        return psychometric_logs(np.stack(reported, axis=1), np.log(YES_NO_SIZES_K))[0]

    def _rated(self, setting: Setting, condition: Condition, gain: float) -> tuple[Array, float]:
        values, channel = self.values, condition.channel
        peak = max(float(self._drive(setting, condition, condition.size_K or 0.0, condition.hold_s)[0].max()), FEEBLE)
        exponent, unit = values[f"{channel} rating exponent"], values[f"{channel} rating at threshold"]
        logs = math.log(unit) + exponent * (math.log(peak * gain) + np.log(self.sensitivity[channel]))
        scatter = math.hypot(
            values["scatter of ratings"] / math.exp(float(logs.mean())), exponent * values["gain noise"]
        )
        return logs, scatter


@dataclass(frozen=True, slots=True)
class Predicted:
    """Predictions of conditions in laboratories: logs of people's values.

    `mean` (laboratories, conditions) over people, `between` (laboratories, conditions, conditions) their covariance,
    `within` (laboratories, conditions) the SD of the log of one trial.
    """

    mean: Array
    between: Array
    within: Array

    def of(self, which: NDArray[np.int64]) -> Predicted:
        """Those of some laboratories."""
        return Predicted(self.mean[which], self.between[which], self.within[which])

    def joined(self, other: Predicted) -> Predicted:
        """These and those of further laboratories."""
        pairs = zip((self.mean, self.between, self.within), (other.mean, other.between, other.within), strict=True)
        return Predicted(*(np.concatenate(pair) for pair in pairs))


def measuring(prior: LaboratoryPrior, row: Array, setting: Setting, people: int, seed: int) -> MeasuringLaboratory:
    """A laboratory by a row of `LaboratoryPrior.values`, which measures in a setting; its offset is its own, in SDs."""
    named: dict[str, float] = dict(zip(prior.names, row.tolist(), strict=True))
    for channel, offset in zip(CHANNELS, OFFSETS, strict=True):
        named[f"{OWN} {channel}"] = named[offset] / named[BETWEEN_LABORATORIES]
    named["contact resistance of a thermode"] = setting.contact_m2K_per_W
    return MeasuringLaboratory(named, prior.draws.variable, people=people, seed=seed)


def predicted(
    prior: LaboratoryPrior,
    some: Laboratories,
    setting: Setting,
    conditions: Sequence[Condition],
    step: Callable[[], None] | None = None,
) -> Predicted:
    """Predict conditions in laboratories, with the same crowd in each; `step` is called after each."""
    values = prior.values(some)

    def one(k: int) -> tuple[Array, Array, Array]:
        place = measuring(prior, values[k], setting, PEOPLE, SEED)
        each = [place.measure(setting, condition) for condition in conditions]
        logs = np.stack([log for log, _ in each], axis=1)
        return logs.mean(axis=0), np.atleast_2d(np.cov(logs.T)), np.array([within for _, within in each])

    found = []
    for each in in_order(one, range(len(some))):
        found.append(each)
        if step is not None:
            step()
    return Predicted(*(np.stack([parts[k] for parts in found]) for k in range(3)))
