"""Parts of a rig other than module or skin."""

import re
from dataclasses import dataclass

from .faults import sentence


@dataclass(frozen=True, slots=True)
class PassiveSink:
    """A heat sink in air: capacity J/K, resistance K/W, air °C; `steady` where a run begins in balance with that."""

    capacity_J_per_K: float
    air_resistance_K_per_W: float
    air_C: float
    steady: bool


@dataclass(frozen=True, slots=True)
class HeatSink:
    """The heat sink under the hot plate: temperature °C, thermal resistance to the hot plate K/W.

    Ideal (of constant temperature) unless it has a heat capacity and air that cools it.
    The temperature is that of the start where it is passive, and that of its air where it also starts in steady state.
    """

    temperature_C: float
    resistance_K_per_W: float
    passive: PassiveSink | None = None


@dataclass(frozen=True, slots=True)
class Driver:
    """The current source: gain A/V, current limits A, compliance voltage V, update rate Hz."""

    transconductance_A_per_V: float
    current_min_A: float
    current_max_A: float
    voltage_limit_V: float
    update_Hz: float

    def __post_init__(self) -> None:
        if not self.current_min_A <= 0 < self.current_max_A:
            raise ValueError(sentence("parts.driver", driver=self))


@dataclass(frozen=True, slots=True)
class Contact:
    """The contact between display and skin: area m², resistance m²·K/W."""

    area_m2: float
    resistance_m2K_per_W: float


@dataclass(frozen=True, slots=True)
class Probe:
    """A thermistor or a point of interest, at a place of `solver.probes`: depth in the skin m, lag s (first order)."""

    name: str
    place: str
    depth_m: float
    lag_s: float

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9_-]+", self.name):
            raise ValueError(sentence("parts.probe_name", name=self.name))
        if self.depth_m and self.place != "skin":
            raise ValueError(sentence("parts.probe_depth", probe=self, depth=self.depth_m * 1e3))
