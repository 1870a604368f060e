"""Tables of the sampled posterior as Markdown.

Left-out predictions and variants are finished comparisons: tables that state their version.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from evidence_tables import TABLES as INFERRED
from table_text import UNITS, markdown, number, signed, span

from thermicon.base.numbers.arrays import Array
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.results import UNMOVED_SD, OfRow, load_constants, read_rows
from thermicon.perception.evidence.rows import load_rows
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.draws import PosteriorDraws


@dataclass(frozen=True, slots=True)
class VariantScores(OfRow):
    """Log scores of one left-out row by each variant: log densities of the published number on the row's scale."""

    temperature: float
    heat_flow: float


@dataclass(frozen=True, slots=True)
class LeftOutRow(OfRow):
    """One row predicted by draws of a posterior that never saw its experiment; numbers in the row's own unit.

    `low` to `high` is the 95 % interval, `lower` to `upper` that of 50 %. `probability` is that of a smaller number
    than the published one; `naive` is the log score of the naive baseline, NaN where there is none.
    """

    label: str
    unit: str
    published: float
    low: float
    lower: float
    median: float
    upper: float
    high: float
    probability: float
    log_score: float
    naive: float
    k_hat: float
    method: str

    def covered(self, share: float) -> bool:
        """Whether the central interval of a share contains the published number."""
        return abs(self.probability - 0.5) <= 0.5 * share


SCORES, LEFT_OUT = "variant-scores.csv", "left-out.csv"


def load_left_out() -> tuple[LeftOutRow, ...]:
    """Left-out predictions of every row by draws."""
    return tuple(read_rows(LEFT_OUT, LeftOutRow))


def variant_log_scores() -> Array:
    """Log scores (variants, rows) in the order of VARIABLES and of the likelihood."""
    rows = list(read_rows(SCORES, VariantScores))
    return np.array([[row.temperature for row in rows], [row.heat_flow for row in rows]])


def variant_weights() -> dict[Variable, float]:
    """Weights of the variants that predict the left-out rows best as a mixture."""
    return dict(zip(VARIABLES, stacking_weights(variant_log_scores()).tolist(), strict=True))


def stacking_weights(log_scores: Array, rounds: int = 2000) -> Array:
    """Weights (variants,) that sum to 1 and maximise the log score of the mixture, from log scores (variants, rows).

    Expectation–maximisation, which rises with every round (Yao, Vehtari, Simpson & Gelman 2018).
    """
    densities = np.exp(log_scores - log_scores.max(axis=0))
    weights = np.full(len(densities), 1.0 / len(densities))
    for _ in range(rounds):
        shares = weights[:, None] * densities
        weights = (shares / shares.sum(axis=0)).mean(axis=1)
    return weights


UNMOVED_SHIFT = 0.3
"""A constant that keeps more than `UNMOVED_SD`, with its median moved by fewer SDs of the prior, was not moved."""
EDGE = 1.96
"""A median so many SDs of the prior away from its middle lies at the edge of the prior."""


@dataclass(frozen=True, slots=True)
class Summary:
    """One constant in its own unit: median and 95 % interval; `narrowed` and `shift` are in SDs of its prior."""

    name: str
    unit: str
    median: float
    low: float
    high: float
    narrowed: float
    shift: float

    @property
    def unmoved(self) -> bool:
        """Whether the posterior is the prior, as good as."""
        return self.narrowed > UNMOVED_SD and abs(self.shift) < UNMOVED_SHIFT

    @property
    def at_edge(self) -> bool:
        """Whether evidence and prior disagree so much that the median lies at the end of the prior's 95 %."""
        return abs(self.shift) > EDGE


def summarise(draws: PosteriorDraws) -> tuple[Summary, ...]:
    """Every constant of a posterior, in the order of the table."""
    rows = []
    for prior in Posterior(draws.variable).priors.each:
        values = draws.values(prior.name)
        places = (np.array([prior.to_place(value) for value in values.tolist()]) - prior.middle) / prior.sd
        low, median, high = draws.interval(prior.name)
        rows.append(Summary(prior.name, prior.unit, median, low, high, float(places.std()), float(np.median(places))))
    return tuple(rows)


def posterior_table() -> str:
    """Median and 95 % interval of every constant in the draws, beside the maximum; offsets of laboratories last."""
    maxima = {item.name: item.value for item in load_constants()}
    rows = []
    for item in summarise(PosteriorDraws.load()):
        unit = "" if item.unit == "SD" else UNITS.get(item.unit, item.unit)
        remark = "edge of its prior" if item.at_edge else "not moved" if item.unmoved else ""
        median = f"{number(item.median)} {unit}".strip()
        ends = span(item.low, item.high)
        rows.append((item.name, median, ends, number(maxima[item.name]), f"{item.narrowed:.2f}", remark))
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
        f"{_names([each for each in found if each.unmoved])}. "
        f"At the edge of the prior (median beyond its 95 %): {_names([each for each in found if each.at_edge])}."
    )


def _names(found: Sequence[Summary]) -> str:
    return ", ".join(sorted(each.name for each in found)) or "none"


def sampled_left_out_table(*, spreads: bool) -> str:
    """Spreads, or all other rows, by draws that never saw their experiment; misses of the 95 % interval are bold."""
    rows = []
    for case in load_left_out():
        if (case.row.kind == "spread") is not spreads:
            continue
        mark = "" if case.covered(0.95) else "**"
        unit = {"1": "", "0-100": "of 100"}.get(case.unit, case.unit)
        naive = "" if math.isnan(case.naive) else signed(case.log_score - case.naive, 2)
        numbers = number(case.published), number(case.median), span(case.lower, case.upper), span(case.low, case.high)
        rows.append((case.experiment, f"{mark}{case.label}{mark}", unit, *numbers, signed(case.log_score, 2), naive))
    return markdown(
        ("key", "row", "unit", "published", "predicted", "50 %", "95 %", "log score", "over the naive baseline"), rows
    )


def scores_sentence() -> str:
    """Coverage, widths and log scores of left-out predictions of the rows by which they are judged."""
    every = load_left_out()
    rows = [scored for scored in every if scored.row.judges]
    spread = [scored for scored in every if scored.row.kind == "spread"]
    inside, wide = ([sum(scored.covered(share) for scored in some) for share in (0.5, 0.95)] for some in (rows, spread))
    ratios = sorted(scored.high / scored.low for scored in rows if scored.row.log)
    compared = [scored for scored in every if not math.isnan(scored.naive)]
    gain = sum(scored.log_score - scored.naive for scored in compared) / len(compared)
    weighted = dict.fromkeys(scored.experiment for scored in every if scored.method == "weights")
    kinds = ", ".join(f"{count} {kind}s" for kind, count in Counter(scored.row.kind for scored in rows).items())
    return (
        f"{inside[0]} of {len(rows)} rows ({kinds}) lie inside their 50 % interval and {inside[1]} inside their "
        f"95 % interval; of the {len(spread)} spreads, which judge nothing, {wide[0]} and {wide[1]}. E8 and signs are "
        "not counted. "
        f"Half of the 95 % intervals of ratios span less than a factor of {ratios[len(ratios) // 2]:.1f}. "
        f"On {len(compared)} rows of a kind that two other experiments have, the log score is {signed(gain, 2)} a row "
        f"over the naive baseline. "
        f"Weights were taken for {', '.join(weighted) if weighted else 'no experiment'}; the others were refitted."
    )


def variants_sentence() -> str:
    """Mean left-out log score of each variant, their best mixture, and how sure temperature beats heat flow."""
    logs = variant_log_scores()
    parts = [
        f"{name} {signed(mean, 2)} (weight {weight:.2f})"
        for (name, weight), mean in zip(variant_weights().items(), logs.mean(axis=1).tolist(), strict=True)
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
    "left out by draws": lambda: sampled_left_out_table(spreads=False),
    "left out spreads": lambda: sampled_left_out_table(spreads=True),
    "scores": scores_sentence,
    "variants": variants_sentence,
}
"""Every table of the pages by the name that a page's mark gives, those of the inference included."""
