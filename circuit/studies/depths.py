"""Temperature and heat flow at any depth while a cue plays, and the depth that a probe resembles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.icons import Icon

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.drive import Drive
from ..solver.network import flow_weights, places_of, stacked, temperature_weights
from ..solver.probes import lump_rows
from ..solver.simulate import watch
from ..solver.trace import Trace


@dataclass(frozen=True, slots=True)
class Depths:
    """A run at k depths: `depth_m` (k,), temperature °C and heat flow W/m² into the skin (k, rows), its trace."""

    depth_m: Array
    temperature_C: Array
    heat_flow_W_per_m2: Array
    trace: Trace

    def __post_init__(self) -> None:
        for array in (self.depth_m, self.temperature_C, self.heat_flow_W_per_m2):
            array.setflags(write=False)

    def __repr__(self) -> str:
        return (
            f"Depths({len(self.depth_m)} from {self.depth_m.min() * 1e3:g} to {self.depth_m.max() * 1e3:g} mm, "
            f"{self.temperature_C.shape[1]} rows)"
        )


def probe_depths(
    cue: Icon | Drive, rig: Rig, depths_m: Sequence[float] | Array, *, rate_Hz: float = 100.0, tail_s: float = 0.0
) -> Depths:
    """Simulate a cue or a drive on a rig and record temperature and heat flow at given depths.

    Parameters
    ----------
    cue
        A cue or a drive.
    rig
        The rig.
    depths_m
        Depths below the surface in m; the lumps of the skin are at `rig.column.depth_m`.
    rate_Hz
        Rows per second.
    tail_s
        Time in s that the run continues after the cue's last corner.

    Returns
    -------
    Depths
        Temperature in °C and heat flow in W/m² at each depth.

    Raises
    ------
    RigError
        For a depth outside the skin.

    Notes
    -----
    Temperature is linear in thermal resistance between lumps. Heat flow at a lump is the mean of its two faces; between
    lumps it is that of the face, at the surface that of the contact.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> run = probe_depths(load_library("six-icons")["cooling-step"], Rig.load("thenar"), [0.0, 0.5e-3, 2e-3])
    >>> run.temperature_C.min(axis=1).round(2)
    array([26.92, 29.57, 32.02])
    """
    depths = np.array(depths_m, dtype=np.float64)
    for depth in depths:
        if not 0 <= depth <= rig.skin.thickness_m * (1 + 1e-12):
            raise RigError(
                f"rig {rig.name}: a depth of {depth * 1e3:g} mm is not in the skin; "
                f"it reaches from 0 to {rig.skin.thickness_m * 1e3:g} mm"
            )
    place, contact = places_of(rig), rig.contact.resistance_m2K_per_W
    at = [contact + rig.skin.resistance_to_m2K_per_W(float(depth)) for depth in depths]
    rows = [temperature_weights(here, place) for here in at]
    rows += [flow_weights(here if depth > 0 else 0.5 * contact, place) for here, depth in zip(at, depths, strict=True)]
    trace, values = watch(cue, rig, stacked(rows), rate_Hz=rate_Hz, tail_s=tail_s)
    return Depths(depths, values[: len(depths)].copy(), values[len(depths) :].copy(), trace)


@dataclass(frozen=True, slots=True)
class Likeness:
    """The depth in m of skin in contact whose change a probe resembles most, and the rms residual in K."""

    probe: str
    depth_m: float
    residual_K: float
    largest_change_K: float

    def __repr__(self) -> str:
        return (
            f"Likeness(probe {self.probe!r} is most like {self.depth_m * 1e3:.2f} mm, "
            f"residual {self.residual_K:.3f} K rms of {abs(self.largest_change_K):.2f} K)"
        )


def resembles(
    cue: Icon | Drive, rig: Rig, probe: str | None = None, *, rate_Hz: float = 100.0, tail_s: float = 0.0
) -> Likeness:
    """Return the depth in the skin under the display whose course a probe on insulated skin resembles most.

    Parameters
    ----------
    cue
        A cue or a drive.
    rig
        A rig with such a probe.
    probe
        Name of the probe; None: the first on insulated skin.
    rate_Hz
        Rows per second.
    tail_s
        Time in s that the run continues after the cue's last corner.

    Returns
    -------
    Likeness
        The depth in m, and the rms residual in K.

    Raises
    ------
    RigError
        Where the rig has no such probe.

    Notes
    -----
    The depth with the least rms difference of the changes from the first row; changes, since the start of a trace does
    not depend on depth. A lag of the probe is part of its reading. The insulated skin is that under a round pad, with
    heat flowing sideways; the skin under the display has depth alone.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> rig = Rig.load("thenar").with_(probe=[{"name": "pad", "place": "insulated skin"}])
    >>> resembles(load_library("six-icons")["cooling-step"], rig)
    Likeness(probe 'pad' is most like 2.49 mm, residual 0.059 K rms of 0.11 K)
    """
    names = [other.name for other in rig.probes if other.place == "insulated skin"]
    if probe is None and not names:
        raise RigError(f"rig {rig.name} has no probe on insulated skin; add a [[probe]] with that place")
    name = names[0] if probe is None else probe
    if name not in [other.name for other in rig.probes]:
        raise RigError(
            f"rig {rig.name} has no probe {name!r}; it has {', '.join(p.name for p in rig.probes) or 'none'}"
        )
    trace, lumps = watch(cue, rig, stacked(lump_rows(rig)), rate_Hz=rate_Hz, tail_s=tail_s)
    deep = np.full((1, lumps.shape[1]), rig.deep_C)
    nodes = np.concatenate([trace.skin_C[np.newaxis], lumps, deep])
    depth = np.concatenate([[0.0], rig.column.depth_m, [rig.skin.thickness_m]])
    read = trace.probe(name)
    best = _nearest(rig, depth, nodes - nodes[:, :1], read - read[0])
    return Likeness(name, best[0], best[1], float((read - read[0])[np.argmax(np.abs(read - read[0]))]))


def _nearest(rig: Rig, depth_m: Array, change_K: Array, wanted_K: Array) -> tuple[float, float]:
    """Return (depth m, rms K) of the nearest course; between two lumps the best share has a closed form."""
    best = (0.0, np.inf)
    for k in range(len(depth_m) - 1):
        high, low = depth_m[k], depth_m[k + 1]
        if low - high < 1e-9:
            continue
        step = change_K[k + 1] - change_K[k]
        square = float(step @ step)
        share = 0.0 if square == 0 else min(max(float((wanted_K - change_K[k]) @ step) / square, 0.0), 1.0)
        rms = float(np.sqrt(np.mean((wanted_K - change_K[k] - share * step) ** 2)))
        if rms < best[1]:
            best = (_depth_at(rig, float(high), float(low), share), rms)
    return best


def _depth_at(rig: Rig, high_m: float, low_m: float, share: float) -> float:
    """Depth in m at a share of the thermal resistance between two depths."""
    edges = [high_m, *(edge for edge in _edges(rig) if high_m < edge < low_m), low_m]
    resistance = [rig.skin.resistance_to_m2K_per_W(edge) for edge in edges]
    return float(np.interp(resistance[0] + share * (resistance[-1] - resistance[0]), resistance, edges))


def _edges(rig: Rig) -> list[float]:
    return [float(edge) for edge in np.cumsum([layer.thickness_m for layer in rig.skin.layers])]
