"""Numbers as people write them: no trailing zeros, a real minus sign, a dash for what is not there."""

from __future__ import annotations


def number(value: float, digits: int = 1) -> str:
    """Round to ``digits`` decimals, drop trailing zeros, and use a real minus sign.

    >>> number(3.0), number(-0.04), number(-1.28, 2)
    ('3', '0', '−1.28')
    """
    text = f"{value:.{digits}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text.replace("-", "−")


def span(low: float, high: float, unit: str, digits: int = 1) -> str:
    """Write a range; one number where both ends agree, and "to" where a dash could be taken for a sign.

    >>> span(8.0, 10.0, "s"), span(8.0, 8.0, "s"), span(-1.25, 0.5, "A", 2)
    ('8–10 s', '8 s', '−1.25 to 0.5 A')
    """
    low_end, high_end = number(low, digits), number(high, digits)
    if low_end == high_end:
        return f"{low_end} {unit}"
    return f"{low_end}{' to ' if low < 0 or high < 0 else '–'}{high_end} {unit}"


def percent(proportion: float | None) -> str:
    """Write a proportion as per cent; a dash where there is none.

    >>> percent(0.914), percent(None)
    ('91 %', '–')
    """
    return "–" if proportion is None else f"{100 * proportion:.0f} %"


def percent_span(low: float, high: float) -> str:
    """Write a range of proportions as per cent.

    >>> percent_span(0.76, 0.98), percent_span(1.0, 1.0)
    ('76–98 %', '100 %')
    """
    ends = [f"{100 * end:.0f}" for end in (low, high)]
    return f"{ends[0]} %" if ends[0] == ends[1] else f"{ends[0]}–{ends[1]} %"


def seconds(value: float | None) -> str:
    """Write a time to a hundredth of a second; a dash where there is none.

    >>> seconds(0.613), seconds(None)
    ('0.61 s', '–')
    """
    return "–" if value is None else f"{value:.2f} s"
