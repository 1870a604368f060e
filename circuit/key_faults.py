"""Faults of the keys of a file in words: what pydantic found, with key, value, limit, unit and cure."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from .inputs import TEXT_FAULT, quoted

Place = Sequence[int | str]

BOUNDS = {"greater_than": ("gt", "greater than"), "greater_than_equal": ("ge", "at least"),
          "less_than_equal": ("le", "at most")}  # fmt: skip
NUMBERS = {"float_type": "number", "int_type": "whole number", "int_from_float": "whole number",
           "finite_number": "finite number"}  # fmt: skip
SMALLEST = 0.01
"""A least value below this is there to keep 0 out, and is not told."""


def key_faults(
    problem: ValidationError,
    unknown: Callable[[Place], str],
    unit_of: Callable[[str], str] = lambda key: "",
    shape_of: Callable[[str], str] = lambda key: "must be spelled otherwise",
) -> list[str]:
    """Return every fault that a table found in its keys, a sentence each.

    `unknown` says what the key at a place may have been meant to be, `unit_of` has the unit of a dotted key, `shape_of`
    what a text must look like.
    """
    faults = [_in_words(error, unknown, unit_of, shape_of) for error in problem.errors(include_url=False)]
    return [line for fault in faults for line in fault.splitlines()]


def _in_words(
    error: ErrorDetails, unknown: Callable[[Place], str], unit_of: Callable[[str], str], shape_of: Callable[[str], str]
) -> str:
    key = ".".join(str(part) for part in error["loc"])
    unit, value, kind, context = unit_of(key), error.get("input"), error["type"], error.get("ctx", {})
    subject = f"{key} = {quoted(value)}" if isinstance(value, (int, float, str, bool)) else key
    behind = f" {unit}" if unit else ""
    if kind == "extra_forbidden":
        return f"{key}: unknown key; {unknown(error['loc'])}"
    if kind == TEXT_FAULT:
        return f"{subject}: {context['fault']}"
    if kind == "value_error":  # a sentence from a table's own validator
        return str(context["error"])
    if kind == "missing":
        return f"{key} is missing; add it{behind and f', in{behind}'}"
    if kind in BOUNDS:
        name, words = BOUNDS[kind]
        limit = context[name]
        if kind == "greater_than_equal" and 0 < limit < SMALLEST and value is not None and value <= 0:
            limit, words = 0, "greater than"
        return f"{subject}{behind}: must be {words} {limit:g}{behind}"
    if kind in NUMBERS:
        quotes = ", without quotes" if isinstance(value, str) else ""
        return f"{subject}: must be a {NUMBERS[kind]}{behind and f' in{behind}'}{quotes}"
    if kind == "bool_type":
        return f"{subject}: must be true or false"
    if kind == "literal_error":
        return f"{subject}: must be {context.get('expected')}"
    if kind == "string_pattern_mismatch":
        return f"{subject}: {shape_of(key)}"
    return f"{subject}: {error['msg'][:1].lower()}{error['msg'][1:]}"
