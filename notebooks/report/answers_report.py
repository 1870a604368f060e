"""What ``thermicon pilot`` says of answers: participants, fit, and pairs that were missed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from thermicon.icons.number_text import percent, percent_span, seconds

from .blocks import Block, Bullets, Grid, Text, grid

if TYPE_CHECKING:
    from thermicon.perception.pilot.conditioning import Answered
    from thermicon.perception.pilot.observed import Observed
    from thermicon.perception.pilot.prediction import Fit, Three
    from thermicon.perception.pilot.trials import AnswerScore

MOST_PEOPLE, MOST_PAIRS = 20, 8
POOR, DOUBTFUL = 0.05, 0.1
LEAST_TRIALS = 20
"""Answers below which a test of fit judges nobody: a single slip decides it."""
USEFUL_PEOPLE = 5
"""Participants from which on Student's interval is below three standard errors to either side (of two: 12.7)."""
LEAST_LABORATORIES = 100
"""Laboratories below which widths of intervals scatter by over 15 %, and other constants are hardly tried."""


def answered_blocks(found: Observed[Answered, Fit]) -> list[Block]:
    """One row per participant and one for all, what the answers do not say, and how they fit the prediction."""
    said = "\n".join(observed_sentences(found.data))
    return [people_table(found.data, found.own), Text(said), Text("\n".join(fit_sentences(found))), *pairs(found.fit)]


def people_table(data: Answered, own: Sequence[Three]) -> Grid:
    """One row per participant and one for all: trials, per cent correct, bits, median time."""
    timed = not math.isnan(data.pooled.time_s)
    columns = ["", "trials", "correct", "95 %", "bits", "95 %", "further trials"] + ["time"] * timed
    rows = [
        _row(score, timed, f"{percent(further[0])} ({percent_span(*further[1:])})")
        for score, further in list(zip(data.each, own, strict=True))[:MOST_PEOPLE]
    ]
    if (more := len(data.each) - MOST_PEOPLE) > 0:
        rows.append([f"and {more} more", *[""] * (len(columns) - 1)])
    return grid(columns, [*rows, _row(data.pooled, timed, "")], ("trials", "correct", "bits", "time"))


def _row(score: AnswerScore, timed: bool, own: str) -> list[str]:
    low, high = score.bits_interval
    time = seconds(None if math.isnan(score.time_s) else score.time_s)
    cells = [score.who, str(score.trials), percent(score.proportion_correct), percent_span(*score.proportion_interval)]
    cells += [f"{score.bits:.2f}", f"{low:.2f}–{high:.2f}", own]
    return cells + [time] * timed


def observed_sentences(data: Answered) -> list[str]:
    """Bias of the bits, how little two participants say of others, and what the answers do not cover."""
    pooled, trials = data.pooled, data.trials
    lines = [
        f"Bits are corrected for bias (Miller–Madow): the plug-in estimate of the pooled answers is "
        f"{pooled.bits_plugin:.2f} bits, {pooled.bits_bias:.2f} too many by that formula; "
        "with few trials some bias is left. Further trials: predicted for the same participant."
    ]
    if len(data.each) == 2:
        lines.append(
            "Two participants allow hardly any interval of all (with one degree of freedom, 12.7 standard errors to "
            f"either side); from {USEFUL_PEOPLE} participants on it becomes useful."
        )
    mean = sum(score.proportion_correct for score in data.each) / len(data.each)
    uneven = len({score.trials for score in data.each}) > 1
    if uneven and percent(mean) != percent(pooled.proportion_correct):
        lines.append(
            f"In the row of all, every answer counts alike, so participants with more trials count more; the mean of "
            f"the participants is {percent(mean)} correct."
        )
    if trials.never_presented:
        lines.append(
            f"Never presented: {', '.join(trials.never_presented)}. What is said of them is prediction alone, and "
            "per cent correct is that of the others."
        )
    if trials.single_trial:
        lines.append(f"One trial only: {', '.join(trials.single_trial)}; it counts, but shows no spread.")
    return lines


def fit_sentences(found: Observed[Answered, Fit]) -> list[str]:
    """The test of fit before and after, and the pairs that were missed."""
    fit, pooled = found.fit, found.data.pooled
    middle, low, high = fit.proportion_correct
    bits, least, most = fit.bits_plugin
    lines = [
        f"Predicted for this experiment: {percent(middle)} correct ({percent_span(low, high)}), {bits:.2f} plug-in "
        f"bits ({least:.2f}–{most:.2f}). Observed: {percent(pooled.proportion_correct)}, {pooled.bits_plugin:.2f} "
        "bits. This prediction is the median of experiments with as many participants and trials; that of the set, "
        "below, is the mean over people and laboratories, so the two may differ.",
        f"Test of fit (posterior predictive): p = {p_text(fit.p)} before, {p_text(found.fit_after.p)} after the "
        f"answers were used{_verdict(found)}",
    ]
    if fit.p_people is not None:
        lines.append(f"Participants differ as much or more in {percent(fit.p_people)} of simulated experiments.")
    return lines


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
    return "under 0.01" if p < 0.01 else f"{p:.2f}"


def _verdict(found: Observed[Answered, Fit]) -> str:
    if (total := found.data.trials.total) < LEAST_TRIALS:
        few = "1 answer is too little" if total == 1 else f"{total} answers are too few"
        return f": {few} to judge the model by; {LEAST_TRIALS} or more can"
    why = misfit(found.fit.p, found.fit_after.p, "answers", len(found.conditioned.after))
    if why:
        return f": {why}"
    missed, pairs = len(found.fit.missed), len(found.fit.pairs)
    if more_than_chance(missed, pairs):
        return (
            f": as a whole the answers do not contradict the prediction, but it missed {missed} of {pairs} pairs, more "
            "than chance does"
        )
    if found.fit.p < DOUBTFUL:
        return ": the answers are near the limit of what the prediction allows"
    return ": the answers are what the prediction allows"


def misfit(before: float, after: float, what: str, laboratories: int) -> str:
    """What a small p says of the model; empty where neither is small.

    >>> misfit(0.02, 0.3, "answers", 500)
    'the prediction missed, but laboratories that the evidence allows explain the answers'
    """
    if after < POOR and laboratories < LEAST_LABORATORIES:
        return (
            f"the {what} are unlikely, but {laboratories} laboratories are too few to say that no constants explain "
            f"them: use --draws {2 * LEAST_LABORATORIES} or more"
        )
    if after < POOR:
        return f"the model cannot explain these {what}, not even with other constants"
    if before < POOR:
        return f"the prediction missed, but laboratories that the evidence allows explain the {what}"
    return ""


def more_than_chance(missed: int, pairs: int) -> bool:
    """Whether more pairs lie outside their 95 % than chance makes likely (5 %).

    >>> more_than_chance(3, 15), more_than_chance(2, 15)
    (True, False)
    """
    fewer = sum(math.comb(pairs, k) * 0.05**k * 0.95 ** (pairs - k) for k in range(missed))
    return 1.0 - fewer < POOR
