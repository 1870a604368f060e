"""Tasks in a laboratory while a ramp is played.

Rows of the evidence, measurements of a pilot and `measure` are all asked here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import SIGN, Channel
from .laboratory import DT_S, FEEBLE, Corner, Laboratory, samples_of

Key = tuple[str, str, str]
"""Experiment, statistic, channel: what a published number goes by."""
DISCREPANCY = 0.05
"""What a model of this kind may miss a published or measured value by, as a share; assumed."""
UNSTATED = 0.10
"""Error of a threshold whose error is not stated, as a share; assumed."""
HALVES = (0.16, 0.5, 0.84)
"""Shares one SD below, at and above the middle of a cumulative normal."""
GUESSED = 0.999
"""Share of the reports at the smallest size that counts as guessed; less than all, so that none is divided by 0."""
LEAST_RISE = 1e-9
"""Added from size to size, so that no share stands at two sizes."""


@dataclass(frozen=True, slots=True)
class DisplayRamp:
    """A ramp of the display over the skin of a rig's site: size in K without sign, K/s, held until `end_s`."""

    site_rig: str
    channel: Channel
    baseline_C: float
    size_K: float
    rate_K_per_s: float
    end_s: float

    @classmethod
    def held(
        cls, site_rig: str, channel: Channel, baseline_C: float, size_K: float, rate_K_per_s: float, hold_s: float
    ) -> DisplayRamp:
        """A ramp whose end is held for so many seconds."""
        return cls(site_rig, channel, baseline_C, size_K, rate_K_per_s, size_K / rate_K_per_s + hold_s)

    @property
    def corners(self) -> tuple[Corner, ...]:
        """The end of the ramp: time in s and change in K."""
        return ((self.size_K / self.rate_K_per_s, SIGN[self.channel] * self.size_K),)


@dataclass(frozen=True, slots=True)
class Stimulated:
    """A ramp played in a laboratory: receptor drive (rows,) of its channel. Gains are multiples of threshold a unit."""

    laboratory: Laboratory
    ramp: DisplayRamp
    drive: Array

    @classmethod
    def of(cls, laboratory: Laboratory, ramp: DisplayRamp) -> Stimulated:
        """Play it."""
        drive = laboratory.drive(ramp.site_rig, ramp.channel, ramp.baseline_C, ramp.corners, ramp.end_s)
        return cls(laboratory, ramp, drive)

    @property
    def peak(self) -> float:
        """Largest drive."""
        return max(float(self.drive.max()), FEEBLE)

    def answers_s(self, gain: float, site: str, *, choice: bool = False) -> Array:
        """Times (people, trials) in s of a press at the first change, or of a choice of warm or cold; inf: none."""
        samples = samples_of(self.ramp.corners, self.ramp.end_s)
        return self.laboratory.answers_s(self.drive, samples, self.ramp.channel, gain, site=site, choice=choice)

    def misnamed(self, gain: float, warm_gain: float, site: str) -> Array:
        """Share of trials (people,) in which a choice in haste is wrong: noise passes first, or cold is called warm."""
        laboratory, ramp = self.laboratory, self.ramp
        samples = samples_of(ramp.corners, ramp.end_s)
        mistaken = laboratory.outrun(self.drive, samples, ramp.channel, gain, site=site)
        constants = laboratory.constants
        resting = laboratory.drive(ramp.site_rig, "warm", ramp.baseline_C, (), DT_S)
        return constants.mislabelled(ramp.channel, mistaken, float(constants.psi(warm_gain * resting)[0]))

    def limits_K(self, gain: float, site: str) -> Array:
        """Change at a press (people, trials), K; a second beyond the ramp's end where nobody pressed."""
        rate = self.ramp.rate_K_per_s
        return np.minimum(rate * self.answers_s(gain, site), self.ramp.size_K + rate)

    def reported(self, gain: float) -> Array:
        """Share of trials (people,) in which it is reported to a question without haste."""
        samples = samples_of(self.ramp.corners, self.ramp.end_s)
        criterion = self.laboratory.constants.unhurried
        passed = self.laboratory.passages(self.drive, samples, self.ramp.channel, gain, criterion)[1]
        found: Array = passed.mean(axis=1)
        return found


def yes_no_logs(laboratory: Laboratory, ramps: Sequence[DisplayRamp], gain: float) -> tuple[Array, Array]:
    """Logs (people,) of the size that is reported in half of the trials, and of the SD of the function, guesses out."""
    reported = np.stack([Stimulated.of(laboratory, ramp).reported(gain) for ramp in ramps], axis=1)
    logs = psychometric(reported, np.log([ramp.size_K for ramp in ramps]), np.array(HALVES))
    sizes = np.exp(logs)
    return logs[:, 1], np.log(np.maximum(0.5 * (sizes[:, 2] - sizes[:, 0]), 1e-3))


def psychometric(reported: Array, log_sizes: Array, shares: Array) -> Array:
    """Logs (people, shares) of the sizes at which corrected reports (people, sizes) reach these shares, linear between.

    A share that is not reached by the largest size lies beyond it, as far as the rest is missing.
    """
    guesses = GUESSED * reported[:, :1]
    corrected = np.maximum.accumulate((reported - guesses) / (1.0 - guesses), axis=1)
    corrected += LEAST_RISE * np.arange(log_sizes.size)
    reached = np.stack([np.searchsorted(own, shares) for own in corrected])
    above = reached.clip(1, log_sizes.size - 1)
    low, high = (np.take_along_axis(corrected, place, axis=1) for place in (above - 1, above))
    between = log_sizes[above - 1] + (shares - low) / (high - low) * (log_sizes[above] - log_sizes[above - 1])
    beyond = log_sizes[-1] + shares - corrected[:, -1:]
    return np.asarray(np.where(reached == 0, log_sizes[0], np.where(reached < log_sizes.size, between, beyond)))
