"""What a person reads where an option needs a number and got something else."""

from __future__ import annotations

import re
from typing import Any

UNITS = {"S": "s", "HZ": "Hz", "J": "J", "K": "K", "POINTS": "percentage points", "PERCENT": "%"}
"""Units by the metavar of an option; others have none."""
WHOLE, DECIMAL = "int", "float"
ONE_OF, QUOTE = " is not one of ", "'"
BOUNDS = ("greater_than_equal", "less_than_equal")
DIGITS = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def number_fault(text: str, kind: str, unit: str = "") -> str:
    """Say what kind of number was wanted, and how to write it.

    >>> number_fault("abc", "float", "s")
    "'abc' is not a number in s; write it in digits, such as 2.5"
    >>> number_fault("10 s", "float", "s")
    "'10 s' is not a number in s; leave the unit out: 10"
    >>> number_fault("2,5", "float"), number_fault("2.5", "int")
    ("'2,5' is not a number; write a decimal point: 2.5", "'2.5' is not a whole number; write one, such as 12")
    """
    from thermicon.circuit.inputs import quoted

    bare = text.strip()
    what = "a whole number" if kind == WHOLE else f"a number in {unit}" if unit else "a number"
    own = re.fullmatch(rf"({DIGITS})\s*{re.escape(unit)}", bare) if unit else None
    if kind == WHOLE and re.fullmatch(r"[-+]?\d+", bare):
        return f"{quoted(text)} has too many digits to be read"
    if kind == DECIMAL and own:
        cure = f"leave the unit out: {own[1]}"
    elif kind == DECIMAL and re.fullmatch(r"[-+]?\d*,\d+", bare):
        cure = f"write a decimal point: {bare.replace(',', '.')}"
    else:
        cure = "write one, such as 12" if kind == WHOLE else "write it in digits, such as 2.5"
    return f"{quoted(text)} is not {what}; {cure}"


def reworded(error: Any) -> None:
    """Put such a sentence in the place of the parser's own words, where the value of an option cannot be.

    `error` is a bad parameter of the command line; others stay as they are.
    """
    param, faults = getattr(error, "param", None), getattr(error.__cause__, "errors", None)
    if param is None or faults is None:
        return
    fault = faults()[0]
    kind, text, unit = fault["type"].partition("_")[0], str(fault["input"]), UNITS.get(param.metavar or "", "")
    if kind in (WHOLE, DECIMAL):
        error.message = number_fault(text, kind, unit)
    elif fault["type"] in BOUNDS:
        unit = f" {unit}" if unit else ""
        error.message = f"{float(text):.10g}{unit} is outside {param.min:.10g} to {param.max:.10g}{unit}"
    else:
        wrong, joint, choices = error.message.removeprefix("Value error, ").removesuffix(".").partition(ONE_OF)
        error.message = f"{wrong}{joint}{choices.replace(QUOTE, '')}"
