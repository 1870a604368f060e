"""Gain: the drive that feels like a threshold."""

from dataclasses import dataclass

from ..constants import FROM_0, Both, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Gain(Mechanism):
    """Multiples of threshold per unit of drive; a gain for each presentation widens the psychometric function."""

    equation = "u = drive · sensitivity / threshold drive · e^(gain noise · z)"
    source = "no source: scatter of repeated thresholds and ratings asks for it"
    threshold_drive: Both[float] = constant("{} threshold drive")
    gain_noise: float = constant("gain noise", FROM_0)
