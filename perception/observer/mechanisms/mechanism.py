"""A mechanism: constants with the stages of the chain that they act on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..channels import Channel, Variable


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """Part of an observer. Its docstring says what it does; fields that `constant` declares name their priors.

    `equation` is what it computes, `source` where it comes from. A stage of the chain is a method: one that a mechanism
    overrides goes on from `super()`, so that mechanisms of one stage act one after the other.
    """

    equation: ClassVar[str] = ""
    source: ClassVar[str] = ""
    variable: Variable = "temperature"

    def sensitivity(self, channel: Channel, area_m2: float | None, site: str | None) -> float:
        """Sensitivity relative to the hand at the reference area; None: that area, or the hand."""
        return 1.0
