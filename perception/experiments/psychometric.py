"""Yes/no with its slope: how often a ramp is reported, by size, for every person.

The published task has no haste, and a criterion of its own. Threshold and width are read from each person's function.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from thermicon.circuit.records import Table

from ..arrays import Array, own_arrays
from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench
from .measured import crowd_of
from .ramps import checked_sizes, ramps
from .task_constants import task_constant

PROCEDURE = "yes/no with slope"
SHARES = tuple(NormalDist().cdf(z) for z in (-1.0, 0.0, 1.0))
"""Shares one SD below, at and above the middle of a cumulative normal."""
ASKED_K = tuple(np.geomspace(0.05, 12.0, 15).tolist())


@dataclass(frozen=True, slots=True)
class PsychometricFunction:
    """Share of ramps that are reported, by size and person.

    Attributes
    ----------
    channel
        What was asked for, `cold` or `warm`.
    sizes_K
        Sizes of the ramps (sizes,), K, without sign.
    reported
        Share of reports (people, sizes), corrected for false alarms.
    conditions
        What was played, with the criterion.

    See Also
    --------
    psychometric_function : asks whether ramps were felt.

    """

    channel: Channel
    sizes_K: Array
    reported: Array
    conditions: str

    def __post_init__(self) -> None:
        own_arrays(self, "sizes_K", "reported")
        if self.reported.shape[1:] != self.sizes_K.shape:
            raise ValueError(f"{PROCEDURE}: {self.reported.shape} reports of {self.sizes_K.size} sizes")

    def size_K(self, share: float) -> Array:
        """Size (people,) in K that is reported with a share, on log size; inf where even the largest is not."""
        logs = np.log(self.sizes_K)
        sizes = np.full(len(self.reported), np.inf)
        for person, own in enumerate(np.maximum.accumulate(self.reported, axis=1)):
            if own[0] >= share:
                raise ValueError(
                    f"{PROCEDURE}: {self.sizes_K[0]:g} K is reported in {100 * own[0]:.0f} % of trials already: add a "
                    "smaller size to sizes_K"
                )
            if own[-1] >= share:
                # A little slope keeps the function single-valued where reports stay at 0 or 1.
                sizes[person] = np.exp(np.interp(share, own + 1e-9 * np.arange(own.size), logs))
        return sizes

    @property
    def threshold_K(self) -> Array:
        """Size (people,) in K that is reported in half of the trials."""
        return self.size_K(SHARES[1])

    @property
    def width_K(self) -> Array:
        """SD (people,) in K of the cumulative normal: half the way from 16 to 84 % of reports."""
        low, high = self.size_K(SHARES[0]), self.size_K(SHARES[2])
        width: Array = 0.5 * (high - low)
        return width

    def __repr__(self) -> str:
        threshold, width = (float(np.median(each)) for each in (self.threshold_K, self.width_K))
        return (
            f"PsychometricFunction({self.channel}: threshold {threshold:.3g} K, width {width:.3g} K, "
            f"{len(self.reported)} people; {self.conditions})"
        )


def psychometric_function(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    sizes_K: Sequence[float] = ASKED_K,
    rate_K_per_s: float = 2.5,
    hold_s: float = 1.5,
    criterion: float | None = None,
    records: Table | None = None,
    people: People | None = None,
) -> PsychometricFunction:
    """Ask whether each of several ramps was felt: threshold and width of every person's function.

    Parameters
    ----------
    observer
        The nominal person.
    bench
        Rig, baseline and surface.
    channel
        `cold` or `warm`.
    sizes_K
        Sizes of the ramps, rising, K without sign; from one that is hardly felt to one that always is.
    rate_K_per_s
        Rate of the ramps, K/s.
    hold_s
        Plateau before the question, s.
    criterion
        Criterion in d′; None for the one inferred for yes and no, which is above that of speeded answers.
    records
        Records with that criterion; None for the shipped ones.
    people
        Persons who are asked; None for the nominal one alone.

    Returns
    -------
    PsychometricFunction
        Shares of reports, thresholds and widths.

    Raises
    ------
    ValueError
        For fewer than three sizes, or sizes that do not rise; and where the records lack the criterion.

    See Also
    --------
    yes_no : the threshold alone, with the criterion of speeded answers.

    Notes
    -----
    After E4 of the evidence: 2.5 K/s, a plateau of 1.5 s.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> asked = psychometric_function(Observer.load(), Bench(Rig.load("forearm"), 32.0), "cold")
    >>> bool(0.0 < asked.width_K[0] < asked.threshold_K[0])
    True

    """
    sizes = checked_sizes(PROCEDURE, sizes_K, 3)
    level = task_constant(PROCEDURE, "criterion of yes and no", observer, records) if criterion is None else criterion
    if not level > 0.0:
        raise ValueError(f"{PROCEDURE}: the criterion must be above 0 d′, not {level:g}")
    cautious = replace(observer, criterion=level)
    played, crowd = ramps(bench, channel, rate_K_per_s, hold_s, sizes), crowd_of(observer, bench.rig.site, people)
    reported = np.stack([played.reported(k, cautious, crowd) for k in range(len(sizes))], axis=1)
    said = f"{rate_K_per_s:g} K/s from {bench.baseline_C:g} °C, held {hold_s:g} s, criterion {level:.2f} d′"
    return PsychometricFunction(channel, np.array(sizes), reported, f"{said}, {bench.rig.name}")
