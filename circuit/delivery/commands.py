"""A device's output as a file states it: its column and the codes of its commands."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Scale:
    """Whole codes to a command: `offset + step · code`, codes `lowest` … `highest`; `unit` is V, A, 1 or °C."""

    offset: float
    step: float
    lowest: int
    highest: int
    unit: str


@dataclass(frozen=True, slots=True)
class Column:
    """A column, channel or list of numbers in a file: its name, its unit and what it means."""

    name: str
    unit: str
    meaning: str
