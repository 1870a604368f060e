"""Conduction from the receptor to the brain."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array

from ..channels import Channel
from ..constants import Both, constant
from .mechanism import Mechanism
from .site import on_forearm

SPINE_M = 0.225
"""From the cord at the arm's segments to the brain, m; 0.2 to 0.25, assumed for an adult."""
SPINAL_M_PER_S: Both[float] = Both(12.0, 2.0)
"""Leone et al. 2020, evoked potentials of healthy people; 1.4 and 2.5 m/s for warmth in a study of 2011."""


@dataclass(frozen=True, kw_only=True)
class Conduction(Mechanism):
    """Cold travels in myelinated fibres of the nerve and a fast tract, warmth in unmyelinated fibres and a slow one."""

    equation = "delay = path/v + spine/v_spine"
    source = "Hensel & Iggo 1971; Leone et al. 2020 for the spine"
    velocity_m_per_s: Both[float] = constant("{} conduction velocity")
    path_hand_m: float = constant("path of the hand", site="hand")
    path_forearm_m: float = constant("path of the forearm", site="forearm")

    def path_m(self, site: str) -> float:
        """Path to the cord, m: forearm sites have their own, every other site has the hand's."""
        return self.path_forearm_m if on_forearm(site) else self.path_hand_m

    def delay_s(self, channel: Channel, path_m: ArrayLike) -> Array:
        """Time (s) from the receptor over a nerve path to the cord (m), and from there to the brain."""
        nerve = np.asarray(path_m, dtype=np.float64) / self.velocity_m_per_s.of(channel)
        return np.asarray(nerve + SPINE_M / SPINAL_M_PER_S.of(channel))
