"""A validation report as plain data for `validation.json`."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from .predicted import Predicted
from .results import PredictedRow, judging_predictions, load_predictions, median_half_width
from .rows import load_evidence
from .verdicts import criterion_of_row

if TYPE_CHECKING:
    from .validate import JudgedRow, ReportRow, ValidationReport


def report_file(report: ValidationReport) -> dict[str, Any]:
    """The keys of the file, in their order; proportions are 0–1, every number has its unit beside it."""
    evidence = report.evidence
    return {
        **_data(report, "people", "draws", "seed", "trials", thermicon="version"),
        "targets": [
            {
                **_data(section.target, "number", "title", "asks", "source", mechanism_suspected="mechanism"),
                "rows": [_line(line) for line in section.lines],
            }
            for section in report.sections
        ],
        "confusions": [
            {"set": name, "variant": one.variable, "labels": list(one.labels), "probability": one.pooled.tolist()}
            for name, all_of in (("six-icons", evidence.six), ("wave-confusions", evidence.waves))
            for one in all_of
        ],
        "wave_likeness": [asdict(one) for one in evidence.alike],
        "predictions": [_predicted(one) for one in evidence.predicted],
        "conditioning": conditioning_file(),
    }


def _line(line: ReportRow) -> dict[str, Any]:
    return {
        "row": line.row.label,
        "unit": line.row.unit,
        "published": asdict(line.published),
        "criterion": {"text": criterion_of_row(line.row, line.published), "source": line.row.source},
        "baseline": _finite(line.baseline),
        "nearer_to_published": line.nearer_to_published or None,
        "predicted": [_judged(one) for one in line.judged],
    }


def _judged(one: JudgedRow) -> dict[str, Any]:
    found, verdict = one.predicted, one.verdict
    return {
        **_data(found, "conditions", variant="variable"),
        **_data(verdict, "text", verdict="word"),
        "value": _finite(found.value),
        "interval": [_finite(found.low), _finite(found.high)],
        "held_in_draws": one.held,
    }


def _predicted(one: Predicted) -> dict[str, Any]:
    return {
        **_data(one, "experiment", "quantity", "channel", "unit", "conditions", variant="variable"),
        "value": _finite(one.value),
        "interval": [_finite(one.low), _finite(one.high)],
        "draws": [_finite(each) for each in one.draws],
    }


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def conditioning_file() -> dict[str, Any]:
    """Rows that the constants were inferred from, each predicted without its experiment; numbers with their units."""
    judging = judging_predictions()
    return {
        "rows": [_row(each) for each in load_predictions()],
        "summary": {
            "rows": len(judging),
            "covered": sum(each.covered for each in judging),
            "expected": 0.95 * len(judging),
            "median_factor": median_half_width(log=True),
            "rows_on_log_scale": sum(each.log for each in judging),
            "median_share_of_published": median_half_width(log=False),
        },
    }


def _data(each: object, *same: str, **named: str) -> dict[str, Any]:
    """Attributes of a record by the keys of the file: `same` where both have one name, `named` where they have not."""
    return {name: getattr(each, name) for name in same} | {key: getattr(each, name) for key, name in named.items()}


def _row(row: PredictedRow) -> dict[str, Any]:
    return {
        **_data(row, "experiment", "statistic", "channel", "unit", row="label", log_scale="log"),
        "title": load_evidence().experiments[row.experiment].title,
        "published": {"value": row.published, "interval": [row.published_low, row.published_high]},
        "fitted": {"temperature": row.fitted, "heat flow": row.heat_flow},
        "left_out": {
            **_data(row, "log_score", "covered", value="left_out", miss_sd="score"),
            "interval": [row.left_out_low, row.left_out_high],
        },
        "mechanism_suspected": row.suspected or None,
    }
