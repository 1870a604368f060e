"""Thermal exposure of tissue: equivalent minutes at 43 °C, and the Henriques burn integral.

Temperature is taken as linear between rows. CEM43 is then exact. The Henriques rate over one row is expanded about its
middle; rows that differ by more than 0.05 K are cut into pieces that do not: under 1e-8 of the integral is lost.
"""

from __future__ import annotations

from functools import cache
from importlib import resources

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..records import load_records
from ..rig.module import ZERO_C_IN_K

LEVEL_K = 1e-5
"""Rows closer than this count as level, since a difference of primitives would be rounding noise."""

SMALL_K = 0.05
"""The longest piece of a ramp over which the Henriques rate is expanded about its middle."""


@cache
def _constants() -> dict[str, float]:
    table = load_records(resources.files("thermicon.circuit") / "data" / "exposure.toml")
    return {record.quantity: record.central for record in table}


def cem43_min(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """Return the cumulative thermal dose in equivalent minutes at 43 °C.

    Parameters
    ----------
    time_s
        Times (rows,) in s, increasing.
    temperature_C
        Temperatures (…, rows) in °C.

    Returns
    -------
    Array
        Dose (…, rows) in min, from 0 at the first row.

    Raises
    ------
    ValueError
        Where times and temperatures do not match, times do not increase, or temperatures are not finite.

    Notes
    -----
    CEM43 = ∫ R^(43 − T) dt with R = 0.5 from 43 °C on, 0.25 from 37 to 43 °C, and 0 below; source: Sapareto and
    Dewey 1984, in `circuit/data/exposure.toml`.

    Examples
    --------
    >>> cem43_min([0, 60, 120], [43, 43, 43]).tolist()
    [0.0, 1.0, 2.0]
    >>> round(float(cem43_min([0, 60], [42, 42])[-1]), 9)
    0.25
    """
    time, warm = _fitting(time_s, temperature_C)
    if warm.size and warm.max() < _constants()["CEM43 start"]:
        return np.zeros_like(warm)
    begin, rise = warm[..., :-1], np.diff(warm, axis=-1)
    level = np.abs(rise) < LEVEL_K
    per_s = np.where(
        level,
        _cem43_rate(begin + 0.5 * rise),
        (_cem43_primitive(warm[..., 1:]) - _cem43_primitive(begin)) / np.where(level, 1.0, rise),
    )
    return _summed(per_s * np.diff(time) / 60.0)


def henriques(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> Array:
    """Return the cumulative burn integral Ω.

    Parameters
    ----------
    time_s
        Times (rows,) in s, increasing.
    temperature_C
        Temperatures (…, rows) in °C.

    Returns
    -------
    Array
        Ω (…, rows), from 0 at the first row; a first-degree burn begins at 0.53.

    Raises
    ------
    ValueError
        Where times and temperatures do not match, times do not increase, or temperatures are not finite.

    Notes
    -----
    Ω = ∫ A·exp(−Ea/(R·T)) dt with the absolute temperature T (Henriques and Moritz 1947), see
    `circuit/data/exposure.toml`.

    Examples
    --------
    >>> round(float(henriques([0, 600], [44, 44])[-1]), 3)
    0.007
    """
    time, warm = _fitting(time_s, temperature_C)
    rise, steps = np.diff(warm, axis=-1), np.diff(time)
    middle = warm[..., :-1] + 0.5 * rise
    per_s = _expanded(middle, rise)
    pieces = np.ceil(np.abs(rise) / SMALL_K).astype(np.int64)
    for count in np.unique(pieces[pieces > 1]).tolist():
        at = pieces == count
        whole = rise[at][:, np.newaxis]
        inside = middle[at][:, np.newaxis] + whole * ((np.arange(count) + 0.5) / count - 0.5)
        per_s[at] = _expanded(inside, np.broadcast_to(whole / count, inside.shape)).mean(axis=1)
    return _summed(per_s * steps)


def _cem43_rate(warm: Array) -> Array:
    known = _constants()
    base = np.where(
        warm >= known["CEM43 reference"],
        known["CEM43 base at or above 43 °C"],
        known["CEM43 base from 37 to 43 °C"],
    )
    rate: Array = np.where(warm < known["CEM43 start"], 0.0, base ** (known["CEM43 reference"] - warm))
    return rate


def _cem43_primitive(warm: Array) -> Array:
    """Integral of the rate over temperature from far below: what a ramp of 1 K/s gives, in s."""
    known = _constants()
    reference, start = known["CEM43 reference"], known["CEM43 start"]
    high, low = known["CEM43 base at or above 43 °C"], known["CEM43 base from 37 to 43 °C"]
    inside = np.clip(warm, start, reference)
    below = (low ** (reference - inside) - low ** (reference - start)) / -np.log(low)
    above = (high ** (reference - np.maximum(warm, reference)) - 1.0) / -np.log(high)
    return np.asarray(below + above)


def _expanded(middle: Array, rise: Array) -> Array:
    """Mean Henriques rate in 1/s over a small linear rise about a middle, to the fourth order of the rise."""
    known = _constants()
    absolute = middle + ZERO_C_IN_K
    activation = known["Henriques activation energy"] / known["gas constant"]
    rate = np.exp(np.log(known["Henriques pre-exponential"]) - activation / absolute)
    first, second = activation / absolute**2, activation / absolute**3
    return np.asarray(rate * (1.0 + rise**2 * (first**2 / 24.0 - second / 12.0)))


def _fitting(time_s: npt.ArrayLike, temperature_C: npt.ArrayLike) -> tuple[Array, Array]:
    time, warm = np.asarray(time_s, dtype=np.float64), np.asarray(temperature_C, dtype=np.float64)
    if time.ndim != 1 or warm.ndim < 1 or warm.shape[-1] != len(time):
        raise ValueError(f"exposure: {warm.shape} temperatures do not fit {time.shape} times; the last axis is time")
    if len(time) > 1 and not (np.diff(time) > 0).all():
        raise ValueError("exposure: times must increase")
    if not np.isfinite(warm).all():
        raise ValueError("exposure: temperatures must be finite numbers in °C")
    return time, warm


def _summed(parts: Array) -> Array:
    total = np.zeros((*parts.shape[:-1], parts.shape[-1] + 1))
    np.cumsum(parts, axis=-1, out=total[..., 1:])
    return total
