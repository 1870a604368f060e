"""Thermal exposure of tissue.

Temperature is taken as linear between rows. CEM43 is then exact. The Henriques rate over one row is expanded about its
middle; rows that differ by more than 0.05 K are cut into pieces that do not: under 1e-8 of the integral is lost.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from thermicon.base.files.records import shipped_records
from thermicon.base.numbers.arrays import Array

_KEPT = ("CEM43 start", "CEM43 reference", "CEM43 base at or above 43 °C", "CEM43 base from 37 to 43 °C")


def constants() -> Array:
    """Constants of both measures in the order that the kernels expect (6,)."""
    known = {record.quantity: record.central for record in shipped_records("exposure.toml")}
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
    from .tally_kernel import fill_dose

    return _integral(fill_dose, time_s, temperature_C)


def cem43_per_min(temperature_C: Array) -> Array:
    """Thermal dose in equivalent minutes at 43 °C that a minute at temperatures in °C adds.

    >>> cem43_per_min(np.array([36.0, 42.0, 43.0, 44.0])).tolist()
    [0.0, 0.25, 1.0, 2.0]
    """
    start_C, reference_C, base_above, base_below = constants()[: len(_KEPT)]
    base = np.where(temperature_C < reference_C, base_below, base_above)
    return np.where(temperature_C < start_C, 0.0, base ** (reference_C - temperature_C))


def henriques(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """Cumulative burn integral Ω (…, rows) of temperatures (…, rows) in °C; a first-degree burn begins at 0.53.

    Ω = ∫ A·exp(−Ea/(R·T)) dt with the absolute temperature T (Henriques and Moritz 1947), in
    `circuit/data/exposure.toml`.

    >>> round(float(henriques([0, 600], [44, 44])[-1]), 3)
    0.007
    """
    from .tally_kernel import fill_burn

    return _integral(fill_burn, time_s, temperature_C)


def _integral(fill: Callable[..., None], time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """An integral over time of every lane of temperatures (…, rows), as the kernel `fill` fills it."""
    time, warm = np.array(time_s, dtype=np.float64), np.array(temperature_C, dtype=np.float64)
    total = np.zeros(warm.shape)
    for lane, filled in zip(warm.reshape(-1, len(time)), total.reshape(-1, len(time)), strict=True):
        fill(time, lane, constants(), filled)
    return total
