"""Skin as layers and as a column of lumps."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.files.records import shipped_records
from thermicon.base.numbers.arrays import Array

from .faults import sentence

STRATUM_CORNEUM = "stratum corneum"
"""Name of the layer from whose base receptor depths may be counted; it must be a skin's first."""

FIRST_CELL_M = 25e-6
CELL_GROWTH = 0.10
"""Cell size at the surface, and its growth per unit depth: fine where the onset is steep, coarse where little changes.

Chosen with `meshstudy` in `examples/source-paper` over two cues, six drives and four skins, not fitted to one:
within 5 mK of a converged mesh at receptor depth on a 6 °C, 3 °C/s cue, and within 20 mK on 20 s drives that swing the
display by 30 to 50 °C.
"""


def usual_depth_mm(channel: str) -> float:
    """Depth of the cold or warm receptors in mm where nobody places them: from the base of the stratum corneum."""
    return shipped_records("receptor-depths.toml").one("receptor depth", channel=channel).central


@dataclass(frozen=True, slots=True)
class Layer:
    """One layer of tissue; thickness m, conductivity W/(m·K), density kg/m³, capacity J/(kg·K), perfusion 1/s."""

    name: str
    thickness_m: float
    conductivity_W_per_mK: float
    density_kg_per_m3: float
    heat_capacity_J_per_kgK: float
    perfusion_per_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Skin:
    """Layers, surface first, with the depths of the receptors and what determines the deep temperature.

    `rest_C` is the bare surface at rest. `deep_C` fixes deep tissue and blood; None: solved from the heat balance.
    `elements` gives a fixed number of elements per layer (T-sections) instead of the graded mesh.
    The depths of the receptors count from the surface here; `depth_from` is how the rig file counts them, and `own`
    whether it places them at all: otherwise they lie where receptors usually do, until an observer places its own.
    """

    site: str
    rest_C: float
    cold_receptor_m: float
    warm_receptor_m: float
    layers: tuple[Layer, ...]
    deep_C: float | None = None
    elements: tuple[int, ...] | None = None
    depth_from: str = "surface"
    own: bool = False

    def __post_init__(self) -> None:
        thickness, above, below = self.thickness_m, 0.0, ""
        if self.depth_from == STRATUM_CORNEUM:
            above, below = self.layers[0].thickness_m, f" below the {STRATUM_CORNEUM}"
        for name, depth in (("cold_receptor", self.cold_receptor_m), ("warm_receptor", self.warm_receptor_m)):
            if not 0 < depth < thickness - 1e-9:
                depth_mm, most_mm = (depth - above) * 1e3, (thickness - above) * 1e3
                raise ValueError(sentence("parts.receptor", key=name, depth=depth_mm, most=most_mm, below=below))
        if self.elements is not None and len(self.elements) != len(self.layers):
            raise ValueError(sentence("parts.elements", given=list(self.elements), count=len(self.layers)))

    @property
    def thickness_m(self) -> float:
        """Depth of the deep node in m."""
        return sum(layer.thickness_m for layer in self.layers)

    @property
    def corneum_m(self) -> float:
        """Thickness of the stratum corneum in m; 0 for a skin without one."""
        return self.layers[0].thickness_m if self.layers[0].name == STRATUM_CORNEUM else 0.0

    def with_effusivity(self, times: float) -> Skin:
        """The skin whose living layers have so many times their effusivity √(k·ρ·c), at the same diffusivity."""
        layers = list(self.layers)
        for place, layer in enumerate(layers):
            if layer.name != STRATUM_CORNEUM:
                k, c = times * layer.conductivity_W_per_mK, times * layer.heat_capacity_J_per_kgK
                layers[place] = replace(layer, conductivity_W_per_mK=k, heat_capacity_J_per_kgK=c)
        return replace(self, layers=tuple(layers))

    def receptor_words(self) -> str:
        """Where the receptors lie, from the surface and from the base of the stratum corneum, as papers count them."""
        depths = {"cold": self.cold_receptor_m * 1e3, "warm": self.warm_receptor_m * 1e3}
        text = ", ".join(f"{name} {depth:.3g} mm" for name, depth in depths.items()) + " below the surface"
        if not self.corneum_m:
            return text
        base = {name: round(depth - self.corneum_m * 1e3, 9) for name, depth in depths.items()}
        below = [f"{name} {abs(depth):.3g} mm {'above' if depth < 0 else 'below'}" for name, depth in base.items()]
        return f"{text}; {', '.join(below)} the base of the {STRATUM_CORNEUM}"

    def resistance_to_m2K_per_W(self, depth_m: float) -> float:
        """Thermal resistance from the face down to a depth, in m²·K/W."""
        total, top = 0.0, 0.0
        for layer in self.layers:
            total += min(max(depth_m - top, 0.0), layer.thickness_m) / layer.conductivity_W_per_mK
            top += layer.thickness_m
        return total


@dataclass(frozen=True, slots=True)
class SkinColumn:
    """A skin column of n lumps, per unit area, face first; arrays are read-only.

    `depth_m` (n,), `capacity_J_per_m2K` (n,), `perfusion_W_per_m2K` (n,) to blood, `resistance_m2K_per_W` (n + 1,):
    from the face to the first lump (0 where it lies in the face), between lumps, and from the last to the deep node.
    """

    depth_m: Array
    capacity_J_per_m2K: Array
    perfusion_W_per_m2K: Array
    resistance_m2K_per_W: Array
    blood_capacity_J_per_m3K: float = 0.0

    def __post_init__(self) -> None:
        for array in (self.depth_m, self.capacity_J_per_m2K, self.perfusion_W_per_m2K, self.resistance_m2K_per_W):
            array.setflags(write=False)

    def steady_drop_K(self, flux_W_per_m2: float) -> float:
        """Steady temperature of the face above the deep (and blood) temperature in K under a constant flux into it."""
        resistances, below = self.resistance_m2K_per_W.tolist(), 0.0  # of all that lies below a lump, in m²·K/W
        for perfusion, resistance in zip(self.perfusion_W_per_m2K[::-1].tolist(), resistances[:0:-1], strict=True):
            below = 1.0 / (perfusion + 1.0 / (resistance + below))
        return flux_W_per_m2 * float(resistances[0] + below)


def column_of(
    skin: Skin, blood_capacity_J_per_m3K: float, first_cell_m: float = FIRST_CELL_M, growth: float = CELL_GROWTH
) -> SkinColumn:
    """Return the lumps of a skin: T-sections where it has fixed elements, otherwise the graded mesh."""
    if skin.elements is not None:
        return _sections(skin, blood_capacity_J_per_m3K)
    return _graded(skin, blood_capacity_J_per_m3K, first_cell_m, growth)


def _graded(skin: Skin, blood: float, first: float, growth: float) -> SkinColumn:
    boundaries = np.cumsum([0.0] + [layer.thickness_m for layer in skin.layers])
    fixed = np.sort(np.concatenate([boundaries, [skin.cold_receptor_m, skin.warm_receptor_m]]))
    fixed = fixed[np.concatenate([[True], np.diff(fixed) > 1e-9])]
    depths = [0.0]
    for top, bottom in itertools.pairwise(fixed.tolist()):
        low, high = first + growth * top, first + growth * bottom
        count = max(1, math.ceil(math.log(high / low) / growth - 1e-6))
        inside = (low * (high / low) ** (np.arange(1, count) / count) - first) / growth
        depths.extend([*inside.tolist(), bottom])
    node = np.array(depths)
    layer_of = np.clip(np.searchsorted(boundaries, (node[:-1] + node[1:]) / 2) - 1, 0, len(skin.layers) - 1)
    cell = np.diff(node)
    per = _per_layer(skin, blood)
    heat, perfused = per[0][layer_of] * cell, per[1][layer_of] * cell
    capacity, perfusion = heat / 2, perfused / 2
    capacity[1:] += heat[:-1] / 2
    perfusion[1:] += perfused[:-1] / 2
    resistance = np.concatenate([[0.0], cell / per[2][layer_of]])
    return SkinColumn(node[:-1].copy(), capacity, perfusion, resistance, blood)


def _sections(skin: Skin, blood: float) -> SkinColumn:
    assert skin.elements is not None
    per = _per_layer(skin, blood)
    layer_of = np.repeat(np.arange(len(skin.layers)), skin.elements)
    cell = np.repeat(np.array([layer.thickness_m for layer in skin.layers]) / skin.elements, skin.elements)
    half = cell / per[2][layer_of] / 2
    resistance = np.concatenate([half, [0.0]])
    resistance[1:] += half
    depth = np.cumsum(cell) - cell / 2
    return SkinColumn(depth, per[0][layer_of] * cell, per[1][layer_of] * cell, resistance, blood)


def _per_layer(skin: Skin, blood: float) -> tuple[Array, Array, Array]:
    heat = np.array([layer.density_kg_per_m3 * layer.heat_capacity_J_per_kgK for layer in skin.layers])
    perfused = np.array([layer.perfusion_per_s * blood for layer in skin.layers])
    return heat, perfused, np.array([layer.conductivity_W_per_mK for layer in skin.layers])
