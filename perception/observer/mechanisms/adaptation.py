"""Adaptation: a level that follows what receptors receive, inside the neutral zone."""

from dataclasses import dataclass

from ..channels import Channel
from ..constants import Both, constant
from .limits import Limits


@dataclass(frozen=True, kw_only=True)
class Adaptation(Limits):
    """Drive is what exceeds a level that follows slowly; outside the neutral zone a hold keeps a residue."""

    equation = "dq_i/dt = (q − q_i)/τ_i, dA/dt = (clip(q) − A)/τ_s, drive = max(0, s·(q_i − A))"
    source = "Shani & Lineykin 2021 (neutral zone); Kenshalo, Holmes & Wood 1968"
    integration_s: float = constant("integration time")
    adaptation_s: float = constant("slow adaptation time")
    neutral_C: tuple[float, float] = constant("neutral zone", span=True)
    neutral_flux: Both[tuple[float, float]] | None = constant(
        "{} neutral heat flow", span=True, only="heat flow", default=None
    )

    def neutral(self, channel: Channel) -> tuple[float, float]:
        """Range of complete adaptation, in °C or, where heat flow is felt, in W/m² into the skin."""
        if self.variable == "temperature" or self.neutral_flux is None:
            return self.neutral_C
        return self.neutral_flux.of(channel)
