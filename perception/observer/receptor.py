"""Constants of the receptors of one channel, and conduction from receptor to brain.

    delay = path/v_nerve + spine/v_spine, before the decision

Cold travels in myelinated fibres of the nerve and in a fast tract, warmth in unmyelinated fibres and a slow tract.
"""

from __future__ import annotations

from dataclasses import dataclass

from .channels import Channel


@dataclass(frozen=True, slots=True)
class Receptor:
    """Constants of one channel: times s, velocity m/s, exponents and factors 1.

    `limit_C` is the temperature above which there is no cold, or below which there is no warmth, and `softness_K` how
    gradually it sets in (None: no limit). `threshold_drive` is the drive that feels like a threshold, in K or W/m²,
    as the observer's variant has it. `forearm_factor` multiplies thresholds at sites of the forearm.
    `neutral_flux` (W/m² into the skin) bounds complete adaptation where heat flow is what is felt.
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


SPINE_M = 0.225
"""From the cord at the arm's segments to the brain, m; 0.2 to 0.25, assumed for an adult."""

SPINAL_M_PER_S: dict[Channel, float] = {"cold": 12.0, "warm": 2.0}
"""Leone et al. 2020, evoked potentials of healthy people; 1.4 and 2.5 m/s for warmth in a study of 2011."""

LEG_M_PER_S: dict[Channel, float] = {"cold": 2.1, "warm": 0.5}
"""Conduction at the leg (Fowler et al. 1988): what is used where the mechanism of delays is turned off."""


@dataclass(frozen=True, slots=True)
class Conduction:
    """Velocity in the nerve in m/s and path to the cord in m; `delay_s` adds the way from the cord to the brain.

    >>> round(Conduction("warm", 1.0, 0.55).delay_s, 4)
    0.6625
    """

    channel: Channel
    velocity_m_per_s: float
    path_m: float

    def __post_init__(self) -> None:
        if not self.velocity_m_per_s > 0.0 or not self.path_m > 0.0:
            raise ValueError(
                "conduction needs a velocity and a path above 0, "
                f"not {self.velocity_m_per_s:g} m/s over {self.path_m:g} m"
            )

    @property
    def delay_s(self) -> float:
        """Time from receptor to brain, s."""
        return self.path_m / self.velocity_m_per_s + SPINE_M / SPINAL_M_PER_S[self.channel]
