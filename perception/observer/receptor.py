"""Constants of the receptors of one channel."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Receptor:
    """Constants of one channel: times s, velocity m/s, exponents and factors 1.

    `limit_C` is the temperature above which there is no cold, or below which there is no warmth, and `softness_K` how
    gradually it sets in (None: no limit). `threshold_drive` is the drive that feels like a threshold, in K or W/m²,
    as the observer's variant has it. `forearm_factor` multiplies thresholds at sites of the forearm.
    `neutral_flux` (W/m² into the skin) bounds complete adaptation where heat flow is what is felt;
    """

    adaptation_s: float
    threshold_drive: float
    velocity_m_per_s: float
    area_exponent: float
    limit_C: float | None = None
    softness_K: float = 0.5
    forearm_factor: float = 1.0
    neutral_flux: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("adaptation_s", "threshold_drive", "velocity_m_per_s", "softness_K", "forearm_factor"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} = {getattr(self, name):g} must be above 0")
        if self.neutral_flux is not None and not self.neutral_flux[0] < self.neutral_flux[1]:
            raise ValueError(
                f"the neutral heat flow {self.neutral_flux[0]:g} to {self.neutral_flux[1]:g} W/m² is empty"
            )
