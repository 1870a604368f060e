"""Figure 6b of the source paper: temperature inside the dermis, beside the thermistor on insulated skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from .depths import probe_depths
from .paper import TAIL_S, cooling_step, dermis_change, emulator_rig, printed, thermistors


@dataclass(frozen=True, slots=True)
class DermisCourse:
    """Changes in K at depths in m, (depths, n_time), and of the thermistor on insulated skin, (n_time,); time in s."""

    rig_name: str
    time_s: Array
    depth_m: Array
    change_K: Array
    insulated_K: Array


def dermis_course() -> DermisCourse:
    """Play the cue on the skin and follow receptor depths, and the depth that changes as much as the paper says."""
    rig = emulator_rig()
    dermis = dermis_change(rig)
    depths_m = (*dermis.receptor_m, dermis.depth_of_m(printed().one("dermis change").central))
    at_C, trace = probe_depths(cooling_step("skin"), rig, depths_m, tail_s=TAIL_S)
    third = thermistors(rig).trace.probe("3")
    return DermisCourse(rig.name, trace.time_s, np.array(depths_m), at_C - at_C[:, :1], third - third[0])
