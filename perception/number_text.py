"""Numbers as text, with as many digits as it takes for a comparison to read as it is."""

from __future__ import annotations

MOST = 17
"""With this many digits, two different numbers never read the same."""


def decimals(value: float, limit: float, least: int = 2) -> int:
    """Fewest decimals, at least `least`, with which the two read as larger, smaller or equal, as they are.

    >>> decimals(1.4297, 1.43), decimals(1.2, 1.43), decimals(0.4, 0.4)
    (4, 2, 2)
    """
    for digits in range(least, MOST):
        if _reads_true(f"{value:.{digits}f}", f"{limit:.{digits}f}", value, limit):
            return digits
    return MOST


def fixed(value: float, digits: int, least: int = 2) -> str:
    """`value` with `digits` decimals, without zeros at the end beyond the first `least`.

    >>> fixed(1.43, 4), fixed(0.4, 2), fixed(1.4297, 4)
    ('1.43', '0.40', '1.4297')
    """
    text = f"{value:.{digits}f}"
    while digits > least and text.endswith("0"):
        text, digits = text[:-1], digits - 1
    return text


def significant(value: float, *limits: float, least: int = 3) -> tuple[str, ...]:
    """`value` and its limits with fewest significant digits, at least `least`, that read as they compare.

    >>> significant(0.0698, 0.07), significant(0.06996, 0.07), significant(0.502, 0.3, 0.5)
    (('0.0698', '0.07'), ('0.06996', '0.07'), ('0.502', '0.3', '0.5'))
    """
    for digits in range(least, MOST):
        text, *ends = (f"{number:.{digits}g}" for number in (value, *limits))
        if all(_reads_true(text, end, value, limit) for end, limit in zip(ends, limits, strict=True)):
            return (text, *ends)
    return tuple(f"{number:.{MOST}g}" for number in (value, *limits))


def verdict(value: float, limit: float) -> str:
    """How a value stands to what is just noticeable.

    >>> verdict(1.5, 1.43), verdict(1.43, 1.43), verdict(1.2, 1.43)
    ('more than', 'as much as', 'within')
    """
    if value == limit:
        return "as much as"
    return "more than" if value > limit else "within"


def _reads_true(text: str, other: str, value: float, limit: float) -> bool:
    a, b = float(text), float(other)
    return (a > b, a < b) == (value > limit, value < limit)
