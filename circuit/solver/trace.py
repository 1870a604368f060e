"""A trace: the result of one run as rows over time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.files.inputs import require_pyarrow
from thermicon.base.numbers.arrays import Array

from ..rig.rules import Limits
from .network import RECORDED

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from ..rig.rig import Rig


COLUMNS = ("icon", "time_s", "current_A", "voltage_V", "target_C", *RECORDED)
"""Columns of a trace file, in order."""

CSV_FORMAT = "%.9g"

CLOSE_K = 0.1
BRIEF_K = 0.25
BRIEF_S = 0.2
LAST_S = 2.0
"""A cue is reached within 0.1 K, or within 0.25 K for at most 0.2 s: a corner in a skin ramp saturates any driver."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Whether the controlled temperature reached its target, judged at the end of every driver period.

    Attributes
    ----------
    reached
        Whether it did.
    largest_miss_K, largest_miss_s
        Largest miss in K, positive above the target, and its time in s.
    rms_miss_K
        Root mean square of the misses in K.
    limits
        Limits that were met, each with the time in s at which it was first met.
    slowest_step_s
        Longest time in s that a step took; None where the cue has no step.
    late_s
        Times in s of steps that had not arrived when the level moved on, or at the end.

    Notes
    -----
    A step is as fast as the driver can make it: no miss is counted from its beginning until it arrives.

    Examples
    --------
    >>> print(Outcome(False, -1.2, 3.0, 0.4, (("current limit", 2.5),)).reason)
    misses its target by 1.20 K at 3.00 s, limited by the current limit from 2.50 s
    """

    reached: bool
    largest_miss_K: float
    largest_miss_s: float
    rms_miss_K: float
    limits: tuple[tuple[str, float], ...]
    slowest_step_s: float | None = None
    late_s: tuple[float, ...] = ()

    def __repr__(self) -> str:
        word = "reached" if self.reached else "NOT reached"
        return (
            f"Outcome({word}: largest miss {self.largest_miss_K:+.3g} K at {self.largest_miss_s:.2f} s, "
            f"rms {self.rms_miss_K:.3g} K)"
        )

    @property
    def reason(self) -> str | None:
        """Why the target was missed, in one sentence; None where it was reached."""
        if self.reached:
            return None
        limits = " and ".join(f"{name} from {start:.2f} s" for name, start in self.limits)
        late = f"; its step at {self.late_s[0]:.2f} s does not arrive in time" if self.late_s else ""
        return (
            f"misses its target by {abs(self.largest_miss_K):.2f} K at {self.largest_miss_s:.2f} s{late}"
            f"{f', limited by the {limits}' if limits else ''}"
        )


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Trace:
    """One run: temperatures, heat flow and current against time, as read-only arrays (rows,).

    Attributes
    ----------
    icon
        Name of the icon; None for a drive.
    rig_name, site
        Name of the rig, and the body site of its skin.
    area_m2
        Area of contact in m².
    driver_limits_A
        Least and greatest current of the driver in A.
    control
        What the cue prescribes: `skin`, `display` or `current`.
    outcome
        Whether the target was reached; None without a target temperature.
    warnings
        Sentences about the rig.
    beyond
        Sentences about a drive that exceeds the driver.
    time_s
        Times in s.
    current_A, voltage_V
        Current of the module in A, held from its row on, and voltage in V; NaN on a thermode.
    target_C
        Temperature in °C that the cue prescribes; NaN where it prescribes none.
    hot_plate_C
        Temperature of the hot plate in °C; NaN on a thermode.
    display_C, skin_C
        Temperature of the display and of the skin surface in °C.
    cold_receptor_C, warm_receptor_C
        Temperature at the depth of the cold and of the warm receptors in °C.
    heat_flow_skin_W_per_m2
        Heat flow into the skin surface in W/m².
    heat_flow_cold_receptor_W_per_m2, heat_flow_warm_receptor_W_per_m2
        Heat flow at the depth of the receptors in W/m², positive away from the surface.
    probes
        Name and temperature (rows,) in °C of every probe of the rig, in the order of its file.
    limits
        Limits of safety of the rig; None: the shipped ones.
    rig
        The rig, in whose skin an observer places its receptors; None: they are where the columns say.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> trace = simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))
    >>> trace.reachable, round(float(trace.skin_C.min()), 2)
    (True, 26.92)
    """

    icon: str | None
    rig_name: str
    site: str
    area_m2: float
    driver_limits_A: tuple[float, float]
    control: str
    outcome: Outcome | None
    warnings: tuple[str, ...]
    beyond: tuple[str, ...]
    time_s: Array
    current_A: Array
    voltage_V: Array
    target_C: Array
    hot_plate_C: Array
    display_C: Array
    skin_C: Array
    cold_receptor_C: Array
    warm_receptor_C: Array
    heat_flow_skin_W_per_m2: Array
    heat_flow_cold_receptor_W_per_m2: Array
    heat_flow_warm_receptor_W_per_m2: Array
    probes: tuple[tuple[str, Array], ...] = ()
    limits: Limits | None = None
    rig: Rig | None = None

    def __post_init__(self) -> None:
        for name, array in (*((name, getattr(self, name)) for name in COLUMNS[1:]), *self.probes):
            if array.shape != self.time_s.shape:
                raise ValueError(f"trace: {name} has {array.shape} values for {self.time_s.shape} times")
            array.setflags(write=False)

    def __repr__(self) -> str:
        notes = "" if self.outcome is None or self.outcome.reached else ", target missed"
        notes += ", beyond the driver" if self.beyond else ""
        drive = f"{self.current_A.min():.2f} … {self.current_A.max():.2f} A" if self.has_current else "a thermode"
        return (
            f"Trace({self.icon or 'drive'!r} on {self.rig_name}, {len(self.time_s)} rows, {self.time_s[-1]:g} s, "
            f"skin {self.skin_C.min():.2f} … {self.skin_C.max():.2f} °C, {drive}{notes})"
        )

    def _repr_html_(self) -> str:
        from .draw import svg_of

        return svg_of(self)

    @property
    def has_current(self) -> bool:
        """Whether a current produced it; False on a thermode, whose current, voltage and hot plate are NaN."""
        return not bool(np.isnan(self.current_A).all())

    @property
    def reachable(self) -> bool:
        """Whether the rig can play it: the target was reached, or the given current stays within the driver."""
        return not self.beyond if self.outcome is None else self.outcome.reached

    @property
    def reason(self) -> str | None:
        """Why the rig cannot play it, in one sentence; None where it can."""
        if self.outcome is not None:
            return self.outcome.reason
        return "; ".join(self.beyond) or None

    def probe(self, name: str) -> Array:
        """Temperature (rows,) in °C that a probe of the rig reads; raises KeyError with the probes there are."""
        for other, values in self.probes:
            if other == name:
                return values
        raise KeyError(f"no probe {name!r} in this trace; there is {', '.join(dict(self.probes)) or 'none'}")

    def to_frame(self) -> pd.DataFrame:
        """Return the trace as a table with the columns of a trace file, then one `probe_<name>_C` for each probe."""
        import pandas as pd

        columns: dict[str, Any] = {"icon": pd.Series([self.icon] * len(self.time_s), dtype="string")}
        columns.update({name: getattr(self, name) for name in COLUMNS[1:]})
        columns.update({f"probe_{name}_C": values for name, values in self.probes})
        return pd.DataFrame(columns)

    def to_csv(self, path: str | Path) -> None:
        """Write the table of `to_frame` as a CSV file, or as Parquet where the name ends in ``.parquet``."""
        write_trace(self, path)

    def plot(self, ax: Axes | None = None, probes: bool = False) -> Axes:
        """Draw target, display, skin and receptor temperatures against time, optionally probes; returns the Axes."""
        from .draw import plot_temperatures

        return plot_temperatures(self, ax, probes)


def of_rig(rig: Rig) -> dict[str, Any]:
    """What a trace has of its rig, by its attributes."""
    about = {"rig_name": rig.name, "site": rig.site, "area_m2": rig.contact.area_m2}
    return {**about, "warnings": rig.warnings, "limits": rig.limits, "rig": rig}


def write_trace(traces: Trace | list[Trace], path: str | Path) -> None:
    """Write traces to one table: Parquet where the name ends in ``.parquet``, else CSV; NaN is an empty cell."""
    import pandas as pd

    frames = [trace.to_frame() for trace in (traces if isinstance(traces, list) else [traces])]
    table = pd.concat(frames, ignore_index=True)
    if str(path).endswith(".parquet"):
        require_pyarrow(path)
        table.to_parquet(path, index=False)
    else:
        table.to_csv(path, index=False, float_format=CSV_FORMAT)


def judge(
    target_C: Array,
    reached_C: Array,
    period_s: float,
    limits: tuple[tuple[str, float], ...],
    steps_s: tuple[tuple[float, float], ...] = (),
) -> Outcome:
    """Outcome of targets and temperatures (periods,) at ends of periods; `steps_s`: when steps begin, and must end."""
    miss = reached_C - target_C
    close, counted = np.abs(miss) <= CLOSE_K, np.ones(len(miss), dtype=bool)
    ends, took, late = period_s * np.arange(1, len(miss) + 1), 0.0, []
    for begin, until in steps_s:
        window = np.flatnonzero((ends > begin + 1e-9) & (ends <= until + 1e-9))
        arrived = window[close[window]]
        counted[window[window < arrived[0]] if len(arrived) else window] = False
        if len(arrived):
            took = max(took, float(ends[arrived[0]]) - begin)
        elif len(window) and (math.isfinite(until) or ends[-1] - begin >= LAST_S):
            late.append(begin)
            counted[window[-1]] = True
        elif not len(window) and until < ends[-1]:  # it is over before the driver's next update
            late.append(begin)
    if not counted.any():
        return Outcome(not late, 0.0, 0.0, 0.0, limits, took, tuple(late))
    worst = int(np.argmax(np.where(counted, np.abs(miss), -1.0)))
    over = counted & ~close
    largest = float(miss[worst])
    reached = not over.any() or (abs(largest) <= BRIEF_K and float(over.sum()) * period_s <= BRIEF_S)
    rms = float(np.sqrt(np.mean(miss[counted] ** 2)))
    slowest = took if steps_s else None
    return Outcome(bool(reached and not late), largest, (worst + 1) * period_s, rms, limits, slowest, tuple(late))
