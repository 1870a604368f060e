"""From receptor to answer: conduction to the cord, from cord to brain, and decision.

    delay = path/v_nerve + spine/v_spine + decision

Cold travels in myelinated fibres of the nerve and in a fast tract, warmth in unmyelinated fibres and a slow tract.
"""

from __future__ import annotations

from dataclasses import dataclass

from .channels import Channel

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
