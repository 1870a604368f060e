"""How a prediction stands to a published number: holds, or misses and by how much."""

from __future__ import annotations

import math
from dataclasses import dataclass

from thermicon.icons.number_text import significant

from .targets import Published, Row

MINUS = "−"


@dataclass(frozen=True, slots=True)
class Verdict:
    """`holds` is None for what is shown and not judged; `miss` is 0 where it holds and grows with the miss.

    Misses of one row compare between variants: they are logarithms of ratios, or differences in the unit of
    the row. `text` says the size, with what was asked for. `way` is +1 where the prediction is too high, −1 where
    it is too low, 0 where it holds or nothing was felt.
    """

    holds: bool | None
    miss: float
    text: str
    way: int = 0

    @property
    def word(self) -> str:
        """`holds`, `misses` or `shown`."""
        return "shown" if self.holds is None else "holds" if self.holds else "misses"


def judge_row(row: Row, predicted: float | None, published: Published) -> Verdict:
    """The verdict on a predicted number, None where nothing was felt or there is no number.

    >>> from thermicon.perception.evidence.targets import Published, Row
    >>> row = Row(2, "limits", "warm", "K", "limits", "threshold", "factor", "ours", value=1.5, published="limits")
    >>> judge_row(row, 3.0, Published("1.5 K", "somebody", value=1.5)).text
    '×2.00, at most ×1.5 either way'
    """
    if row.rule == "shown":
        return Verdict(None, 0.0, "shown, not judged")
    if predicted is None or math.isnan(predicted) or math.isinf(predicted):
        return Verdict(False, math.inf, f"nothing felt; {criterion_of_row(row, published)}")
    asked = criterion_of_row(row, published)
    if row.rule in ("factor", "share"):
        return _by_ratio(row, predicted, published, asked)
    low, high, strict = _bounds(row, published)
    under, over = max(low - predicted, 0.0), max(predicted - high, 0.0)
    edge = strict and predicted in (low, high)
    miss = max(under, over)
    if miss == 0.0 and not edge:
        return Verdict(True, 0.0, asked)
    way = "short" if under > 0.0 or (edge and predicted == low) else "over"
    unit = "" if row.unit == "1" else f" {row.unit}"
    size = f"{plain(miss)}{unit} {'too low' if way == 'short' else 'too high'}"
    return Verdict(False, miss, f"{size}; {asked}", -1 if way == "short" else 1)


def criterion_of_row(row: Row, published: Published) -> str:
    """The rule in words, with its numbers."""
    unit = "" if row.unit == "1" else f" {row.unit}"
    value = 0.0 if row.value is None else row.value
    if row.rule == "factor":
        return f"at most ×{value:g} either way"
    if row.rule == "share":
        return f"within ±{100 * value:g} %"
    if row.rule == "above":
        return f"above {plain(value)}{unit}"
    if row.rule == "below":
        return f"below {plain(value)}{unit}"
    if row.rule == "at least":
        return f"at least {plain(value)}{unit}"
    if row.rule == "sign":
        return f"{'above' if (published.value or 0.0) > 0 else 'below'} 0{unit}"
    if row.rule == "close":
        return f"within {plain(value)}{unit} of {plain(published.value or 0.0)}"
    if row.rule == "shown":
        return "not judged"
    low, high, _ = _bounds(row, published)
    return f"{plain(low)} to {plain(high)}{unit}"


def value_text(row: Row, value: float, published: Published) -> str:
    """The value with as many digits as it takes to see on which side of the bounds of the rule it lies.

    >>> value_text(Row(7, "ratio", "", "1", "x", "y", "at least", "ours", value=2.0), 1.9953, Published("", ""))
    '1.995'
    """
    if row.rule in ("shown", "factor", "share") or not math.isfinite(value):
        return plain(value)
    low, high, _ = _bounds(row, published)
    bounds = [bound for bound in (low, high) if math.isfinite(bound)]
    text = significant(value, *bounds)[0]
    return (
        text.replace("-", MINUS)
        if "e" not in text and len(text) > len(plain(value).replace(MINUS, "-"))
        else plain(value)
    )


def plain(value: float) -> str:
    """Three digits, with a real minus sign.

    >>> plain(-0.12345), plain(16.466), plain(0.0)
    ('−0.123', '16.5', '0')
    """
    text = f"{value:.3g}"
    if "e" in text:
        text = f"{value:.1e}" if abs(value) < 1e-3 else f"{value:.0f}"
    return text.replace("-", MINUS)


def _by_ratio(row: Row, predicted: float, published: Published, asked: str) -> Verdict:
    ratio = predicted / _value(row, published)
    if ratio <= 0.0:
        return Verdict(False, math.inf, f"of the other sign; {asked}")
    limit = row.value or 0.0
    if row.rule == "factor":
        size = max(ratio, 1.0 / ratio)
        way = f"×{size:.2f}" if ratio >= 1.0 else f"÷{size:.2f}"
        holds = size <= limit
    else:
        percent = f"{100.0 * (ratio - 1.0):+.0f} %".replace("-", MINUS)
        way, holds = percent, abs(ratio - 1.0) <= limit
    if holds:
        return Verdict(True, 0.0, f"{way}, {asked}")
    return Verdict(False, abs(math.log(ratio)), f"{way}, {asked}", 1 if ratio > 1.0 else -1)


def _bounds(row: Row, published: Published) -> tuple[float, float, bool]:
    """Least, most, and whether the bounds themselves are outside."""
    value = 0.0 if row.value is None else row.value
    if row.rule == "range":
        return row.low or 0.0, row.high or 0.0, False
    if row.rule == "published range":
        if published.low is None or published.high is None:
            raise ValueError(f"{row.label}: the published record has no interval to be inside of")
        return published.low, published.high, False
    if row.rule == "above":
        return value, math.inf, True
    if row.rule == "below":
        return -math.inf, value, True
    if row.rule == "at least":
        return value, math.inf, False
    middle = _value(row, published)
    if row.rule == "sign":
        return (0.0, math.inf, True) if middle > 0.0 else (-math.inf, 0.0, True)
    return middle - value, middle + value, False


def _value(row: Row, published: Published) -> float:
    if published.value is None:
        raise ValueError(f"{row.label}: the published record has no value to compare with")
    return published.value
