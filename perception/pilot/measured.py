"""Condition the prediction on thresholds, reaction times and ratings that a laboratory measured."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.circuit.program import own_version

from ..observer.channels import USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from ..observer.observer_model import ObserverModel
from ..progress import Progress
from .changes import ChangedConstant, changed
from .laboratory_file import Resampling, laboratory_draws, laboratory_texts
from .measurement_conditioning import Reweighted, reweight
from .measurement_fit import ConditionFit, MeasurementFit, compare_measurements
from .measurements import Measurements
from .observed import DRAWS, LEAST_DRAWS, counted
from .playing import Confusions, Stage, laboratories_for, stage
from .prediction import ChangedPrediction
from .simulated_measurements import Setting, predicted
from .states import Laboratories, LaboratoryPrior

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet


@dataclass(frozen=True, slots=True)
class MeasuredPilot:
    """What was measured, how it fits the prediction, and what it makes of the prediction of sets.

    Attributes
    ----------
    measurements
        The values.
    fit, fit_after
        Group means beside what was predicted before, and beside what is predicted after they were seen.
    predictions
        Each set before and after.
    constants
        Constants that moved or narrowed, the most changed first.
    conditioned
        Laboratories behind all of it, and the effective sample size.

    See Also
    --------
    condition_on_measurements : conditions on measurements.

    """

    measurements: Measurements
    fit: MeasurementFit
    fit_after: MeasurementFit
    predictions: tuple[ChangedPrediction, ...]
    constants: tuple[ChangedConstant, ...]
    conditioned: Reweighted
    confusions_after: Confusions
    prior: LaboratoryPrior
    played: Stage
    rig: str
    rig_changes: tuple[str, ...]
    norm: str
    seed: int
    version: str

    @property
    def provenance(self) -> tuple[str, ...]:
        """What the conditioned draws were made from, a line each."""
        found, values = self.conditioned, self.measurements
        how = "weights" if not found.rounds else f"{found.rounds} rounds of fresh laboratories"
        return (
            f"conditioned on: {values.source or 'measurements'}, sha256 {values.digest or 'unknown'}",
            f"participants: {len(values.participants)}",
            f"values: {values.total}",
            f"conditions: {'; '.join(each.label for each in values.conditions)}, "
            f"on {', '.join((self.rig, *self.rig_changes))}, {self.norm} norm",
            f"effective draws: {found.effective:.0f} of {len(found.before)}, by {how}",
            f"seed of the laboratories: {self.seed}",
        )

    def draws(self) -> PosteriorDraws:
        """Draws of constants and memory in this laboratory, equally weighted; its offset is part of the thresholds."""
        found, played = self.conditioned, self.confusions_after
        outcome = np.column_stack([played.correct, played.bits, found.predicted_after.mean])
        resampling = Resampling.of(found, self.provenance, ", ".join((self.rig, *self.rig_changes)))
        return laboratory_draws(self.prior, found.after, outcome, self.played, resampling)

    def files(self) -> tuple[str, str]:
        """Texts of the parameter file (TOML) and of the table of draws (CSV) of this laboratory."""
        return laboratory_texts(self.draws(), self.version, self.provenance)

    def to_dict(self) -> dict[str, Any]:
        """Every number as plain data."""
        values, found = self.measurements, self.conditioned
        return {
            "version": self.version,
            "rig": self.rig,
            "rig_changes": list(self.rig_changes),
            "norm": self.norm,
            "seed": self.seed,
            "measurements_file": values.source,
            "measurements_sha256": values.digest,
            "participants": len(values.participants),
            "values": values.total,
            "errors_assumed": values.assumed_errors,
            "fit_before": self.fit.to_dict(),
            "fit_after": self.fit_after.to_dict(),
            "draws": len(found.before),
            "effective_sample_size": found.effective,
            "rounds": found.rounds,
            "predictions": [each.to_dict() for each in self.predictions],
            "constants": [each.to_dict() for each in self.constants],
        }

    def to_json(self) -> str:
        """Every number as JSON text."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1)

    @property
    def conditions(self) -> tuple[tuple[ConditionFit, ConditionFit], ...]:
        """Every condition before and after."""
        return tuple(zip(self.fit.conditions, self.fit_after.conditions, strict=True))

    def __repr__(self) -> str:
        return f"MeasuredPilot({self.measurements!r}, ESS {self.conditioned.effective:.0f})"


def condition_on_measurements(
    measurements: Measurements,
    icons: IconSet,
    rig: Rig,
    *,
    others: Sequence[IconSet] = (),
    draws: int = DRAWS,
    seed: int = 0,
    norm: str = USUAL_NORM,
    tracking: str | None = None,
    observer: ObserverModel | Path | str | None = None,
    progress: Progress | None = None,
) -> MeasuredPilot:
    """Compare measurements with their prediction, and condition the prediction of sets on them.

    Parameters
    ----------
    measurements
        Thresholds, reaction times and ratings, as `read_measurements` reads them.
    icons
        The set whose prediction is wanted.
    rig
        The rig that the measurements were made on, and that plays the set.
    others, draws, seed, norm, tracking, observer, progress
        As in `observed`.

    Returns
    -------
    MeasuredPilot
        The same numbers for the same arguments.

    Raises
    ------
    ValueError
        For fewer than 20 draws, an observer without draws, an unknown norm, a set of fewer than 2 or more than 64
        icons, and a rig at a site whose skin is not known.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception.pilot.synthetic_measurements import synthetic_measurements
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> found = condition_on_measurements(synthetic_measurements(rig, participants=3, seed=2), icons, rig, draws=20)
    >>> len(found.conditions), found.measurements.total
    (4, 12)
    """
    if draws < LEAST_DRAWS:
        raise ValueError(f"an interval needs at least {LEAST_DRAWS} draws, not {draws}")
    setting = Setting.of(rig)
    prior = LaboratoryPrior.of(observer, check_norm(norm))
    number = laboratories_for(max(len(list(each)) for each in (icons, *others)), draws)
    before, kept = prior.first(number, seed), max(number // 2, 2)
    step = counted(progress, number + (1 + len(others)) * (number + kept))

    def simulate(some: Laboratories) -> Any:
        return predicted(prior, some, setting, measurements.conditions, step if some is before else None)

    found = reweight(measurements, before, simulate, seed=seed, kept=kept)
    main = stage(icons, rig, prior, seed=seed, tracking=tracking)
    predictions, after = list[ChangedPrediction](), None
    for each in (icons, *others):
        played = main if each is icons else stage(each, rig, prior, seed=seed, tracking=tracking)
        pair = played.confusions(before, step), played.confusions(found.after, step)
        after = pair[1] if after is None else after
        predictions.append(ChangedPrediction.of(each.title, *pair))
    assert after is not None
    return MeasuredPilot(
        measurements=measurements,
        fit=compare_measurements(measurements, found.predicted, seed=seed),
        fit_after=compare_measurements(measurements, found.predicted_after, seed=seed),
        predictions=tuple(predictions),
        constants=changed(
            prior.names, prior.values(before), prior.values(found.after), found.effective_after, prior.units
        ),
        conditioned=found,
        confusions_after=after,
        prior=prior,
        played=main,
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        norm=norm,
        seed=seed,
        version=own_version(),
    )
