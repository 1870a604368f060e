"""The report of ``thermicon pilot``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermicon.base.words.number_text import percent, percent_span, signed

from .blocks import Block, Bullets, Grid, Heading, Text, grid, printed_unit

if TYPE_CHECKING:
    from thermicon.perception.pilot.conditioning import MeasuredValues, Namings
    from thermicon.perception.pilot.observed import Observed
    from thermicon.perception.pilot.prediction import ConditionFit, Fit, MeasurementFit
    from thermicon.perception.pilot.sealed import SealedScores
    from thermicon.perception.pilot.trials import AnswerScore

MOST_PEOPLE, MOST_PAIRS = 20, 8
POOR, DOUBTFUL = 0.05, 0.1
LEAST_TRIALS = 20
"""Answers below which a test of fit judges nobody: a single slip decides it."""
LEAST_LABORATORIES = 100
"""Laboratories below which widths of intervals scatter by over 15 %, and other constants are hardly tried."""
MOST_CONSTANTS = 8
FELT = "felt & named"
SHOWN = {"felt_and_named": FELT, "proportion_correct": "named", "information_bits": "bits"}
LEAST_VALUES = 6
"""Values below which a test of fit judges nobody."""
LEAST_CARRIED = 30
"""Laboratories of measurements below which an interval is rough."""
FORCED = "Each trial has an answer, as where nobody can say that nothing was felt: this judges"


def opened_report(found: SealedScores) -> list[Block]:
    """Report the scores of a sealed prediction, and in one sentence what they are worth."""
    columns = ("", "log score, bits a trial", "named, it says")
    rows = [(by, signed(bits, ".2f"), percent(correct)) for by, (bits, correct) in found.scores.items()]
    own, *others = (bits for bits, _ in found.scores.values())
    off, chance = own - others[-1], 2.0 * found.chance_bits
    than = [
        f"{'better' if own > bits else 'no better'} than {by} ({signed(own - bits, '+.2f')} bits)"
        for by, (bits, _) in [*found.scores.items()][1:3]
    ]
    kept = (
        "kept what it promised" if abs(off) <= chance else "promised more than it kept" if off < 0.0 else "did better"
    )
    return [
        Text(f"{found.sealed.source}, thermicon {found.sealed.version}, SHA-256:\n{found.sealed.sha256}"),
        grid(columns, rows, columns[1:]),
        Text(
            f"{found.trials} answers, {percent(found.observed_correct)} named correctly. "
            f"The prediction was {' and '.join(than)}; it {kept}: {signed(off, '+.2f')} bits from the best that its "
            f"matrix allows, where chance leaves ±{chance:.2f} in independent trials."
        ),
        Text(opened_reports(found)),
    ]


def opened_reports(found: SealedScores) -> str:
    """What a sealed prediction says of felt and named, or why it says nothing."""
    if not found.unanswered:
        return f"{FORCED} on named alone."
    if found.felt_and_named is None:
        return (
            f"{found.unanswered} plays were not felt. The sealed file is of before felt and named was predicted: it is "
            "read on named alone, of which they are no part."
        )
    seen, said, p = found.felt_and_named
    return (
        f"Felt and named: {percent(seen)} of {found.trials + found.unanswered} plays; it says {percent(said)}. Its "
        f"icons are {'not what' if p < POOR else 'what'} it says: {p_text(p)} in independent trials."
    )


def observed_report(found: Observed[Any, Any], files: Sequence[str], last: str = "") -> list[Block]:
    """Report what was observed, how it fits, what the predictions of all sets become, and a last word."""
    from thermicon.perception.pilot.conditioning import Namings

    title = found.predictions[0].before.title
    told = answered_blocks(found) if isinstance(found.data, Namings) else measured_blocks(found)
    return [
        *([Heading(title, 1)] if title else []),
        *told,
        sets_table(found, files),
        Text("\n".join(draws_sentences(found))),
        *([] if found.unusable else [*constants(found), Text(last)]),
    ]


def sets_table(found: Observed[Any, Any], files: Sequence[str]) -> Grid:
    """What is felt and named, named, and in bits, of each set by people who did not take part: before and after."""
    enough = len(found.conditioned.after) >= LEAST_LABORATORIES
    columns = ["set", "", "before (95 %)"] + ["after (95 %)"] * (not found.unusable) + ["narrower"] * enough
    rows = []
    for file, each in zip(files, found.predictions, strict=True):
        for name, shown in SHOWN.items():
            ends = [getattr(one, name) for one in (each.before, each.after) if one is not None]
            cells = [
                f"{a:.2f} ({b:.2f}–{c:.2f})" if shown == "bits" else f"{percent(a)} ({percent_span(b, c)})"
                for a, b, c in ends
            ]
            if enough:
                cells.append(f"{each.narrowed(name):.2f} ×")
            rows.append([Path(file).name if shown == FELT else "", shown, *cells])
    return grid(columns, rows, columns[2:])


def draws_sentences(found: Observed[Any, Any]) -> list[str]:
    """The number of draws that carry the result, and the constants that moved."""
    from thermicon.perception.pilot.conditioning import Namings

    own, answered = found.conditioned, isinstance(found.data, Namings)
    if found.unusable:
        return ["Before is for people who did not take part, with 95 % of laboratories.", found.unusable]
    carried = f"effective sample size {own.effective:.0f} of {len(own.before)} draws"
    if own.rounds:
        rounds = "1 round" if own.rounds == 1 else f"{own.rounds} rounds"
        how = " by their pooled answers" if answered else f", of which {own.effective_after:.0f} are effective"
        carried += f", too few to be weighted: {len(own.after)} fresh laboratories were sampled in {rounds}{how}"
    lines = [
        "Before and after are means over many people of this laboratory who did not take part, with 95 % of "
        "laboratories. Bits count names.",
        f"The {'answers' if answered else 'values'} weigh the draws: {carried}.",
    ]
    if answered and len(found.forms) > 1:
        after = " and ".join(f"{percent(then or 0.0)} {form}" for form, (_, then) in found.forms.items())
        before = " and ".join(percent(first) for first, _ in found.forms.values())
        lines.append(f"Form of memory: {after} of the laboratories after the answers; {before} before.")
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
    moved = [each for each in found.constants if each.constant not in header.offsets]
    if not moved:
        return [Text("No constant moved by more than chance.")]
    points = [
        f"{each.constant}: {_three(each.before)} → {_three(each.after)} {printed_unit(each.unit)}".rstrip()
        for each in moved[:MOST_CONSTANTS]
    ]
    return [Text("What moved or narrowed most (median and 95 %, before → after):"), Bullets(tuple(points))]


def measured_blocks(found: Observed[MeasuredValues, MeasurementFit]) -> list[Block]:
    """One row per condition: geometric mean of the participants, the predicted one before and after, and the fit."""
    columns = ["condition", "people", "measured", "predicted", "95 %"]
    rows = [
        [
            each.condition.label,
            str(each.participants),
            f"{each.observed:.3g} {each.condition.unit}" + " *" * each.missed,
            *_predicted(each),
        ]
        for each in found.fit.conditions
    ]
    if found.fit_after is not None:
        columns += ["after", "95 %"]
        rows = [[*row, *_predicted(each)] for row, each in zip(rows, found.fit_after.conditions, strict=True)]
    return [grid(columns, rows, ("people", "measured")), Text("\n".join(measured_sentences(found)))]


def _predicted(fit: ConditionFit) -> tuple[str, str]:
    middle, low, high = fit.predicted
    return f"{middle:.3g}", f"{low:.3g}–{high:.3g}"


def measured_sentences(found: Observed[MeasuredValues, MeasurementFit]) -> list[str]:
    """The test of fit, what the stars mean, and errors that were assumed."""
    values = found.data.measurements
    lines = [
        "Geometric means over participants; the predicted ones are for as many participants, with 95 % of laboratories."
    ]
    missed = sum(each.missed for each in found.fit.conditions)
    if missed:
        lines.append(f"* lies outside its predicted 95 % ({missed} of {len(found.fit.conditions)}).")
    before, after = found.fit.p, p_after(found)
    why = misfit(before, after, "values", len(found.conditioned.after), "; check units, method and stimulus")
    verdict = why or "the measurements are what the prediction allows"
    if values.total < LEAST_VALUES:
        verdict = f"{values.total} values are too few to judge the model by; {LEAST_VALUES} or more can"
    lines.append(f"Test of fit (posterior predictive): {p_texts(before, after, 'values')}: {verdict}")
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


def answered_blocks(found: Observed[Namings, Fit]) -> list[Block]:
    """One row per participant and one for all, what the answers do not say, and how they fit the prediction."""
    said, fits = "\n".join(observed_sentences(found.data)), Text("\n".join(fit_sentences(found)))
    return [people_table(found.data), Text(said), *reports(found), fits, *pairs(found.fit)]


def people_table(data: Namings) -> Grid:
    """One row per participant and one for all: trials, felt and named where both are known, named, bits."""
    both = not data.trials.forced
    rows = [_row(score, both) for score in data.each[:MOST_PEOPLE]]
    columns = ["", "trials", *["not felt", FELT, "95 %"] * both, "named", "95 %", "bits"]
    if (more := len(data.each) - MOST_PEOPLE) > 0:
        rows.append([f"and {more} more", *[""] * (len(columns) - 1)])
    rows = [*rows, _row(data.pooled, both)]
    return grid(columns, rows[-1:] if data.trials.grouped else rows, ("trials", "not felt", FELT, "named", "bits"))


def _row(score: AnswerScore, both: bool) -> list[str]:
    alert = [str(score.unanswered), percent(score.proportion_correct), percent_span(*score.proportion_correct_interval)]
    named = ["–", "–"]
    if score.named is not None and score.named_interval is not None:
        named = [percent(score.named), percent_span(*score.named_interval)]
    return [score.who, str(score.trials), *alert * both, *named, f"{score.information_bits:.2f}"]


def observed_sentences(data: Namings) -> list[str]:
    """Bias of the bits, and what the answers do not cover."""
    pooled, trials = data.pooled, data.trials
    lines = [
        f"Bits are corrected for bias (Miller–Madow): the plug-in estimate of the pooled answers is "
        f"{pooled.information_bits_plugin:.2f} bits, {pooled.information_bits_bias:.2f} too many by that formula; "
        "with few trials some bias is left."
    ]
    if pooled.unanswered:
        lines.append(
            f"{pooled.unanswered} of {pooled.trials} trials have no answer, so were not felt: a miss for felt and "
            "named, and no part of named, of bits, of their test of fit and of the likelihood."
        )
    else:
        lines.append(f"{FORCED} named alone.")
    if trials.missing:
        lines.append(f"Marked as missing, and no trials: {trials.missing}.")
    if trials.passed:
        lines.append(f"Passed over, with neither icon nor answer of the set: {trials.passed} rows or trials of a row.")
    if trials.grouped:
        lines.append(
            "Counts of one group do not show differences between people, order effects or carry-over. The interval "
            "takes all answers as independent, and the prediction takes the group for one person."
        )
    if trials.never_presented:
        lines.append(
            f"Never presented: {', '.join(trials.never_presented)}. Their results are predictions alone, and "
            "the shares are those of the others."
        )
    return lines


def fit_sentences(found: Observed[Namings, Fit]) -> list[str]:
    """The test of fit before and after, and the pairs that were missed."""
    fit, pooled = found.fit, found.data.pooled
    seen = found.data.trials.pooled
    middle, low, high = fit.proportion_correct
    bits, least, most = fit.information_bits_plugin
    lines = [
        f"Predicted for this experiment: {percent(middle)} named ({percent_span(low, high)}), {bits:.2f} plug-in "
        f"bits ({least:.2f}–{most:.2f}). Observed{' where they answered' * bool(pooled.unanswered)}: "
        f"{percent(float(seen.trace() / seen.sum()))}, {pooled.information_bits_plugin:.2f} bits. This prediction is "
        "the median of experiments with as many participants and trials; that of the set, below, is the mean over "
        "people and laboratories, so the two may differ.",
        f"Test of fit (posterior predictive): {p_texts(fit.p, p_after(found), 'answers')}{_verdict(found)}",
    ]
    if fit.p_people is not None:
        lines.append(f"Participants differ as much or more in {percent(fit.p_people)} of simulated experiments.")
    return lines


def reports(found: Observed[Namings, Fit]) -> list[Block]:
    """Felt and named beside its prediction, the test of fit of what was felt, and the icons that it missed."""
    fit, after, pooled = found.fit, found.fit_after, found.data.pooled
    if fit.felt_and_named is None or fit.p_reports is None:
        return []
    middle, low, high = fit.felt_and_named
    verdict = "the prediction of what is felt missed" if fit.p_reports < POOR else "they are what the prediction allows"
    if pooled.trials < LEAST_TRIALS:
        verdict = f"{pooled.trials} trials are too few to judge the model by; {LEAST_TRIALS} or more can"
    text = (
        f"Predicted for this experiment: {percent(middle)} felt and named ({percent_span(low, high)}). Observed: "
        f"{percent(pooled.proportion_correct)}.\nTest of fit of the plays that were felt: "
        f"{p_texts(fit.p_reports, None if after is None else after.p_reports, 'answers')}: {verdict}"
    )
    points = [
        f"{each.a}: {round(each.observed * each.trials)} of {each.trials} not felt; predicted "
        f"{percent(each.predicted)} ({percent_span(*each.predicted_interval)})"
        for each in fit.reports
        if each.missed
    ]
    head = f"Icons not felt outside their predicted 95 % ({len(points)} of {len(fit.reports)}):"
    return [Text(text), *((Text(head), Bullets(tuple(points))) if points else ())]


def pairs(fit: Fit) -> list[Block]:
    """The missed pairs as a list, and how many are expected by chance."""
    missed, chance = fit.missed, 0.05 * len(fit.pairs)
    if not missed:
        return [Text(f"No pair was missed: all {len(fit.pairs)} lie within their predicted 95 %.")]
    points = [
        f"{pair.a} and {pair.b}: confused {'more' if pair.observed > pair.predicted else 'less'} than predicted, in "
        f"{percent(pair.observed)} of {pair.trials} trials; predicted {percent(pair.predicted)} "
        f"({percent_span(*pair.predicted_interval)})"
        for pair in missed[:MOST_PAIRS]
    ]
    points += [f"and {len(missed) - MOST_PAIRS} more"] * (len(missed) > MOST_PAIRS)
    head = f"Pairs outside their predicted 95 % ({len(missed)} of {len(fit.pairs)}; about {chance:.1f} by chance):"
    return [Text(head), Bullets(tuple(points))]


def p_text(p: float) -> str:
    """A p as people write it."""
    return "p under 0.01" if p < 0.01 else f"p = {p:.2f}"


def p_after(found: Observed[Any, Any]) -> float | None:
    """The p of the test of fit after the data were used; None where they have no usable likelihood."""
    return None if found.fit_after is None else float(found.fit_after.p)


def p_texts(before: float, after: float | None, what: str) -> str:
    """The p of a test of fit before the data and, where they were used, after."""
    return f"{p_text(before)} before" + ("" if after is None else f", {p_text(after)} after the {what} were used")


def _verdict(found: Observed[Namings, Fit]) -> str:
    if (total := int(found.data.trials.counts.sum())) < LEAST_TRIALS:
        few = "1 answer is too little" if total == 1 else f"{total} answers are too few"
        return f": {few} to judge the model by; {LEAST_TRIALS} or more can"
    why = misfit(found.fit.p, p_after(found), "answers", len(found.conditioned.after))
    if why:
        return f": {why}"
    missed, pairs = len(found.fit.missed), len(found.fit.pairs)
    if more_than_chance(missed, pairs):
        return (
            f": as a whole the answers do not contradict the prediction, but it missed {missed} of {pairs} pairs, more "
            "than chance does"
        )
    if found.fit.p < DOUBTFUL:
        return ": the answers are near the limit of what the prediction before them allowed"
    return ": the answers are what the prediction allows"


def misfit(before: float, after: float | None, what: str, laboratories: int, cure: str = "") -> str:
    """The meaning of a small p, with a cure where the model cannot explain it; empty where neither is small.

    `after` is None where the data were not used.

    >>> misfit(0.02, 0.3, "answers", 500)
    'the prediction missed, but laboratories that the evidence allows explain the answers'
    """
    if after is None:
        return "the prediction missed" if before < POOR else ""
    if after < POOR and laboratories < LEAST_LABORATORIES:
        return (
            f"the {what} are unlikely, but {laboratories} laboratories are too few to say that no constants explain "
            f"them: use --draws {2 * LEAST_LABORATORIES} or more"
        )
    if after < POOR:
        return f"the model cannot explain these {what}, not even with other constants{cure}"
    if before < POOR:
        return f"the prediction missed, but laboratories that the evidence allows explain the {what}"
    return ""


def more_than_chance(missed: int, pairs: int) -> bool:
    """Whether more pairs lie outside their 95 % than chance makes likely (5 %).

    >>> more_than_chance(3, 15), more_than_chance(2, 15)
    (True, False)
    """
    from scipy.stats import binom

    return bool(binom.sf(missed - 1, pairs, 0.05) < POOR)
