"""The comparison of the model with skin temperature alone on published results."""

import math

from .targets import Published, TargetRow
from .verdicts import judge_row


def nearer_of(row: TargetRow, model: float | None, baseline: float | None, published: Published) -> str:
    """Which of `model` and `baseline` is nearer to the published number, or else to the criterion of the row.

    `both` where they are as near, nothing where there is no baseline, or nothing to be near to.
    """
    low, high = published.low, published.high
    if published.value is not None:
        low = high = published.value
    numbered = row.compared and row.unit == published.unit

    def off(value: float | None) -> tuple[bool, float]:
        if numbered and low is not None and high is not None:
            return False, math.inf if value is None else max(low - value, value - high, 0.0)
        verdict = judge_row(row, value, published)
        return verdict.holds is not True, verdict.miss

    (missed, model_off), (other_missed, baseline_off) = off(model), off(baseline)
    if baseline is None or (missed and not row.judged):
        return ""
    if missed == other_missed and math.isclose(model_off, baseline_off):
        return "both"
    return "model" if (missed, model_off) < (other_missed, baseline_off) else "baseline"
