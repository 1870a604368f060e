"""The uncertainty of a rig: what is assumed where the rig file is silent, and what it takes to claim less.

A smaller uncertainty makes the worst case milder and so loosens the gate of safety, as a looser limit does: it needs a
written reason, which is reported with every verdict.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import resources

from ..records import Table, load_records
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
    """Return the uncertainty of a rig, with the shipped value of what is not given.

    >>> uncertainty_of({"ambient_K": 5.0})
    Uncertainty(contact_resistance_relative=0.3, ambient_K=5.0, gain_relative=0.1, heat_sink_K=1.0,
                seebeck_relative=0.05, conductance_relative=0.1, plates_relative=0.2, reason='')
    """
    return Uncertainty(**{**_shipped(), **stated_values}, reason=reason.strip())


def uncertainty_faults(stated_values: Mapping[str, float], reason: str = "") -> list[str]:
    """Return one sentence for each uncertainty that is smaller than the shipped one without a reason.

    >>> uncertainty_faults({"gain_relative": 0.02}, "gain measured against a shunt, 2026-05-12")
    []
    """
    if is_reason(reason):
        return []
    faults = []
    for key, shipped in _shipped().items():
        value, unit = stated_values.get(key, shipped), " K" if key.endswith("_K") else ""
        if value < shipped:
            faults.append(
                f"uncertainty.{key} = {value:g}{unit}: is smaller than the shipped {shipped:g}{unit}, which loosens "
                f"the gate of safety; give uncertainty.reason, a sentence of at least {SHORTEST_REASON} characters and "
                f"{FEWEST_WORDS} different words on how this is known "
                f"(--set 'uncertainty.reason=\"measured ...\"'), or use {shipped:g}{unit} or more"
            )
    return faults


def tightened(uncertainty: Uncertainty) -> tuple[str, ...]:
    """A few words for each uncertainty that is smaller than shipped.

    >>> tightened(uncertainty_of({"gain_relative": 0.02}))
    ('gain ±2 % instead of ±10 %',)
    """
    return tuple(
        f"{words} ±{scale * getattr(uncertainty, key):g} {unit} instead of ±{scale * _shipped()[key]:g} {unit}"
        for key, (words, _, scale, unit) in WORDS.items()
        if getattr(uncertainty, key) < _shipped()[key]
    )


def stated(uncertainty: Uncertainty) -> str:
    """All uncertainties in words, for the heading of a verdict.

    >>> stated(uncertainty_of({}))[:60]
    'contact resistance ±30 %, ambient ±3 K, gain ±10 %, heat sin'
    """
    return ", ".join(
        f"{words} ±{scale * getattr(uncertainty, key):g} {unit}" for key, (words, _, scale, unit) in WORDS.items()
    )


@cache
def _shipped() -> dict[str, float]:
    return {record.quantity: record.central for record in uncertainty_table()}
