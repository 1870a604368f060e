"""Criterion: the change of sensation that is answered, and the noise that passes it too."""

from dataclasses import dataclass

from ..constants import constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Criterion(Mechanism):
    """Criteria in d′ of speeded answers and of questions without haste, and the correlation time of the noise."""

    equation = "rate = (φ(z) + z·Φ(z))/τ · φ(g)/Φ(g), z = τ·dψ/dt, g = c − ψ"
    source = "Rice's rate of crossings; no source of the criteria"
    criterion: float = constant("criterion of speeded answers")
    unhurried: float = constant("criterion of yes and no", task=True)
    caution_after_pulse: float = constant("caution after a pre-pulse", task=True)
    noise_correlation_s: float = constant("noise correlation time")
