"""Skin under a thermode: where receptors lie, the contact, and the effusivity of living tissue."""

from dataclasses import dataclass

from ..constants import Both, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Skin(Mechanism):
    """Skin of laboratories: depth of receptors below the stratum corneum, contact, effusivity. Rigs have their own."""

    equation = "depth = stratum corneum + own depth; √(kρc) of living layers × effusivity"
    source = "Ho 2018 for depths; Ho & Jones for contact; contact with glass (1957) for effusivity"
    depth_m: Both[float] = constant("{} receptor depth", scale=1e-3, task=True)
    contact_m2K_per_W: float = constant("contact resistance of a thermode", task=True)
    effusivity: float = constant("effusivity of living skin", task=True)

    def depths_m(self, corneum_m: float) -> Both[float]:
        """Depths of the receptors below the face of skin with a stratum corneum so thick."""
        return Both(corneum_m + self.depth_m.cold, corneum_m + self.depth_m.warm)
