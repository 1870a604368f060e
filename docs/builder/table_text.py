"""Numbers and tables as Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

UNITS = {
    "1": "",
    "degC": "°C",
    "m2K/W": "m²K/W",
    "d'": "d′",
    "ln per d'": "ln per d′",
    "multiple of the hand": "× the hand",
}


def number(value: float) -> str:
    """Three figures, with a minus sign.

    >>> number(-0.02042), number(151.97), number(0.0002049)
    ('−0.0204', '152', '0.000205')
    >>> number(1073.0), number(0.25), number(0.0000787)
    ('1073', '0.25', '0.0000787')
    """
    digits = 2 - math.floor(math.log10(abs(value))) if value else 0
    text = f"{value:.{max(digits, 0)}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")


def signed(value: float, digits: int) -> str:
    """A number with its sign, 0 without one.

    >>> signed(-12.61, 1), signed(0.0, 1), signed(2.04, 1)
    ('−12.6', '0', '+2.0')
    """
    return "0" if value == 0.0 else f"{value:+.{digits}f}".replace("-", "−")


def span(low: float, high: float) -> str:
    """Both ends of an interval.

    >>> span(-0.1, 0.3)
    '−0.1 to 0.3'
    """
    return f"{number(low)} to {number(high)}"


def markdown(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [" | ".join(head), " | ".join("---" for _ in head)]
    lines += [" | ".join(str(cell) for cell in row) for row in rows]
    return "\n".join(f"| {line} |" for line in lines)
