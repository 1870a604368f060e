"""The parts of a rig beside module and skin: heat sink, driver, contact, air."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class HeatSink:
    """What the hot plate sits on: temperature °C, resistance from the hot plate K/W."""

    temperature_C: float
    resistance_K_per_W: float


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
            raise ValueError(
                f"driver.current_min_A = {self.current_min_A:g} A: must be 0 (a drive that only cools) or below, "
                f"and current_limit_A ({self.current_max_A:g} A) above 0"
            )


@dataclass(frozen=True, slots=True)
class Contact:
    """Where display and skin meet: area m², resistance m²·K/W."""

    area_m2: float
    resistance_m2K_per_W: float


@dataclass(frozen=True, slots=True)
class Ambient:
    """The air that bare skin rests in: temperature °C, film W/(m²·K)."""

    temperature_C: float
    film_W_per_m2K: float
