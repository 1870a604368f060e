"""What ``thermicon pilot`` says: the data beside their prediction, and the prediction before and after."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import percent, percent_span, signed

from .answers_report import LEAST_LABORATORIES, answered_blocks, misfit, p_text
from .blocks import Block, Bullets, Grid, Heading, Text, grid

if TYPE_CHECKING:
    from thermicon.perception.pilot.conditioning import Measured
    from thermicon.perception.pilot.observed import Observed
    from thermicon.perception.pilot.prediction import MeasurementFit

MOST_CONSTANTS = 8
LEAST_VALUES = 6
"""Values below which a test of fit judges nobody."""
LEAST_CARRIED = 30
"""Laboratories of measurements below which an interval is rough."""


def observed_report(found: Observed[Any, Any], files: Sequence[str], last: str = "") -> list[Block]:
    """Report what was observed, how it fits, what the predictions of all sets become, and a last word."""
    from thermicon.perception.pilot.conditioning import Answered

    title = found.predictions[0].before.title
    told = answered_blocks(found) if isinstance(found.data, Answered) else measured_blocks(found)
    return [
        *([Heading(title, 1)] if title else []),
        *told,
        sets_table(found, files),
        Text("\n".join(draws_sentences(found))),
        *constants(found),
        Text(last),
    ]


def sets_table(found: Observed[Any, Any], files: Sequence[str]) -> Grid:
    """Each set before and after: per cent correct and bits of people who did not take part."""
    enough = len(found.conditioned.after) >= LEAST_LABORATORIES
    columns = ["set", "", "correct", "95 %", "bits", "95 %"] + ["narrower"] * enough
    rows = []
    for file, each in zip(files, found.predictions, strict=True):
        for when, one in (("before", each.before), ("after", each.after)):
            (share, low, high), (bits, least, most) = one.proportion_correct, one.information_bits
            cells = [Path(file).name if when == "before" else "", when, percent(share), percent_span(low, high)]
            cells += [f"{bits:.2f}", f"{least:.2f}–{most:.2f}"]
            rows.append(cells + [f"{each.narrower:.2f} ×" if when == "after" else ""] * enough)
    return grid(columns, rows, ("correct", "bits", "narrower"))


def draws_sentences(found: Observed[Any, Any]) -> list[str]:
    """How many draws carry the result, and which constants moved."""
    own, people, answered = found.conditioned, found.predictions[0].after.people, bool(found.own)
    carried = f"effective sample size {own.effective:.0f} of {len(own.before)} draws"
    if own.rounds:
        rounds = "1 round" if own.rounds == 1 else f"{own.rounds} rounds"
        how = " by their pooled answers" if answered else f", of which {own.effective_after:.0f} are effective"
        carried += f", too few to be weighted: {len(own.after)} fresh laboratories were sampled in {rounds}{how}"
    lines = [
        f"Before and after are for {people} people of this laboratory who did not take part, with 95 % of "
        "laboratories.",
        f"The {'answers' if answered else 'values'} weigh the draws: {carried}.",
    ]
    if not answered and own.effective_after < LEAST_CARRIED:
        lines.append("So few carry rough intervals only: use more --draws.")
    if (count := len(own.after)) < LEAST_LABORATORIES:
        lines.append(
            f"Intervals after rest on {count} laboratories, too few to say by how much they narrowed: use --draws "
            f"{2 * LEAST_LABORATORIES} or more."
        )
    return lines


def constants(found: Observed[Any, Any]) -> list[Block]:
    """The constants that moved, with units; offsets of the laboratories of the evidence are left out."""
    header = found.prior.draws.header
    moved = [each for each in found.constants if not header.is_offset(each.name)]
    if not moved:
        return [Text("No constant moved by more than chance.")]
    points = [
        f"{each.name}: {_three(each.before)} → {_three(each.after)}{f' {each.unit}' if each.unit else ''}"
        for each in moved[:MOST_CONSTANTS]
    ]
    return [Text("What moved or narrowed most (median and 95 %, before → after):"), Bullets(tuple(points))]


def measured_blocks(found: Observed[Measured, MeasurementFit]) -> list[Block]:
    """One row per condition: geometric mean of the participants, the predicted one before and after, and the fit."""
    columns = ("condition", "people", "measured", "predicted", "95 %", "after", "95 %")
    rows = []
    for before, after in zip(found.fit.conditions, found.fit_after.conditions, strict=True):
        measured = f"{before.observed:.3g} {before.condition.unit}" + " *" * before.missed
        ends = [(f"{each.predicted[0]:.3g}", f"{each.predicted[1]:.3g}–{each.predicted[2]:.3g}")
                for each in (before, after)]  # fmt: skip
        rows.append((before.condition.label, str(before.participants), measured, *ends[0], *ends[1]))
    return [grid(columns, rows, ("people", "measured")), Text("\n".join(fit_sentences(found)))]


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


def _three(ends: tuple[float, float, float]) -> str:
    middle, low, high = (signed(end, ".3g") for end in ends)
    return f"{middle} ({low} to {high})"
