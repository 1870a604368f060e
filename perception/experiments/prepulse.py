"""Cooling after a warm pulse: when the fall is noticed, and whether it is called cold or warm.

The pulse lifts adaptation, so that cooling starts from another level, and people wait for a surer sign than in limits:
the task asks for the quality. Warmth that lingers makes some of them call the fall warm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from thermicon.circuit.records import Table

from ..arrays import Array, own_arrays
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench
from ..sensation.first_passage import ResponseTimes, response_times
from .measured import crowd_of
from .task_constants import task_constant

PROCEDURE = "cooling after a warm pulse"


@dataclass(frozen=True, slots=True)
class CoolingAfterPulse:
    """Answers to a fall of temperature after a warm pulse.

    Attributes
    ----------
    peak_C
        Peak of the pulse, °C.
    rate_K_per_s
        Rate of the fall, K/s.
    answered
        Distributions of times from the start of the fall to the answer, one a person.
    called_warm
        Share of the falls that each person (people,) calls warm.
    conditions
        What was played.

    See Also
    --------
    cooling_after_pulse : plays the pulse and the fall.

    """

    peak_C: float
    rate_K_per_s: float
    answered: ResponseTimes
    called_warm: Array
    conditions: str

    def __post_init__(self) -> None:
        own_arrays(self, "called_warm")

    @property
    def change_K(self) -> Array:
        """Fall (people,) at the middle answer, K without sign; inf where half of the trials have none."""
        change: Array = self.rate_K_per_s * self.answered.quantile(0.5)
        return change

    @property
    def label(self) -> str:
        """The commoner label of the median person, `cold` or `warm`."""
        return "warm" if float(np.median(self.called_warm)) > 0.5 else "cold"

    def __repr__(self) -> str:
        return (
            f"CoolingAfterPulse(to {self.peak_C:g} °C: noticed after {np.median(self.change_K):.3g} K, "
            f"{100 * np.median(self.called_warm):.0f} % called warm; {len(self.called_warm)} people; {self.conditions})"
        )


def cooling_after_pulse(
    observer: Observer,
    bench: Bench,
    *,
    peak_C: float = 38.0,
    pulse_K_per_s: float = 2.5,
    held_s: float = 0.75,
    foreperiod_s: float = 0.25,
    rate_K_per_s: float = 1.0,
    cooled_K: float = 14.0,
    records: Table | None = None,
    people: People | None = None,
) -> CoolingAfterPulse:
    """Warm to a peak and back, wait, cool: when the fall is noticed, and how often it is called warm.

    Parameters
    ----------
    observer
        The nominal person.
    bench
        Rig, baseline and surface; the pulse returns to the baseline.
    peak_C
        Peak of the pulse, °C, above the baseline.
    pulse_K_per_s
        Rate of the pulse, up and down, K/s.
    held_s
        How long the peak is held, s.
    foreperiod_s
        From the return to the start of the fall, s.
    rate_K_per_s
        Rate of the fall, K/s.
    cooled_K
        How far it goes, K.
    records
        Records with caution and labels; None for the shipped ones.
    people
        Persons who answer; None for the nominal one alone.

    Returns
    -------
    CoolingAfterPulse
        Falls at the answer, and shares called warm.

    Raises
    ------
    ValueError
        For a peak that is not above the baseline; and where the records lack a constant of the task.

    Notes
    -----
    After E5 of the evidence. The criterion is that of speeded answers times the caution after a pre-pulse; a share
    w + (0.5 − w)·(1 − e^(−k·ψ)) is called warm, with w the share of wrong labels, ψ the peak of the pulse in d′ and k
    the warmth that lingers. These constants were inferred from that experiment alone. Peaks above 45 °C hurt, and pain
    is outside the model.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> found = cooling_after_pulse(Observer.load(), Bench(Rig.load("tcs2"), 32.0, "display"), peak_C=38.0)
    >>> found.label, bool(1.0 < found.change_K[0] < 8.0)
    ('cold', True)

    """
    rise_K = peak_C - bench.baseline_C
    if not rise_K > 0.0:
        raise ValueError(
            f"{PROCEDURE}: peak_C = {peak_C:g} °C must lie above the baseline of the bench, {bench.baseline_C:g} °C: "
            "there is no pulse to cool after"
        )
    caution, wrong, lingers = (
        task_constant(PROCEDURE, quantity, observer, records)
        for quantity in ("caution after a pre-pulse", "wrong labels", "warmth that lingers")
    )
    start_s = round(2.0 * rise_K / pulse_K_per_s + held_s + foreperiod_s, 2)
    waited_s = start_s - 2.0 * rise_K / pulse_K_per_s - held_s
    course = (
        f"warm by {rise_K:.9g} K at {pulse_K_per_s:.9g} K/s; hold for {held_s:.9g} s; "
        f"return at {pulse_K_per_s:.9g} K/s; hold for {waited_s:.9g} s; "
        f"cool by {cooled_K:.9g} K at {rate_K_per_s:.9g} K/s"
    )
    played = bench.play([course], start_s + cooled_K / rate_K_per_s + 1.0)
    crowd = crowd_of(observer, bench.rig.site, people)
    cold, warm = (psi[:, 0] for psi in played.felt(observer, crowd.threshold_cold, crowd.threshold_warm))
    start = round(start_s / played.dt_s)
    falling = cold[:, start:].copy()
    # Answers are counted from no sensation: what the pulse leaves of cold when the fall begins is part of it.
    falling[:, 0] = 0.0
    answered = response_times(
        falling,
        np.zeros_like(falling),
        played.dt_s,
        observer,
        conduction_s=crowd.conduction_s,
        decision_s=crowd.decision_s,
        criterion=(caution * crowd.criterion[0], caution * crowd.criterion[1]),
    )
    lingering = lingers * warm[:, :start].max(axis=1)
    called_warm = wrong + (0.5 - wrong) * -np.expm1(-lingering)
    said = (
        f"{pulse_K_per_s:g} K/s, held {held_s:g} s, {foreperiod_s:g} s of waiting, then {rate_K_per_s:g} K/s from "
        f"{bench.baseline_C:g} °C, {bench.rig.name}"
    )
    if not math.isfinite(float(called_warm.sum())):
        raise ValueError(f"{PROCEDURE}: the pulse to {peak_C:g} °C has no finite sensation, {said}")
    return CoolingAfterPulse(peak_C, rate_K_per_s, answered, called_warm, said)
