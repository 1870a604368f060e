"""Numbers as text for people."""

MOST = 17
"""With this many digits, two different numbers never read the same."""


def signed(value: float, form: str = "g") -> str:
    """Return a number as people write it, with a real minus sign.

    >>> signed(-0.25), signed(-2.956, ".2f"), signed(3.0)
    ('−0.25', '−2.96', '3')
    """
    return f"{value:{form}}".replace("-", "−")


def unit_text(unit: str) -> str:
    """A unit as it stands behind its number; nothing for the unit of a pure number, "1"."""
    return "" if unit == "1" else f" {unit}"


def count_of(count: int, noun: str, plural: str = "") -> str:
    """Write a count with its noun, whose plural has an s unless it is given.

    >>> count_of(1, "icon"), count_of(0, "choice"), count_of(2, "person", "people")
    ('1 icon', '0 choices', '2 people')
    """
    return f"{count} {noun if count == 1 else plural or f'{noun}s'}"


def listed(names: list[str] | tuple[str, ...], most: int = 3) -> str:
    """The first few names, and how many more there are."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


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
    """Return `value` with `digits` decimals, without zeros at the end beyond the first `least`.

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
    """The relation of a value to a just noticeable one.

    >>> verdict(1.5, 1.43), verdict(1.43, 1.43), verdict(1.2, 1.43)
    ('more than', 'as much as', 'within')
    """
    if value == limit:
        return "as much as"
    return "more than" if value > limit else "within"


def _reads_true(text: str, other: str, value: float, limit: float) -> bool:
    a, b = float(text), float(other)
    return (a > b, a < b) == (value > limit, value < limit)
