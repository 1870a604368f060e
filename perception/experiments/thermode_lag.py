"""How far the surface of a thermode stays behind its set-points: lag on both flanks of a triangle, and its best shift.

A device and not perception; but every reaction time and every limit is read from a clock that this lag belongs to.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..sensation.bench import Bench

if TYPE_CHECKING:
    from thermicon.circuit import Rig

PROCEDURE = "thermode lag"
STEADY = 0.5
"""The second half of a flank, by which a first-order lag has settled."""
SHIFTS_S = np.arange(0.0, 1.0, 0.005)
SHIFTS_S.setflags(write=False)


@dataclass(frozen=True, slots=True)
class ThermodeLag:
    """Lag of a thermode on a triangle of set-points.

    Attributes
    ----------
    rig_name
        The rig.
    rate_K_per_s
        Rate of both flanks, K/s.
    rising_s, falling_s
        Set-point minus surface, over the rate, on the steady part of each flank, s.
    best_shift_s
        The one delay of the set-points that comes nearest the surface, s.
    rms_K, largest_K
        What is left after that delay, and the largest difference without it, K.

    See Also
    --------
    thermode_lag : plays a triangle on a thermode.

    """

    rig_name: str
    rate_K_per_s: float
    rising_s: float
    falling_s: float
    best_shift_s: float
    rms_K: float
    largest_K: float

    @property
    def offset_free_s(self) -> float:
        """Mean of both flanks, s: a constant error of the surface cancels."""
        return 0.5 * (self.rising_s + self.falling_s)

    @property
    def offset_K(self) -> float:
        """Mean error of the surface that makes the two flanks differ, K."""
        return 0.5 * (self.falling_s - self.rising_s) * self.rate_K_per_s

    def __repr__(self) -> str:
        return (
            f"ThermodeLag({self.rig_name} at {self.rate_K_per_s:g} K/s: {self.rising_s:.3f} s rising, "
            f"{self.falling_s:.3f} s falling, best shift {self.best_shift_s:.3f} s, rms {self.rms_K:.3f} K)"
        )


def thermode_lag(rig: Rig, *, rate_K_per_s: float = 2.5, size_K: float = 10.0, baseline_C: float = 30.0) -> ThermodeLag:
    """Play a triangle of set-points on a thermode and measure how far its surface stays behind.

    Parameters
    ----------
    rig
        A rig with a thermode.
    rate_K_per_s
        Rate of both flanks, K/s.
    size_K
        Height of the triangle, K.
    baseline_C
        Where it starts and ends, °C.

    Returns
    -------
    ThermodeLag
        Lags of both flanks and of the whole.

    Raises
    ------
    ValueError
        For a rig without a thermode, or a triangle too short for the lag to settle.

    Notes
    -----
    After E7 of the evidence, where a TCS II had offset-free lags of 0.22 s at 2.5 K/s and 0.32 s at 0.875 K/s, 0.1 s
    of the latter being the order of logging. Readings there are truncated to 0.1 K, which makes the flanks differ.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> lag = thermode_lag(Rig.load("tcs2"))
    >>> round(lag.rising_s, 2), round(lag.falling_s, 2)
    (0.21, 0.21)

    """
    if rig.thermode is None:
        raise ValueError(
            f"{PROCEDURE}: rig {rig.name} has no [thermode], whose lag is asked for: use a rig with one, such as tcs2"
        )
    flank_s = size_K / rate_K_per_s
    if flank_s < 10.0 * rig.thermode.lag_s:
        raise ValueError(
            f"{PROCEDURE}: flanks of {flank_s:.3g} s are too short for a lag of {rig.thermode.lag_s:g} s to settle: "
            f"raise size_K to {10.0 * rig.thermode.lag_s * rate_K_per_s:.3g} K or more"
        )
    bench = Bench(rig, baseline_C, "display")
    course = f"warm by {size_K:.9g} K at {rate_K_per_s:.9g} K/s; return at {rate_K_per_s:.9g} K/s"
    played = bench.play([course], np.ceil(100.0 * (2.0 * flank_s + 2.0)) / 100.0)
    time, surface = played.time_s, played.surface_C("display")[0]
    command = np.interp(time, [0.0, flank_s, 2.0 * flank_s], [baseline_C, baseline_C + size_K, baseline_C])
    behind = command - surface
    rising = float(behind[_steady(time, 0.0, flank_s)].mean()) / rate_K_per_s
    falling = -float(behind[_steady(time, flank_s, 2.0 * flank_s)].mean()) / rate_K_per_s
    rms = [float(np.sqrt(np.mean((np.interp(time - shift, time, command) - surface) ** 2))) for shift in SHIFTS_S]
    best = int(np.argmin(rms))
    largest = float(np.abs(behind).max())
    return ThermodeLag(rig.name, rate_K_per_s, rising, falling, float(SHIFTS_S[best]), rms[best], largest)


def _steady(time: Array, start_s: float, end_s: float) -> NDArray[np.bool_]:
    """Rows in the last part of a flank."""
    rows: NDArray[np.bool_] = (time >= start_s + STEADY * (end_s - start_s)) & (time <= end_s)
    return rows
