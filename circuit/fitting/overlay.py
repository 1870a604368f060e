"""A measured log laid beside a simulated trace, on the trace's clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..solver.trace import Trace
from .alignment import best_shift_s
from .log import Log, LogError

if TYPE_CHECKING:
    import pandas as pd

SHIFTED_BY = ("display_C", "skin_C", "voltage_V", "current_A", "hot_plate_C")
"""Columns that a shift is found from, the best first."""


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """One column beside a simulation: `time_s` on its clock, `measured` and `simulated` (rows,)."""

    column: str
    time_s: Array
    measured: Array
    simulated: Array

    @property
    def difference(self) -> Array:
        """Measured minus simulated (rows,)."""
        return self.measured - self.simulated

    @property
    def rms(self) -> float:
        """Root mean square of the differences."""
        return float(np.sqrt(np.mean(self.difference**2)))

    @property
    def largest(self) -> float:
        """The difference of largest size, with its sign."""
        return float(self.difference[int(np.argmax(np.abs(self.difference)))])

    @property
    def largest_s(self) -> float:
        """Time in s of the largest difference."""
        return float(self.time_s[int(np.argmax(np.abs(self.difference)))])


@dataclass(frozen=True, slots=True, eq=False)
class Overlay:
    """A log beside a trace.

    Attributes
    ----------
    name
        Name of the log.
    shift_s
        What was added to its times, in s.
    columns
        Every column that both have.
    """

    name: str
    shift_s: float
    columns: tuple[Beside, ...]

    def __repr__(self) -> str:
        parts = [f"{item.column} rms {item.rms:.2g}, largest {item.largest:+.2g}" for item in self.columns]
        return f"Overlay({self.name!r}, shifted by {self.shift_s:.3f} s: {'; '.join(parts)})"

    def to_frame(self) -> pd.DataFrame:
        """Return one row per column: rms and largest difference measured − simulated, and where it is in s."""
        import pandas as pd

        return pd.DataFrame(
            [{"column": c.column, "rms": c.rms, "largest": c.largest, "largest_s": c.largest_s} for c in self.columns]
        )


def overlay(trace: Trace, log: Log, *, shift_s: float | None = None) -> Overlay:
    """Lay a log beside a trace.

    Parameters
    ----------
    trace
        The simulation.
    log
        What was measured.
    shift_s
        What to add to the log's times in s; None: what makes both most alike, by cross-correlation.

    Returns
    -------
    Overlay
        Shift, and measured beside simulated for every column that both have.

    Raises
    ------
    LogError
        Where they have no column or no time in common.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.circuit.fitting.laboratory import calibration_icon, synthetic_log
    >>> rig = Rig.load("thenar")
    >>> overlay(simulate(calibration_icon(), rig), synthetic_log(rig, seed=1, columns=["display_C"]))
    Overlay('synthetic.csv', shifted by ... s: current_A rms ..., largest ...; display_C rms ..., largest ...)
    """
    simulated = {name: getattr(trace, name) for name in SHIFTED_BY} | {f"probe_{n}_C": v for n, v in trace.probes}
    common = [name for name, _ in log.columns if name in simulated and np.isfinite(simulated[name]).any()]
    if not common:
        raise LogError(
            f"{log.name}: no column in common with the trace of {trace.icon or 'the drive'}; the log has "
            f"{', '.join(dict(log.columns))}"
        )
    if shift_s is None:
        lead = min(common, key=lambda name: SHIFTED_BY.index(name) if name in SHIFTED_BY else len(SHIFTED_BY))
        shift_s = best_shift_s(trace.time_s, simulated[lead], log.time_s, log.column(lead))[0]
    time = log.time_s + shift_s
    inside = (time >= trace.time_s[0] - 1e-9) & (time <= trace.time_s[-1] + 1e-9)
    columns = []
    for name in common:
        rows = inside & np.isfinite(log.column(name))
        if rows.sum() > 1:
            expected = np.interp(time[rows], trace.time_s, simulated[name])
            columns.append(Beside(name, time[rows], log.column(name)[rows], expected))
    if not columns:
        raise LogError(
            f"{log.name}: no row at a time of the trace, {trace.time_s[0]:g} to {trace.time_s[-1]:g} s, with a shift "
            f"of {shift_s:g} s; check time_s"
        )
    return Overlay(log.name, float(shift_s), tuple(columns))
