"""What a cue feels like: two traces of sensation, and when and where it was first felt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from thermicon.perception.detection import channel_name, detect
from thermicon.perception.observer import Channel, Observer
from thermicon.perception.receptors import Array, receptor_drive
from thermicon.perception.sensation import sensation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.circuit import Trace


@dataclass(frozen=True, slots=True)
class Percept:
    """Sensation over time in d′ units, on the clock named by `clock`.

    The receptor clock starts with the cue and counts no conduction; `onset_s` is on the response
    clock (crossing + conduction + decision) and None where nothing was felt, like `channel`.
    """

    psi_cold: Array
    psi_warm: Array
    dt_s: float
    onset_s: float | None
    channel: Channel | None
    detected_probability: float
    icon: str | None = None
    clock: str = "receptor"

    def __post_init__(self) -> None:
        for name in ("psi_cold", "psi_warm"):
            own = np.array(getattr(self, name), dtype=np.float64)
            if own.ndim != 1 or not np.isfinite(own).all():
                raise ValueError(f"{name} must be one trace of finite numbers, not shape {own.shape}")
            own.setflags(write=False)
            object.__setattr__(self, name, own)
        if self.psi_cold.shape != self.psi_warm.shape:
            raise ValueError(f"psi_cold has {self.psi_cold.size} samples and psi_warm {self.psi_warm.size}")
        if not self.dt_s > 0.0:
            raise ValueError(f"dt_s = {self.dt_s:g} s must be above 0")

    @property
    def time_s(self) -> Array:
        """Clock of the traces, s."""
        clock: Array = self.dt_s * np.arange(self.psi_cold.size, dtype=np.float64)
        return clock

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw both sensations; returns the axes."""
        from thermicon.perception.draw import plot_sensation

        return plot_sensation(self, ax)

    def __repr__(self) -> str:
        felt = "not felt" if self.onset_s is None else f"felt at {self.onset_s:.2f} s by {self.channel}"
        return (
            f"Percept({self.icon or 'unnamed'}: {felt}, p {self.detected_probability:.3f}, "
            f"peaks cold {self.psi_cold.max():.3g} d′, warm {self.psi_warm.max():.3g} d′, "
            f"{self.time_s[-1]:.3g} s, {self.clock} clock)"
        )

    def _repr_html_(self) -> str:
        from thermicon.perception.draw import as_svg, plot_sensation

        return as_svg(plot_sensation(self, None))


def perceive(trace: Trace, observer: Observer | None = None, area_m2: float | None = None) -> Percept:
    """Percept of one simulated trace by a nominal person (or `observer`).

    `area_m2` is the trace's own area of contact unless given. The chain is receptor drive,
    sensation, detection.
    """
    person = Observer.load() if observer is None else observer
    area = trace.area_m2 if area_m2 is None else area_m2
    dt, rows = uniform_clock(trace.time_s)
    temperatures = trace.cold_receptor_C[:rows], trace.warm_receptor_C[:rows]
    cold, warm = perceive_many(*temperatures, dt, person, area_m2=area)
    found = detect(cold, warm, dt, person, path_m=person.path_m(trace.site))
    felt = float(found.onset_s)
    return Percept(
        psi_cold=cold,
        psi_warm=warm,
        dt_s=dt,
        onset_s=None if np.isnan(felt) else felt,
        channel=channel_name(int(found.channel)),
        detected_probability=float(found.probability),
        icon=trace.icon,
    )


def perceive_many(
    cold_receptor_C: ArrayLike,
    warm_receptor_C: ArrayLike,
    dt_s: float,
    observer: Observer,
    *,
    area_m2: float | None = None,
    threshold_cold: ArrayLike = 1.0,
    threshold_warm: ArrayLike = 1.0,
) -> tuple[Array, Array]:
    """Sensations (cold, warm) of many traces, shape (..., n_time) like the temperatures.

    The threshold multipliers are one number or one for each leading index.
    """
    cold_drive = receptor_drive(cold_receptor_C, dt_s, "cold", observer)
    warm_drive = receptor_drive(warm_receptor_C, dt_s, "warm", observer)
    cold = sensation(cold_drive, "cold", observer, area_m2=area_m2, threshold=threshold_cold)
    warm = sensation(warm_drive, "warm", observer, area_m2=area_m2, threshold=threshold_warm)
    return cold, warm


def uniform_clock(time_s: ArrayLike) -> tuple[float, int]:
    """Step (s) of a uniform clock and how many rows it has; a shorter last step is left off.

    >>> uniform_clock([0.0, 0.5, 1.0, 1.2])
    (0.5, 3)
    """
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
