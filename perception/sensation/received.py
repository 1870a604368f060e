"""The input of an observer's receptors in a trace."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import CHANNELS, receptor_column
from ..observer.constants import Both
from ..observer.observer import Observer

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from thermicon.circuit import Trace


def received(trace: Trace, observer: Observer) -> Both[Array]:
    """Receptor input (rows,), cold and warm, on the uniform clock of the trace: °C, or W/m² into the skin.

    The trace begins steady, and its skin is linear: its display alone decides, unless a rig places its receptors.
    """
    from thermicon.circuit.solver.modes import thermode_modes

    dt_s, rows = uniform_clock(trace.time_s)
    if trace.rig is None or trace.rig.skin.own:
        return Both(*(getattr(trace, receptor_column(observer.variable, channel))[:rows] for channel in CHANNELS))
    rig, display_C = trace.rig, trace.display_C[:rows]
    depths_m = observer.depths_m(rig.skin.corneum_m)
    skin = thermode_modes(rig, tuple(depths_m), rig.contact.resistance_m2K_per_W)
    which = (0, 1) if observer.variable == "temperature" else (2, 3)
    return Both(*skin.run(display_C, dt_s, skin.steady(float(display_C[0])), which)[0])


def uniform_clock(time_s: ArrayLike) -> tuple[float, int]:
    """Step (s) of a uniform clock and how many rows it has; a shorter last step is left off."""
    clock = np.asarray(time_s, dtype=np.float64)
    if clock.size < 2:
        raise ValueError("a percept needs a trace of at least two rows")
    rows = clock.size
    if rows > 2 and clock[-1] - clock[-2] < (clock[1] - clock[0]) * (1.0 - 1e-6):
        rows -= 1
    dt = float(clock[rows - 1] - clock[0]) / (rows - 1)
    if not np.allclose(np.diff(clock[:rows]), dt, rtol=1e-6, atol=1e-9):
        raise ValueError("a percept needs a uniform clock: simulate at one rate (rate_Hz)")
    return dt, rows
