"""What the constants were inferred from: rows fitted and left out, constants and priors, what mechanisms are worth.

Everything comes from the shipped results of the inference; nothing is fitted here. A row is left out together with its
whole experiment, so that its prediction rests on the other nine. `conditioning_file` is all of it as plain data.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist, median
from typing import Any

from ..observer.priors import WITHIN_95
from .magnitudes import CHANGES_K, HOLD_S, RATE_K_PER_S, RIG, Magnitude, OnsetStages, magnitudes, stages_of_six
from .posterior import Posterior
from .results import (
    UNMOVED_SD,
    AblatedRow,
    Constant,
    PredictedRow,
    load_ablation,
    load_constants,
    load_predictions,
)
from .rows import load_rows
from .statistics import load_evidence

EDGE = 0.1
"""A constant in the outer tenth of its prior, at either end, sits at an edge: the evidence pulls against the prior."""
OFFSETS = "laboratories"
TITLES = {
    "thenar": "Forced choice at the thenar",
    "wrist": "Forced choice at the wrist",
    "amplitudes": "Amplitude differences",
    "steps": "Steps from threshold to pain",
}
"""Titles of experiments that are printed in papers and have no table of open data."""
SAME_NOISE = (
    "noise of gain and sensation is the same for everybody: sensitivity and criterion alone make widths differ less "
    "than they do"
)
SUSPECTED = {
    ("E1", "rt_within_sd_ln_5strip_onset_clock", "warm"): (
        "scatter of decision times: no other experiment asks for a choice in haste; and warm fibres, which differ in "
        "velocity, conduct with one velocity here"
    ),
    ("E1", "rt_cold_warm_correlation_5strip_onset_clock", "both"): (
        "people's decision times, which both channels share, differ more than the other experiments show"
    ),
    ("E4", "sigma_gm_age30", "warm"): (
        "the criterion of yes and no is known from this experiment alone: without it thresholds, and widths with them, "
        "come out too small"
    ),
    ("E4", "sigma_between_sd_log10_noise_removed", "cold"): SAME_NOISE,
    ("E4", "sigma_between_sd_log10_noise_removed", "warm"): SAME_NOISE,
}
"""Mechanism suspected of each row that is missed when its experiment is left out."""


@dataclass(frozen=True, slots=True)
class ConditionedRow:
    """A published number that the constants were inferred from, with its fits and its prediction when left out.

    `log` says on which scale the row is judged, `suspected` the mechanism behind a miss (nothing where it is covered).
    """

    row: PredictedRow
    log: bool
    suspected: str

    @property
    def covered(self) -> bool:
        """Whether the 95 % interval of what would be measured contains what was."""
        return abs(self.row.score) <= WITHIN_95

    @property
    def half_width(self) -> float:
        """Half the 95 % interval: a factor above 1 on a log scale, otherwise a share of the published number."""
        low, high = self.row.left_out_low, self.row.left_out_high
        return math.sqrt(high / low) if self.log else 0.5 * (high - low) / abs(self.row.published)


@dataclass(frozen=True, slots=True)
class InferredConstant:
    """A constant with its prior; `quantile` is the place of its value in the prior, 0 to 1."""

    constant: Constant
    quantile: float

    @property
    def moved(self) -> bool:
        """Whether the evidence narrowed it to less than `UNMOVED_SD` of the prior's."""
        return self.constant.narrowed <= UNMOVED_SD

    @property
    def at_edge(self) -> bool:
        """Whether its value lies in an outer tenth of the prior."""
        return not EDGE <= self.quantile <= 1.0 - EDGE


@dataclass(frozen=True, slots=True)
class Conditioning:
    """The evidence behind the constants, and what the constants say of onsets and sizes."""

    rows: tuple[ConditionedRow, ...]
    constants: tuple[InferredConstant, ...]
    offsets: tuple[InferredConstant, ...]
    ablation: tuple[AblatedRow, ...]
    stages: tuple[OnsetStages, ...]
    magnitudes: tuple[Magnitude, ...]

    @property
    def missed(self) -> tuple[ConditionedRow, ...]:
        """Rows outside of their interval, the worst first."""
        return tuple(sorted((r for r in self.rows if not r.covered), key=lambda r: -abs(r.row.score)))

    @property
    def unmoved(self) -> tuple[InferredConstant, ...]:
        """Constants that the evidence did not move."""
        return tuple(each for each in self.constants if not each.moved)

    @property
    def at_edge(self) -> tuple[InferredConstant, ...]:
        """Constants at an edge of their prior."""
        return tuple(each for each in self.constants if each.at_edge)

    def median_half_width(self, *, log: bool) -> float:
        """Median of the half widths of the rows on one scale."""
        return median(each.half_width for each in self.rows if each.log == log)

    def __repr__(self) -> str:
        inside = len(self.rows) - len(self.missed)
        return (
            f"Conditioning({inside} of {len(self.rows)} rows covered when left out; {len(self.constants)} constants, "
            f"{len(self.unmoved)} not moved, {len(self.at_edge)} at an edge of the prior)"
        )


@lru_cache(maxsize=1)
def load_conditioning() -> Conditioning:
    """The shipped evidence, with onsets of the six icons and sizes of sensations.

    >>> load_conditioning()
    Conditioning(49 of 54 rows covered when left out; 42 constants, 9 not moved, 4 at an edge of the prior)
    """
    constants = tuple(_placed(each) for each in load_constants())
    return Conditioning(
        rows=_rows(),
        constants=tuple(each for each in constants if each.constant.mechanism != OFFSETS or _shared(each)),
        offsets=tuple(each for each in constants if each.constant.mechanism == OFFSETS and not _shared(each)),
        ablation=tuple(sorted(load_ablation(), key=lambda run: run.difference)),
        stages=stages_of_six(),
        magnitudes=magnitudes(),
    )


def experiment_title(key: str) -> str:
    """Title of an experiment of the evidence by its key.

    >>> experiment_title("wrist"), experiment_title("E3")
    ('Forced choice at the wrist', 'Method of limits on the forearm')
    """
    return TITLES[key] if key in TITLES else load_evidence().experiment(key).title


def _rows() -> tuple[ConditionedRow, ...]:
    log = {row.key: row.log for row in load_rows()}
    rows = []
    for row in load_predictions():
        key = (row.experiment, row.statistic, row.channel)
        missed = abs(row.score) > WITHIN_95
        rows.append(ConditionedRow(row, log[key], SUSPECTED.get(key, "none named yet") if missed else ""))
    return tuple(rows)


def _placed(each: Constant) -> InferredConstant:
    prior = next(prior for prior in Posterior().priors.each if prior.name == each.name)
    return InferredConstant(each, NormalDist(prior.middle, prior.sd).cdf(prior.to_place(each.value)))


def _shared(each: InferredConstant) -> bool:
    """The spread between laboratories is a constant; the offset of a single laboratory, in SDs of it, is not."""
    return each.constant.unit != "SD"


def conditioning_file(known: Conditioning) -> dict[str, Any]:
    """The keys under `conditioning`, in their order; every number has its unit beside it or in its name."""
    return {
        "rows": [_row(each) for each in known.rows],
        "summary": {
            "rows": len(known.rows),
            "covered": len(known.rows) - len(known.missed),
            "expected": 0.95 * len(known.rows),
            "median_factor": known.median_half_width(log=True),
            "rows_on_log_scale": sum(each.log for each in known.rows),
            "median_share_of_published": known.median_half_width(log=False),
        },
        "constants": [_constant(each) for each in known.constants],
        "laboratory_offsets": [_constant(each) for each in known.offsets],
        "not_moved_above": UNMOVED_SD,
        "edge_below": EDGE,
        "ablation": [_ablated(each) for each in known.ablation],
        "onset_stages": [_stages(each) for each in known.stages],
        "magnitudes": [_magnitude(each) for each in known.magnitudes],
    }


def _row(each: ConditionedRow) -> dict[str, Any]:
    row = each.row
    return {
        "experiment": row.experiment,
        "title": experiment_title(row.experiment),
        "statistic": row.statistic,
        "channel": row.channel,
        "row": row.label,
        "unit": row.unit,
        "log_scale": each.log,
        "published": {"value": row.published, "interval": [row.published_low, row.published_high]},
        "fitted": {"temperature": row.fitted, "heat flow": row.heat_flow},
        "left_out": {
            "value": row.left_out,
            "interval": [row.left_out_low, row.left_out_high],
            "miss_sd": row.score,
            "log_score": row.log_score,
            "covered": each.covered,
        },
        "mechanism_suspected": each.suspected or None,
    }


def _constant(each: InferredConstant) -> dict[str, Any]:
    constant = each.constant
    return {
        "name": constant.name,
        "mechanism": constant.mechanism,
        "unit": constant.unit,
        "value": constant.value,
        "interval": [constant.low, constant.high],
        "prior_interval": [constant.prior_low, constant.prior_high],
        "prior_source": constant.source,
        "sd_over_prior": constant.narrowed,
        "prior_quantile": each.quantile,
        "moved": each.moved,
        "at_edge": each.at_edge,
    }


def _ablated(run: AblatedRow) -> dict[str, Any]:
    return {
        "variable": run.variable,
        "without": run.without or None,
        "replaced_by": run.replaced_by or None,
        "log_evidence": run.log_evidence,
        "difference": run.difference,
        "sum_of_squares": run.squares,
        "worst_row": run.worst,
        "worst_sd": run.worst_sd,
        "sources": run.sources.split(" | ") if run.sources else [],
    }


def _stages(each: OnsetStages) -> dict[str, Any]:
    return {
        "icon": each.icon,
        "channel": each.channel,
        "receptor_s": each.receptor_s,
        "nerve_s": each.nerve_s,
        "cord_s": each.cord_s,
        "decision_s": each.decision_s,
        "onset_s": each.onset_s,
        "onset_with_conduction_of_leg_s": each.leg_s,
    }


def _magnitude(each: Magnitude) -> dict[str, Any]:
    return {
        "channel": each.channel,
        "variable": each.variable,
        "changes_K": list(CHANGES_K),
        "peak_d_prime": list(each.peaks),
        "just_noticeable_steps": each.jnds,
        "conditions": f"{RATE_K_PER_S:g} K/s at the display, held {HOLD_S:g} s, {RIG}",
    }
