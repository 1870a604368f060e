"""The circuit once more without code of thermicon.

Held current makes the circuit linear: C·dx/dt = −K(I)·x + b(I), with K symmetric, so that C^−½·K·C^−½ has real modes.
Worlds (a rig as given, every corner of its uncertainty, points inside) stand in the first axis of every array.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Json = dict[str, Any]

KELVIN = 273.15

UNSURE = {
    "contact_resistance_relative": 0.3, "gain_relative": 0.1, "seebeck_relative": 0.05, "conductance_relative": 0.1,
    "plates_relative": 0.2, "ambient_K": 3.0, "heat_sink_K": 1.0,
}  # fmt: skip
"""What is not known of a rig whose file says nothing of it, as documented."""


def meshed(rig: Json) -> tuple[Array, Array, Array]:
    """Per m², face first: capacity (n,), perfusion (n,), resistance (n + 1,) from face to first lump and so on."""
    skin, layers = rig["skin"], rig["skin"]["layer"]
    blood = rig["blood"]["density_kg_per_m3"] * rig["blood"]["heat_capacity_J_per_kgK"]
    thick = [layer["thickness_mm"] * 1e-3 for layer in layers]
    heat = [layer["density_kg_per_m3"] * layer["heat_capacity_J_per_kgK"] for layer in layers]
    flow = [layer.get("perfusion_per_s", 0.0) * blood for layer in layers]
    conduct = [layer["conductivity_W_per_mK"] for layer in layers]
    if skin.get("elements"):  # T-sections: a lump in the middle of each element
        cell = [h / n for h, n in zip(thick, skin["elements"], strict=True) for _ in range(n)]
        of = [k for k, n in enumerate(skin["elements"]) for _ in range(n)]
        half = [size / conduct[k] / 2 for size, k in zip(cell, of, strict=True)]
        resistance = [half[0], *(a + b for a, b in itertools.pairwise(half)), half[-1]]
        capacity = [heat[k] * size for size, k in zip(cell, of, strict=True)]
        return np.array(capacity), np.array([flow[k] * s for s, k in zip(cell, of, strict=True)]), np.array(resistance)
    ends = np.cumsum([0.0, *thick])
    corners = np.unique(np.round([*ends, *receptors(rig)], 12))
    nodes = [0.0]
    for top, bottom in itertools.pairwise(corners):  # cells of 25 µm that grow by a tenth of their depth
        low, high = 25e-6 + 0.1 * top, 25e-6 + 0.1 * bottom
        count = max(1, int(np.ceil(np.log(high / low) / 0.1 - 1e-6)))
        nodes += [(low * (high / low) ** (k / count) - 25e-6) / 0.1 for k in range(1, count)] + [float(bottom)]
    cell_m = np.diff(nodes)
    of = [min(int(np.searchsorted(ends, 0.5 * (a + b))) - 1, len(thick) - 1) for a, b in itertools.pairwise(nodes)]
    lumps = np.zeros(len(nodes)), np.zeros(len(nodes))
    for k, layer in enumerate(of):
        for into, per in zip(lumps, (heat, flow), strict=True):
            into[k : k + 2] += per[layer] * cell_m[k] / 2
    return lumps[0][:-1], lumps[1][:-1], np.array([0.0, *(s / conduct[k] for s, k in zip(cell_m, of, strict=True))])


def receptors(rig: Json) -> tuple[float, float]:
    """Depths in m of cold and warm receptors below the surface."""
    skin, first = rig["skin"], rig["skin"]["layer"][0]
    said = "cold_receptor_mm" in skin or "warm_receptor_mm" in skin
    usual = {"cold_receptor_mm": 0.10, "warm_receptor_mm": 0.21, "depth_from": "surface" if said else first["name"]}
    own = {key: skin.get(key, default) for key, default in usual.items()}
    above = first["thickness_mm"] if own["depth_from"] == "stratum corneum" else 0.0
    return tuple((own[f"{kind}_receptor_mm"] + above) * 1e-3 for kind in ("cold", "warm"))  # type: ignore[return-value]


def worlds_of(rig: Json, inside: np.random.Generator | None = None, extra: int = 0) -> list[dict[str, float]]:
    """The rig as given, the corners of its uncertainty, and `extra` points by chance within it."""
    unsure = {key: float(rig.get("uncertainty", {}).get(key, value)) for key, value in UNSURE.items()}
    unsure["sign"] = 1.0 if deep_C(rig, 1.0) >= deep_C(rig, -1.0) else -1.0
    sides = [(-1.0, 1.0) if unsure[key] else (0.0,) for key in list(UNSURE)[:5]]
    around = (-1.0, 1.0) if unsure["ambient_K"] or unsure["heat_sink_K"] else (0.0,)
    found = [dict.fromkeys(UNSURE, 0.0)]
    for side in itertools.product(*sides, around):
        share = [*side[:5], side[5] * unsure["sign"], side[5]]
        found.append({key: each * unsure[key] for key, each in zip(UNSURE, share, strict=True)})
    for _ in range(extra if inside is not None else 0):
        assert inside is not None
        found.append({key: unsure[key] * float(inside.choice([-1, 1, inside.uniform(-1, 1)])) for key in UNSURE})
    unique = {tuple(world.values()): world for world in found}
    return list(unique.values())


def deep_C(rig: Json, warmer_K: float) -> float:
    """Blood and deep tissue: as given, or such that bare skin is at rest in its air."""
    skin, air = rig["skin"], rig["ambient"]
    if skin.get("deep_C") is not None:
        return float(skin["deep_C"])
    capacity, perfusion, resistance = meshed(rig)
    between = 1.0 / resistance[1:]
    matrix = np.diag(perfusion + between + np.append(0.0, between[:-1]))
    matrix -= np.diag(between[:-1], 1) + np.diag(between[:-1], -1)
    lost = air["film_W_per_m2K"] * (skin["rest_C"] - air["temperature_C"] - warmer_K)
    flux = np.zeros(len(capacity))
    flux[0] = lost
    return float(skin["rest_C"] + lost * resistance[0] + np.linalg.solve(matrix, flux)[0])


@dataclass(frozen=True, eq=False)
class Circuit:
    """All worlds of a rig, (W, …): capacities (W, n), K without current (W, n, n), heat in without current (W, n).

    `watch` (W, 4, n) and `offset` (W, 4) read skin, cold receptor, display and hot plate; a rig under a prescribed
    display has no plates: then n counts lumps, `display` (W, n) is what 1 K of display gives, `direct` (W, 4) reads it.
    """

    worlds: list[dict[str, float]]
    capacity: Array
    matrix: Array
    heat: Array
    watch: Array
    offset: Array
    alpha: Array
    ohm: Array
    gain: Array
    display: Array
    direct: Array

    @staticmethod
    def of(rig: Json, worlds: list[dict[str, float]], module: bool = True) -> Circuit:
        """The circuit in each world; without `module`, skin under a display that is prescribed."""
        parts = [_one(rig, world, module) for world in worlds]
        stacked = [np.stack(column) for column in zip(*parts, strict=True)]
        gain = np.array([1.0 + world["gain_relative"] for world in worlds])
        return Circuit(worlds, *stacked[:5], stacked[5], stacked[6], gain, stacked[7], stacked[8])

    def system(self, mean_A: Array, square_A2: Array) -> tuple[Array, Array]:
        """Rate matrix (W, n, n) and heating (W, n), both per second, under currents (W,) as they flow."""
        matrix, heat = self.matrix.copy(), self.heat.copy()
        for node, sign in ((0, 1.0), (1, -1.0)):
            matrix[:, node, node] -= sign * self.alpha * mean_A
            heat[:, node] += sign * self.alpha * mean_A * KELVIN + 0.5 * self.ohm * square_A2
        return -matrix / self.capacity[:, :, None], heat / self.capacity

    def modes(self, mean_A: Array, square_A2: Array) -> Modes:
        """The modes under held currents (W,)."""
        rate, heat = self.system(mean_A, square_A2)
        return Modes.of(rate, heat, self.capacity)

    def insulated(self) -> Modes:
        """Skin under a display that lets no heat through (module False)."""
        matrix = self.matrix.copy()
        matrix[:, 0, 0] -= self.display[:, 0]
        return Modes.of(-matrix / self.capacity[:, :, None], self.heat / self.capacity, self.capacity)

    def read(self, state: Array) -> Array:
        """Watched (W, 4, plays) of states (W, n, plays)."""
        return np.asarray(self.watch @ state + self.offset[:, :, None])


@dataclass(frozen=True, eq=False)
class Modes:
    """Exact steps of a linear system: eigenvalues (W, n), modes into states and back (W, n, n), heating (W, n)."""

    rates: Array
    into: Array
    back: Array
    heat: Array

    @staticmethod
    def of(rate: Array, heat: Array, capacity: Array) -> Modes:
        """Modes of a rate matrix that is symmetric once it is scaled with the roots of capacities."""
        root = np.sqrt(capacity)
        symmetric = rate * root[:, :, None] / root[:, None, :]
        rates, turn = np.linalg.eigh(0.5 * (symmetric + symmetric.transpose(0, 2, 1)))
        return Modes(rates, turn / root[:, :, None], turn.transpose(0, 2, 1) * root[:, None, :], heat)

    def step(self, time_s: float) -> tuple[Array, Array]:
        """The map x → P·x + q over a time: P (W, n, n), q (W, n, 1)."""
        grown = np.exp(np.minimum(self.rates * time_s, 50.0))
        scaled = np.minimum(self.rates * time_s, 50.0)
        added = time_s * np.where(np.abs(scaled) > 1e-12, np.expm1(scaled) / np.where(scaled == 0, 1.0, scaled), 1.0)
        moved = self.into @ (added[:, :, None] * (self.back @ self.heat[:, :, None]))
        return (self.into * grown[:, None, :]) @ self.back, moved

    def steady(self) -> Array:
        """Where the system comes to rest (W, n, 1); hot without end: 1000 °C."""
        state = self.into @ ((self.back @ self.heat[:, :, None]) / -np.minimum(self.rates, -1e-12)[:, :, None])
        state[(self.rates >= -1e-9).any(axis=1)] = 1000.0
        return np.asarray(state)


def _one(rig: Json, world: dict[str, float], module: bool) -> tuple[Array | float, ...]:
    area = rig["contact"]["area_cm2"] * 1e-4
    contact = rig["contact"]["resistance_m2K_per_W"] * (1 + world["contact_resistance_relative"])
    capacity, perfusion, resistance = meshed(rig)
    place = np.cumsum([0.0, contact + resistance[0], *resistance[1:]])  # display, lumps, deep node
    deep, through = deep_C(rig, world["ambient_K"]), area / np.diff(place)
    count = len(capacity)
    skin = np.diag(perfusion * area + through[:-1] + through[1:])
    skin -= np.diag(through[1:-1], 1) + np.diag(through[1:-1], -1)
    into = perfusion * area * deep
    into[-1] += through[-1] * deep
    depth = receptors(rig)[0]
    layers = [(layer["thickness_mm"] * 1e-3, layer["conductivity_W_per_mK"]) for layer in rig["skin"]["layer"]]
    above = 0.0
    for thick, conduct in layers:
        above, depth = above + min(max(depth, 0.0), thick) / conduct, depth - thick
    # weights of display, lumps and deep node in the face and at the receptor
    face, felt = (
        np.array([np.interp(at, place, row) for row in np.eye(count + 2)]) for at in (contact, contact + above)
    )
    first = np.zeros(count)
    first[0] = through[0]
    if not module:
        watch, direct = np.zeros((4, count)), np.zeros(4)
        watch[0], watch[1] = face[1:-1], felt[1:-1]
        direct[:2], direct[2:] = (face[0], felt[0]), 1.0
        offset = np.array([face[-1] * deep, felt[-1] * deep, 0.0, 0.0])
        return capacity * area, skin, into, watch, offset, 0.0, 0.0, first, direct
    pump, sink = rig["module"], rig["heat_sink"]
    leak = (1 + world["conductance_relative"]) / pump["thermal_resistance_K_per_W"]
    out, ends = 1 / sink["resistance_K_per_W"], 1 + world["plates_relative"]
    matrix = np.zeros((count + 2, count + 2))
    matrix[2:, 2:] = skin
    matrix[1, 2] = matrix[2, 1] = -through[0]
    matrix[0, 1] = matrix[1, 0] = -leak
    matrix[0, 0], matrix[1, 1] = leak + out, leak + through[0]
    heat = np.array([out * (sink["temperature_C"] + world["heat_sink_K"]), 0.0, *into])
    watch = np.zeros((4, count + 2))
    watch[0, 1:], watch[1, 1:], watch[2, 1], watch[3, 0] = face[:-1], felt[:-1], 1.0, 1.0
    offset = np.array([face[-1] * deep, felt[-1] * deep, 0.0, 0.0])
    plates = np.array([pump["hot_plate_J_per_K"], pump["cold_plate_J_per_K"]]) * ends
    alpha = pump["seebeck_V_per_K"] * (1 + world["seebeck_relative"])
    return (
        np.concatenate([plates, capacity * area]), matrix, heat, watch, offset, alpha, pump["resistance_ohm"],
        np.zeros(count + 2), np.zeros(4),
    )  # fmt: skip
