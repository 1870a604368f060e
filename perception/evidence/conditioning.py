"""What the constants were inferred from: rows fitted and left out, constants and priors, what mechanisms are worth.

Everything comes from the shipped results of the inference; nothing is fitted here. A row is left out together with its
whole experiment, so that its prediction rests on the other nine. `conditioning_file` is all of it as plain data.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from statistics import median
from typing import Any

from .magnitudes import CHANGES_K, HOLD_S, RATE_K_PER_S, RIG, Magnitude, OnsetStages, magnitudes, stages_of_six
from .results import (
    EDGE,
    UNMOVED_SD,
    AblatedRow,
    Constant,
    PredictedRow,
    load_ablation,
    load_constants,
    load_predictions,
)
from .statistics import load_evidence

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
class Conditioning:
    """The evidence behind the constants, and what the constants say of onsets and sizes."""

    rows: tuple[PredictedRow, ...]
    constants: tuple[Constant, ...]
    offsets: tuple[Constant, ...]
    ablation: tuple[AblatedRow, ...]
    stages: tuple[OnsetStages, ...]
    magnitudes: tuple[Magnitude, ...]

    @property
    def missed(self) -> tuple[PredictedRow, ...]:
        """Rows outside of their interval, the worst first."""
        return tuple(sorted((r for r in self.rows if not r.covered), key=lambda r: -abs(r.score)))

    @property
    def unmoved(self) -> tuple[Constant, ...]:
        """Constants that the evidence did not move."""
        return tuple(each for each in self.constants if not each.moved)

    @property
    def at_edge(self) -> tuple[Constant, ...]:
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
    constants = load_constants()
    # The spread between laboratories is a constant; the offset of a single one, in SDs of it, is not.
    return Conditioning(
        rows=load_predictions(),
        constants=tuple(each for each in constants if each.unit != "SD"),
        offsets=tuple(each for each in constants if each.unit == "SD"),
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


def suspected(row: PredictedRow) -> str:
    """The mechanism behind a miss; nothing where the row is covered."""
    if row.covered:
        return ""
    return SUSPECTED.get((row.experiment, row.statistic, row.channel), "none named yet")


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


def _row(row: PredictedRow) -> dict[str, Any]:
    return {
        "experiment": row.experiment,
        "title": experiment_title(row.experiment),
        "statistic": row.statistic,
        "channel": row.channel,
        "row": row.label,
        "unit": row.unit,
        "log_scale": row.log,
        "published": {"value": row.published, "interval": [row.published_low, row.published_high]},
        "fitted": {"temperature": row.fitted, "heat flow": row.heat_flow},
        "left_out": {
            "value": row.left_out,
            "interval": [row.left_out_low, row.left_out_high],
            "miss_sd": row.score,
            "log_score": row.log_score,
            "covered": row.covered,
        },
        "mechanism_suspected": suspected(row) or None,
    }


def _constant(constant: Constant) -> dict[str, Any]:
    return {
        "name": constant.name,
        "mechanism": constant.mechanism,
        "unit": constant.unit,
        "value": constant.value,
        "interval": [constant.low, constant.high],
        "prior_interval": [constant.prior_low, constant.prior_high],
        "prior_source": constant.source,
        "sd_over_prior": constant.narrowed,
        "prior_quantile": constant.quantile,
        "moved": constant.moved,
        "at_edge": constant.at_edge,
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
