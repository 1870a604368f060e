"""A validation report as plain data, for `validation.json`: what does not exist is None, never NaN."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from ..observer.channels import VARIABLES
from .conditioning import (
    CHANGES_K,
    HOLD_S,
    RATE_K_PER_S,
    RIG,
    Conditioning,
    Magnitude,
    OnsetStages,
    experiment_title,
    suspected,
)
from .predicted import Predicted
from .results import EDGE, UNMOVED_SD, AblatedRow, Constant, PredictedRow
from .validate import Judged, Line, ValidationReport
from .verdicts import criterion_of_row


def report_file(report: ValidationReport) -> dict[str, Any]:
    """The keys of the file, in their order; proportions are 0–1, every number has its unit beside it."""
    evidence = report.evidence
    return {
        "thermicon": report.version,
        "people": report.people,
        "draws": report.draws,
        "seed": report.seed,
        "trials": report.trials,
        "variants": [{"name": variable, "variable": variable} for variable in VARIABLES],
        "targets": [
            {
                "number": section.target.number,
                "title": section.target.title,
                "asks": section.target.asks,
                "source": section.target.source,
                "mechanism_suspected": section.target.mechanism,
                "rows": [_line(line) for line in section.lines],
            }
            for section in report.sections
        ],
        "trade_offs": [
            {"variant": variant, "pairs": [asdict(trade) for trade in pairs]}
            for variant, pairs in zip(VARIABLES, report.trade_offs, strict=True)
        ],
        "confusions": [
            {
                "set": name,
                "variant": one.variable,
                "labels": list(one.labels),
                "probability": one.pooled.tolist(),
            }
            for name, all_of in (("six-icons", evidence.six), ("wave-confusions", evidence.waves))
            for one in all_of
        ],
        "wave_likeness": [asdict(one) for one in evidence.alike],
        "predictions": [_predicted(one) for one in evidence.predicted],
        "conditioning": conditioning_file(report.conditioning),
    }


def _line(line: Line) -> dict[str, Any]:
    return {
        "row": line.row.label,
        "unit": line.row.unit,
        "published": asdict(line.published),
        "criterion": {"text": criterion_of_row(line.row, line.published), "source": line.row.source},
        "better": line.nearer or None,
        "predicted": [_judged(one) for one in line.judged],
    }


def _judged(one: Judged) -> dict[str, Any]:
    found, verdict = one.predicted, one.verdict
    return {
        "variant": found.variable,
        "value": _finite(found.value),
        "interval": [_finite(found.low), _finite(found.high)],
        "people_16_to_84": None if found.people is None else list(found.people),
        "verdict": verdict.word,
        "text": verdict.text,
        "share_of_draws_that_hold": one.share_holding,
        "conditions": found.conditions,
    }


def _predicted(one: Predicted) -> dict[str, Any]:
    return {
        "experiment": one.experiment,
        "quantity": one.quantity,
        "channel": one.channel,
        "variant": one.variable,
        "value": _finite(one.value),
        "interval": [_finite(one.low), _finite(one.high)],
        "unit": one.unit,
        "conditions": one.conditions,
        "draws": [_finite(each) for each in one.draws],
    }


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


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
    stages = asdict(each)
    leg_s = stages.pop("leg_s")
    return {**stages, "onset_s": each.onset_s, "onset_with_conduction_of_leg_s": leg_s}


def _magnitude(each: Magnitude) -> dict[str, Any]:
    return {
        "channel": each.channel,
        "variable": each.variable,
        "changes_K": list(CHANGES_K),
        "peak_d_prime": list(each.peaks),
        "just_noticeable_steps": each.jnds,
        "conditions": f"{RATE_K_PER_S:g} K/s at the display, held {HOLD_S:g} s, {RIG}",
    }
