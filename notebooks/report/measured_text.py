"""What ``thermicon observed`` prints of thresholds, reaction times and ratings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .observed_text import constant_lines, few_lines, misfit, p_text, sets_table
from .tables import show, table

if TYPE_CHECKING:
    from rich.table import Table

    from thermicon.perception.pilot.measured import MeasuredPilot

LEAST_CARRIED = 30
"""Laboratories below which an interval is rough."""
LEAST_VALUES = 6
"""Values below which a test of fit judges nobody."""


def show_measured(found: MeasuredPilot, files: Sequence[str], last: Sequence[str] = ()) -> None:
    """Print what was measured, how it fits, what the predictions of all sets become, and some last lines."""
    title = found.predictions[0].before.title
    show(
        *([title, ""] if title else []),
        conditions_table(found),
        "",
        *fit_sentences(found),
        "",
        sets_table(found, files),
        "",
        *draws_sentences(found),
        *(["", *last] if last else []),
    )


def conditions_table(found: MeasuredPilot) -> Table:
    """One row per condition: geometric mean of the participants, and the predicted one before and after."""
    made = table(
        "condition", "people", "measured", "predicted", "95 %", "after", "95 %", numbers=("people", "measured")
    )
    for before, after in found.conditions:
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


def fit_sentences(found: MeasuredPilot) -> list[str]:
    """The test of fit, what the stars mean, and errors that were assumed."""
    values = found.measurements
    lines = [
        "Geometric means over participants; the predicted ones are for as many participants, with 95 % of laboratories."
    ]
    missed = sum(before.missed for before, _ in found.conditions)
    if missed:
        lines.append(f"* lies outside its predicted 95 % ({missed} of {len(found.conditions)}).")
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


def draws_sentences(found: MeasuredPilot) -> list[str]:
    """How many draws carry the result, and which constants moved."""
    own, people = found.conditioned, found.predictions[0].after.people
    carried = f"effective sample size {own.effective:.0f} of {len(own.before)} draws"
    if own.rounds:
        rounds = "1 round" if own.rounds == 1 else f"{own.rounds} rounds"
        carried += (
            f", too few to be weighted: {len(own.after)} fresh laboratories were sampled in {rounds}, of which "
            f"{own.effective_after:.0f} are effective"
        )
    lines = [
        f"Before and after are for {people} people of this laboratory who did not take part, with 95 % of "
        "laboratories.",
        f"The values weigh the draws: {carried}.",
    ]
    if own.effective_after < LEAST_CARRIED:
        lines.append("So few carry rough intervals only: use more --draws.")
    return lines + few_lines(found) + constant_lines(found)
