"""A validation report as plain data, for `validation.json`: what does not exist is None, never NaN."""

from __future__ import annotations

import math
from typing import Any

from ..observer.channels import VARIABLES
from .conditioning import conditioning_file
from .predicted import Predicted
from .tradeoffs import TradeOff
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
            {"variant": variant, "pairs": [_trade(trade) for trade in pairs]}
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
        "wave_likeness": [
            {"group": one.group, "pair": list(one.pair), "largest": one.largest, "rms": one.rms}
            for one in evidence.alike
        ],
        "predictions": [_predicted(one) for one in evidence.predicted],
        "conditioning": conditioning_file(report.conditioning),
    }


def _line(line: Line) -> dict[str, Any]:
    was = line.published
    return {
        "row": line.row.label,
        "unit": line.row.unit,
        "published": {
            "text": was.text,
            "value": was.value,
            "low": was.low,
            "high": was.high,
            "unit": was.unit,
            "source": was.source,
            "conditions": was.conditions,
            "fitted": was.fitted,
        },
        "criterion": {"text": criterion_of_row(line.row, was), "source": line.row.source},
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


def _trade(trade: TradeOff) -> dict[str, Any]:
    return {
        "first": trade.first,
        "second": trade.second,
        "correlation": trade.correlation,
        "share_first_holds": trade.first_holds,
        "share_second_holds": trade.second_holds,
        "share_both_hold": trade.both_hold,
        "share_both_by_chance": trade.by_chance,
        "both_miss": trade.both_miss,
        "against": trade.against,
        "rarer_than_chance": trade.rarer,
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
