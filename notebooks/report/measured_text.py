"""What ``thermicon pilot`` prints of thresholds, reaction times and ratings, and how they fit the prediction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .answers_text import misfit, p_text
from .tables import table

if TYPE_CHECKING:
    from rich.table import Table

    from thermicon.perception.pilot.data import Measured
    from thermicon.perception.pilot.fit import MeasurementFit
    from thermicon.perception.pilot.observed import Observed

LEAST_VALUES = 6
"""Values below which a test of fit judges nobody."""


def conditions_table(found: Observed[Measured, MeasurementFit]) -> Table:
    """One row per condition: geometric mean of the participants, and the predicted one before and after."""
    made = table(
        "condition", "people", "measured", "predicted", "95 %", "after", "95 %", numbers=("people", "measured")
    )
    for before, after in zip(found.fit.conditions, found.fit_after.conditions, strict=True):
        unit = before.condition.unit
        made.add_row(
            before.condition.label,
            str(before.participants),
            f"{before.observed:.3g} {unit}" + " *" * before.missed,
            f"{before.predicted[0]:.3g}",
            f"{before.predicted[1]:.3g}–{before.predicted[2]:.3g}",
            f"{after.predicted[0]:.3g}",
            f"{after.predicted[1]:.3g}–{after.predicted[2]:.3g}",
        )
    return made


def fit_sentences(found: Observed[Measured, MeasurementFit]) -> list[str]:
    """The test of fit, what the stars mean, and errors that were assumed."""
    values = found.data.measurements
    lines = [
        "Geometric means over participants; the predicted ones are for as many participants, with 95 % of laboratories."
    ]
    missed = sum(each.missed for each in found.fit.conditions)
    if missed:
        lines.append(f"* lies outside its predicted 95 % ({missed} of {len(found.fit.conditions)}).")
    before, after = found.fit.p, found.fit_after.p
    verdict = misfit(before, after, "values", len(found.conditioned.after))
    if values.total < LEAST_VALUES:
        verdict = f"{values.total} values are too few to judge the model by; {LEAST_VALUES} or more can"
    elif "cannot explain" in verdict:
        verdict += "; check units, method and stimulus"
    verdict = verdict or "the measurements are what the prediction allows"
    lines.append(
        f"Test of fit (posterior predictive): p = {p_text(before)} before, {p_text(after)} after the values were used: "
        f"{verdict}"
    )
    if count := values.assumed_errors:
        lines.append(
            f"{count} of {values.total} values have neither standard_error nor trials: an error of 10 % is assumed."
        )
    if any(each.kind == "rating" for each in values.conditions):
        lines.append(
            "Ratings count by their ratios: the scale of another laboratory may differ from the published one by a "
            "factor of 2."
        )
    return lines
