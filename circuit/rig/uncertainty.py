"""The uncertainty of a rig: assumed spreads or narrower ones with a reason.

A smaller uncertainty makes the worst case milder and so loosens the gate of safety, as a looser limit does: it needs a
written reason, which is reported with every verdict.
"""

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from thermicon.base.files.records import shipped_records

from .faults import KeyTable, Text, sentence
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


def _shipped_or(most: float, key: str) -> Any:
    """A share or K of 0 to `most`, the shipped one unless a rig file gives it."""
    return Field(default_factory=lambda: _shipped()[key], ge=0, le=most)


class Uncertainty(KeyTable):
    """Deviations of a rig from its file in either direction: shares, and K for ambient and heat sink.

    `conductance_relative` is that of the module's legs, `plates_relative` of both plates' heat capacities. `reason`
    states how it is known that an uncertainty is smaller than the shipped one.
    """

    contact_resistance_relative: float = _shipped_or(0.9, "contact_resistance_relative")
    ambient_K: float = _shipped_or(20, "ambient_K")
    gain_relative: float = _shipped_or(0.9, "gain_relative")
    heat_sink_K: float = _shipped_or(20, "heat_sink_K")
    seebeck_relative: float = _shipped_or(0.5, "seebeck_relative")
    conductance_relative: float = _shipped_or(0.5, "conductance_relative")
    plates_relative: float = _shipped_or(0.9, "plates_relative")
    reason: Annotated[Text, AfterValidator(str.strip)] = ""

    def faults(self) -> Iterator[str]:
        """One sentence for each uncertainty that is smaller than the shipped one without a reason."""
        for key, shipped in _shipped().items():
            value, unit = getattr(self, key), " K" if key.endswith("_K") else ""
            if value < shipped and not is_reason(self.reason):
                least = {"letters": SHORTEST_REASON, "words": FEWEST_WORDS}
                yield sentence("faults.surer", key=key, value=value, unit=unit, shipped=shipped, **least)


def tightened(uncertainty: Uncertainty) -> tuple[str, ...]:
    """A few words for each uncertainty that is smaller than shipped."""
    return tuple(
        f"{words} ±{scale * getattr(uncertainty, key):g} {unit} instead of ±{scale * _shipped()[key]:g} {unit}"
        for key, (words, _, scale, unit) in WORDS.items()
        if getattr(uncertainty, key) < _shipped()[key]
    )


def _shipped() -> dict[str, float]:
    return {record.quantity: record.central for record in shipped_records("uncertainty.toml")}
