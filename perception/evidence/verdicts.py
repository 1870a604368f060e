"""The verdict on a prediction of a published number."""

import math
from dataclasses import dataclass

from thermicon.base.words.number_text import significant, unit_text

from .targets import MINUS, Published, TargetRow, plain


@dataclass(frozen=True, slots=True)
class Verdict:
    """`holds` (None: shown, not judged), the `miss` (0: none), and its size with what was asked for, as text.

    Misses of one row compare between variants: logarithms of ratios, or differences in the unit of the row.
    """

    holds: bool | None
    miss: float
    text: str

    @property
    def word(self) -> str:
        """`holds`, `misses` or `shown`."""
        return "shown" if self.holds is None else "holds" if self.holds else "misses"


def judge_row(row: TargetRow, predicted: float | None, published: Published) -> Verdict:
    """The verdict on a predicted number, None where nothing was felt or there is no number.

    >>> from thermicon.perception.evidence.targets import Published, TargetRow
    >>> row = TargetRow("limits", "warm", "K", "limits", "threshold", "factor", "ours", value=1.5, published="limits")
    >>> judge_row(row, 3.0, Published("1.5 K", "somebody", value=1.5)).text
    '×2.00, at most ×1.5 either way'
    """
    if row.rule == "shown":
        return Verdict(None, 0.0, "shown, not judged")
    asked = criterion_of_row(row, published)
    if predicted is None or not math.isfinite(predicted):
        return Verdict(False, math.inf, f"nothing felt; {asked}")
    if row.rule in ("factor", "share"):
        return _by_ratio(row, predicted, published, asked)
    low, high, strict = _bounds(row, published)
    under, over = max(low - predicted, 0.0), max(predicted - high, 0.0)
    edge = strict and predicted in (low, high)
    miss = max(under, over)
    if miss == 0.0 and not edge:
        return Verdict(True, 0.0, asked)
    short = under > 0.0 or (edge and predicted == low)
    size = f"{plain(miss)}{unit_text(row.unit)} {'too low' if short else 'too high'}"
    return Verdict(False, miss, f"{size}; {asked}")


CRITERIA = {
    "factor": "at most ×{value:g} either way",
    "share": "within ±{percent:g} %",
    "above": "above {bound}{unit}",
    "below": "below {bound}{unit}",
    "at least": "at least {bound}{unit}",
    "close": "within {bound}{unit} of {middle}",
    "shown": "not judged",
    "range": "{low} to {high}{unit}",
    "published range": "{low} to {high}{unit}",
    "sign": "{side} 0{unit}",
}


def criterion_of_row(row: TargetRow, published: Published) -> str:
    """The rule in words, with its numbers."""
    value, middle = row.value or 0.0, published.value or 0.0
    low, high = _bounds(row, published)[:2] if row.rule.endswith("range") else (0.0, 0.0)
    return CRITERIA[row.rule].format(
        value=value,
        percent=100.0 * value,
        bound=plain(value),
        unit=unit_text(row.unit),
        middle=plain(middle),
        low=plain(low),
        high=plain(high),
        side="above" if middle > 0.0 else "below",
    )


def value_text(row: TargetRow, value: float, published: Published) -> str:
    """The value with as many digits as it takes to see on which side of the bounds of the rule it lies.

    >>> value_text(TargetRow("ratio", "", "1", "x", "y", "at least", "ours", value=2.0), 1.9953, Published("", ""))
    '1.995'
    """
    if row.rule in ("shown", "factor", "share") or not math.isfinite(value):
        return plain(value)
    bounds = [bound for bound in _bounds(row, published)[:2] if math.isfinite(bound)]
    text = significant(value, *bounds)[0].replace("-", MINUS)
    return text if "e" not in text and len(text) > len(plain(value)) else plain(value)


def _by_ratio(row: TargetRow, predicted: float, published: Published, asked: str) -> Verdict:
    ratio = predicted / _value(row, published)
    if ratio <= 0.0:
        return Verdict(False, math.inf, f"of the other sign; {asked}")
    limit, size = row.value or 0.0, max(ratio, 1.0 / ratio)
    if row.rule == "factor":
        way, holds = f"{'×' if ratio >= 1.0 else '÷'}{size:.2f}", size <= limit
    else:
        way, holds = f"{100.0 * (ratio - 1.0):+.0f} %".replace("-", MINUS), abs(ratio - 1.0) <= limit
    if holds:
        return Verdict(True, 0.0, f"{way}, {asked}")
    return Verdict(False, abs(math.log(ratio)), f"{way}, {asked}")


def _bounds(row: TargetRow, published: Published) -> tuple[float, float, bool]:
    """Least, most, and whether the bounds themselves are outside."""
    value = row.value or 0.0
    if row.rule == "range":
        return row.low or 0.0, row.high or 0.0, False
    if row.rule == "published range":
        if published.low is None or published.high is None:
            raise ValueError(f"{row.label}: the published record has no interval to be inside of")
        return published.low, published.high, False
    if row.rule in ("above", "at least"):
        return value, math.inf, row.rule == "above"
    if row.rule == "below":
        return -math.inf, value, True
    middle = _value(row, published)
    if row.rule == "sign":
        return (0.0, math.inf, True) if middle > 0.0 else (-math.inf, 0.0, True)
    return middle - value, middle + value, False


def _value(row: TargetRow, published: Published) -> float:
    if published.value is None:
        raise ValueError(f"{row.label}: the published record has no value to compare with")
    return published.value
