"""Bounds of quality: temperatures beyond which there is no cold or no warmth."""

from dataclasses import dataclass

from ..constants import ANY, Both, constant
from .mechanism import Mechanism

NO_LIMIT_C = Both(1e6, -1e6)
"""So far away that limits do nothing, as where heat flow is felt."""


@dataclass(frozen=True, kw_only=True)
class Bounds(Mechanism):
    """Hardly any cold above its limit, no warmth below its own: from 36 back to 34 °C is less warm, not cold."""

    equation = "q = L + s·δ·ln(1 + e^(s·(T − L)/δ))"
    source = "Campero et al. 2001 for cold; Konietzny & Hensel 1977 for warmth"
    limit_C: Both[float] = constant("{} limit", ANY, only="temperature", default=NO_LIMIT_C)
    softness_K: float = constant("softness of the limits")
