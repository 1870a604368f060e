"""Tissue: the skin between display and receptors."""

from dataclasses import dataclass

from ..constants import SHARE, Both, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Tissue(Mechanism):
    """Depth of receptors, by one rule at every site; contact and effusivity of laboratories: rigs have their own."""

    equation = "depth = share · stratum corneum + own depth; √(kρc) of living layers × effusivity"
    source = "Ho 2018 for depths; Ho & Jones for contact; contact with glass (1957) for effusivity"
    corneum_share: float = constant("share of the stratum corneum that counts", SHARE)
    depth_m: Both[float] = constant("{} receptor depth", scale=1e-3, task=True)
    contact_m2K_per_W: float = constant("contact resistance of a thermode", task=True)
    effusivity: float = constant("effusivity of living skin", task=True)

    def depths_m(self, corneum_m: float) -> Both[float]:
        """Depths of the receptors below the face of skin with a stratum corneum so thick."""
        above_m = self.corneum_share * corneum_m
        return Both(above_m + self.depth_m.cold, above_m + self.depth_m.warm)
