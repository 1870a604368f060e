"""Figure 6b of the source paper: temperature inside the dermis, beside the thermistor on insulated skin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.arrays import Array
from thermicon.circuit.rig.rig import Rig

from .depths import probe_depths
from .paper import TAIL_S, cooling_step, dermis_change, emulator_rig, printed, thermistors

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class DermisCourse:
    """Changes in K at depths in m, (depths, n_time), and of the thermistor on insulated skin, (n_time,); time in s.

    The last depth is the one at which the change is that in the paper's text.
    """

    rig_name: str
    time_s: Array
    depth_m: Array
    change_K: Array
    insulated_K: Array

    def __repr__(self) -> str:
        largest = np.abs(self.change_K).max(axis=1)
        pairs = ", ".join(f"{k:.1f} K at {1e3 * d:.2f} mm" for d, k in zip(self.depth_m, largest, strict=True))
        return f"DermisCourse({self.rig_name}; {pairs})"

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the change at every depth and of the insulated thermistor against time; returns the Axes."""
        from .studydraw import plot_dermis_course

        return plot_dermis_course(self, ax)


def dermis_course(rig: Rig | None = None, depths_m: Sequence[float] | None = None) -> DermisCourse:
    """Play the cue on the skin and follow both receptor depths, and the depth that changes as much as the paper says.

    Without a rig it is that of the paper with its limits lifted.
    """
    rig = emulator_rig() if rig is None else rig
    if depths_m is None:
        dermis = dermis_change(rig)
        depths_m = (*dermis.receptor_m, dermis.depth_of_m(printed().one("dermis change").central))
    run = probe_depths(cooling_step("skin"), rig, depths_m, tail_s=TAIL_S)
    away = run.temperature_C - run.temperature_C[:, :1]
    third = thermistors(rig).trace.probe("3")
    return DermisCourse(rig.name, run.trace.time_s, np.array(depths_m), away, third - third[0])
