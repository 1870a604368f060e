"""Thermal exposure of tissue: equivalent minutes at 43 °C, and the Henriques burn integral.

Temperature is taken as linear between rows. CEM43 is then exact. The Henriques rate over one row is expanded about its
middle; rows that differ by more than 0.05 K are cut into pieces that do not: under 1e-8 of the integral is lost.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import resources

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..records import load_records

_KEPT = ("CEM43 start", "CEM43 reference", "CEM43 base at or above 43 °C", "CEM43 base from 37 to 43 °C")


@cache
def constants() -> Array:
    """Constants of both measures in the order that the kernels expect (6,)."""
    table = load_records(resources.files("thermicon.circuit") / "data" / "exposure.toml")
    known = {record.quantity: record.central for record in table}
    factor, activation_K = (
        known["Henriques pre-exponential"],
        known["Henriques activation energy"] / known["gas constant"],
    )
    values = np.array([*(known[name] for name in _KEPT), np.log(factor), activation_K])
    values.setflags(write=False)
    return values


def cem43_min(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """Cumulative thermal dose (…, rows) in equivalent minutes at 43 °C, of temperatures (…, rows) in °C at times in s.

    CEM43 = ∫ R^(43 − T) dt with R = 0.5 from 43 °C on, 0.25 from 37 to 43 °C, and 0 below; source: Sapareto and Dewey
    1984, in `circuit/data/exposure.toml`.

    >>> cem43_min([0, 60, 120], [43, 43, 43]).tolist()
    [0.0, 1.0, 2.0]
    >>> round(float(cem43_min([0, 60], [42, 42])[-1]), 9)
    0.25
    """
    from .tally_kernel import fill_doses

    return _integral(fill_doses, time_s, temperature_C)


def henriques(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """Cumulative burn integral Ω (…, rows) of temperatures (…, rows) in °C; a first-degree burn begins at 0.53.

    Ω = ∫ A·exp(−Ea/(R·T)) dt with the absolute temperature T (Henriques and Moritz 1947), in
    `circuit/data/exposure.toml`.

    >>> round(float(henriques([0, 600], [44, 44])[-1]), 3)
    0.007
    """
    from .tally_kernel import fill_burns

    return _integral(fill_burns, time_s, temperature_C)


def _integral(fill: Callable[..., None], time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """An integral over time of every lane of temperatures (…, rows), as the kernel `fill` fills it."""
    time, warm = _fitting(time_s, temperature_C)
    total = np.zeros(warm.shape)
    if len(time):
        lanes = np.array(warm).reshape(-1, len(time))  # a kernel is compiled once more for what is read-only
        fill(np.array(time), lanes, constants(), total.reshape(-1, len(time)))
    return total


def _fitting(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> tuple[Array, Array]:
    time, warm = np.asarray(time_s, dtype=np.float64), np.asarray(temperature_C, dtype=np.float64)
    if time.ndim != 1 or warm.ndim < 1 or warm.shape[-1] != len(time):
        raise ValueError(f"exposure: {warm.shape} temperatures do not fit {time.shape} times; the last axis is time")
    if len(time) > 1 and not (np.diff(time) > 0).all():
        raise ValueError("exposure: times must increase")
    if not np.isfinite(warm).all():
        raise ValueError("exposure: temperatures must be finite numbers in °C")
    return time, warm
