"""Tables of the sampled posterior as Markdown, from the shipped draws and left-out predictions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ..observer.draws import PosteriorDraws
from ..observer.variants import VARIABLES
from .left_out import FROM_WEIGHTS
from .left_out_file import LeftOutRow, load_left_out
from .results import UNMOVED_SD, load_constants
from .rows import load_rows
from .summaries import UNMOVED_SHIFT, Summary, summarise
from .table_text import UNITS, markdown, number, signed, span
from .tables import TABLES as INFERRED
from .variant_scores import VariantScores, variant_log_scores, variant_weights


def posterior_table() -> str:
    """Median and 95 % interval of every constant in the draws, beside the maximum; offsets of laboratories last."""
    maxima = {each.name: each.value for each in load_constants()}
    rows = []
    for each in summarise(PosteriorDraws.load()):
        unit = "" if each.unit == "SD" else UNITS.get(each.unit, each.unit)
        remark = "edge of its prior" if each.at_edge else "not moved" if each.unmoved else ""
        median = f"{number(each.median)} {unit}".strip()
        ends = span(each.low, each.high)
        rows.append((each.name, median, ends, number(maxima[each.name]), f"{each.narrowed:.2f}", remark))
    return markdown(("constant", "median", "95 %", "at the maximum", "SD left", ""), rows)


def sampled_sentence() -> str:
    """How the shipped draws were made."""
    header = PosteriorDraws.load().header
    return f"{header.sampler}, seed {header.seed}, {header.likelihoods} likelihoods: {header.status}."


def moved_sentence() -> str:
    """What the evidence did not move, and what it pushed to the edge of its prior."""
    found = [each for each in summarise(PosteriorDraws.load()) if each.unit != "SD"]
    return (
        f"Not moved (SD above {UNMOVED_SD:g} of the prior's, median within {UNMOVED_SHIFT:g} of its middle): "
        f"{_names(found, 'unmoved')}. "
        f"At the edge of the prior (median beyond its 95 %): {_names(found, 'at_edge')}."
    )


def _names(found: list[Summary], what: str) -> str:
    names = sorted(each.name for each in found if getattr(each, what))
    return ", ".join(names) if names else "none"


def sampled_left_out_table() -> str:
    """Every row predicted by draws that never saw its experiment; misses of the 95 % interval are bold."""
    rows = []
    for each in load_left_out():
        mark = "" if covered(each, 0.95) else "**"
        unit = {"1": "", "0-100": "of 100"}.get(each.unit, each.unit)
        naive = "" if math.isnan(each.naive) else signed(each.log_score - each.naive, 2)
        rows.append(
            (
                each.experiment,
                f"{mark}{each.label}{mark}",
                unit,
                number(each.published),
                number(each.median),
                span(each.lower, each.upper),
                span(each.low, each.high),
                signed(each.log_score, 2),
                naive,
            )
        )
    return markdown(
        ("key", "row", "unit", "published", "predicted", "50 %", "95 %", "log score", "over the naive baseline"), rows
    )


def scores_sentence(left_out: Sequence[LeftOutRow] | None = None) -> str:
    """Coverage, widths and log scores of left-out predictions (None: the shipped ones)."""
    rows = load_left_out() if left_out is None else left_out
    inside = [sum(covered(each, share) for each in rows) for share in (0.5, 0.95)]
    logs = {row.key for row in load_rows() if row.log}
    ratios = sorted(each.high / each.low for each in rows if (each.experiment, each.statistic, each.channel) in logs)
    compared = [each for each in rows if not math.isnan(each.naive)]
    gain = sum(each.log_score - each.naive for each in compared) / len(compared)
    weighted = dict.fromkeys(each.experiment for each in rows if each.method == FROM_WEIGHTS)
    return (
        f"{inside[0]} of {len(rows)} rows lie inside their 50 % interval and {inside[1]} inside their 95 % interval. "
        f"Half of the 95 % intervals of ratios span less than a factor of {ratios[len(ratios) // 2]:.1f}. "
        f"On {len(compared)} rows of a kind that two other experiments have, the log score is {signed(gain, 2)} a row "
        f"over the naive baseline. "
        f"Weights were enough for {', '.join(weighted) if weighted else 'no experiment'}; the others were refitted."
    )


def covered(row: LeftOutRow, share: float) -> bool:
    """Whether the central interval of a share contains the published number."""
    return abs(row.probability - 0.5) <= 0.5 * share


def variants_sentence(scores: Sequence[VariantScores] | None = None) -> str:
    """Mean left-out log score of each variant, their best mixture, and how sure temperature is better than heat flow.

    The standard error is that of a sum over experiments, whose rows share laboratory and people.
    """
    names, logs = VARIABLES, variant_log_scores(scores)
    weights = variant_weights(scores).values()
    parts = [
        f"{name} {signed(mean, 2)} (weight {weight:.2f})"
        for name, mean, weight in zip(names, logs.mean(axis=1).tolist(), weights, strict=True)
    ]
    gains: dict[str, float] = {}
    for row, gain in zip(load_rows(), (logs[0] - logs[1]).tolist(), strict=True):
        gains[row.experiment] = gains.get(row.experiment, 0.0) + gain
    each = np.array(list(gains.values()))
    error = float(each.std(ddof=1)) * math.sqrt(each.size)
    better = int((each > 0.0).sum())
    return (
        f"Mean log score a row: {', '.join(parts)}. All rows together, temperature is ahead of heat flow by "
        f"{signed(float(each.sum()), 1)} ± {error:.1f} (standard error over {each.size} experiments), and predicts "
        f"{better} of them better."
    )


TABLES: Mapping[str, Callable[[], str]] = {
    **INFERRED,
    "posterior": posterior_table,
    "sampled": sampled_sentence,
    "moved": moved_sentence,
    "left out by draws": sampled_left_out_table,
    "scores": scores_sentence,
    "variants": variants_sentence,
}
"""Every table of the pages by the name that a page's mark gives, those of the inference included."""
