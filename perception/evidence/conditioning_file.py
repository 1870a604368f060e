"""What the constants were inferred from as plain data, for `validation.json`."""

from __future__ import annotations

from typing import Any

from .conditioning import (
    EDGE,
    AblatedMechanism,
    ConditionedRow,
    Conditioning,
    InferredConstant,
    experiment_title,
)
from .magnitudes import CHANGES_K, HOLD_S, RATE_K_PER_S, RIG, Magnitude
from .onset_stages import OnsetStages
from .results import UNMOVED_SD


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


def _ablated(each: AblatedMechanism) -> dict[str, Any]:
    run = each.run
    return {
        "variable": run.variable,
        "without": run.without or None,
        "replaced_by": each.replaced_by or None,
        "log_evidence": run.log_evidence,
        "difference": run.difference,
        "sum_of_squares": run.squares,
        "worst_row": run.worst,
        "worst_sd": run.worst_sd,
        "sources": list(each.sources),
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
