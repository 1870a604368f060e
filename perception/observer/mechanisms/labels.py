"""Labels: occasional reports of cold as warm."""

import math
from dataclasses import dataclass

from thermicon.base.numbers.arrays import Array

from ..channels import Channel
from ..constants import SHARE, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Labels(Mechanism):
    """Share of wrong names of a cooling, at rest and after warmth."""

    equation = "wrong + (½ − wrong)·(1 − e^(−lingering · ψ_warm))"
    source = "no source: names of a cooling after a warm pulse ask for it"
    wrong_labels: float = constant("wrong labels", SHARE, task=True)
    lingering: float = constant("warmth that lingers", task=True)

    def called_warm(self, psi_warm: float) -> float:
        """Share of coolings that are called warm, after warmth of so many d′."""
        return self.wrong_labels + (0.5 - self.wrong_labels) * -math.expm1(-self.lingering * psi_warm)

    def mislabelled(self, channel: Channel, mistaken: Array, psi_warm: float) -> Array:
        """Shares of wrong names of a channel of which these shares are taken for the other."""
        renamed = self.called_warm(psi_warm)
        return mistaken * (1.0 - renamed) + (renamed if channel == "cold" else 0.0)
