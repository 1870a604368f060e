"""The uncertainty of a rig: what is assumed where the rig file is silent, and what it takes to claim less.

A smaller uncertainty makes the worst case milder and so loosens the gate of safety, as a looser limit does: it needs a
written reason, which is reported with every verdict.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import resources

from ..records import Table, load_records
from .faults import sentence
from .parts import Uncertainty
from .rules import FEWEST_WORDS, SHORTEST_REASON, is_reason

WORDS = {
    "contact_resistance_relative": ("contact resistance", "contact", 100.0, "%"),
    "ambient_K": ("ambient", "ambient", 1.0, "K"),
    "gain_relative": ("gain", "gain", 100.0, "%"),
    "heat_sink_K": ("heat sink", "heat sink", 1.0, "K"),
    "seebeck_relative": ("Seebeck coefficient", "Seebeck", 100.0, "%"),
    "conductance_relative": ("thermal conductance", "conductance", 100.0, "%"),
    "plates_relative": ("plates", "plates", 100.0, "%"),
}
"""What is uncertain: its name, a short name for lists, the factor to the unit that people read, and that unit."""


@cache
def uncertainty_table() -> Table:
    """The shipped uncertainties, each with its source."""
    return load_records(resources.files("thermicon.circuit") / "data" / "uncertainty.toml")


def uncertainty_of(stated_values: Mapping[str, float], reason: str = "") -> Uncertainty:
    """Return the uncertainty of a rig, with the shipped value of what is not given."""
    return Uncertainty(**{**_shipped(), **stated_values}, reason=reason.strip())


def uncertainty_faults(stated_values: Mapping[str, float], reason: str = "") -> list[str]:
    """Return one sentence for each uncertainty that is smaller than the shipped one without a reason."""
    if is_reason(reason):
        return []
    faults = []
    for key, shipped in _shipped().items():
        value, unit = stated_values.get(key, shipped), " K" if key.endswith("_K") else ""
        if value < shipped:
            least = {"letters": SHORTEST_REASON, "words": FEWEST_WORDS}
            faults.append(sentence("faults.surer", key=key, value=value, unit=unit, shipped=shipped, **least))
    return faults


def tightened(uncertainty: Uncertainty) -> tuple[str, ...]:
    """A few words for each uncertainty that is smaller than shipped."""
    return tuple(
        f"{words} ±{scale * getattr(uncertainty, key):g} {unit} instead of ±{scale * _shipped()[key]:g} {unit}"
        for key, (words, _, scale, unit) in WORDS.items()
        if getattr(uncertainty, key) < _shipped()[key]
    )


def stated(uncertainty: Uncertainty) -> str:
    """All uncertainties in words, for the heading of a verdict."""
    return ", ".join(
        f"{words} ±{scale * getattr(uncertainty, key):g} {unit}" for key, (words, _, scale, unit) in WORDS.items()
    )


@cache
def _shipped() -> dict[str, float]:
    return {record.quantity: record.central for record in uncertainty_table()}
