"""Module and skin as two subcircuits to drop into a schematic of LTspice or ngspice, with parameters for what differs.

The same lumps as the netlist's; every layer's cells scale with its thickness, so that the mesh stays as it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..program import own_version
from ..rig.rig import Rig
from ..solver.landing import refuse_landing
from ..solver.network import network_of
from .netlist import _comment, _section, electrical_lines, thermal_lines

MM, CM2 = 1e-3, 1e-4
"""One mm in m, one cm² in m²: parameters have the units of rig files, elements those of SI."""


def subcircuits(rig: Rig) -> str:
    """Return `.subckt` definitions of a rig's module and skin, for LTspice and ngspice.

    Parameters
    ----------
    rig
        A rig with a module; its numbers are the defaults of the parameters.

    Returns
    -------
    str
        A library: `thermicon_module plus minus hot cold` and `thermicon_skin display skin cold_receptor warm_receptor`.

    Raises
    ------
    RigError
        For a thermode, and for a hand that lands.

    Examples
    --------
    >>> print(*[line for line in subcircuits(Rig.load("thenar")).splitlines() if line.startswith(".")], sep="\\n")
    .subckt thermicon_module plus minus hot cold
    .ends thermicon_module
    .subckt thermicon_skin display skin cold_receptor warm_receptor
    .ends thermicon_skin
    """
    refuse_landing(rig, "a subcircuit starts in a steady state")
    network_of(rig)  # refuses a thermode
    return "\n".join([*_header(rig), *_module(rig), *_skin(rig), ""])


def _header(rig: Rig) -> Iterator[str]:
    yield from _comment(f"Module and skin of rig {rig.name}, written by thermicon {own_version()}")
    if rig.title:
        yield from _comment(rig.title)
    yield "*"
    for text in (
        "Electrical ports in V and A; thermal ports: 1 V is 1 degC above a ground of 0 degC, 1 A is 1 W.",
        "thermicon_module: a current into plus cools cold. Connect hot to a heat sink, cold to the skin.",
        "thermicon_skin: display is the surface that touches the skin; skin, cold_receptor and warm_receptor are "
        "temperatures to read, and take no current.",
        "Each default may be replaced where a subcircuit is used:",
        "  Xmodule plus 0 hot cold thermicon_module",
        "  Xskin cold skin cold_receptor warm_receptor thermicon_skin area_cm2=4 contact_m2K_per_W=1e-3",
        "A receptor keeps its place within its layer: where that layer becomes thicker, it lies deeper.",
        "blood_C is the temperature of blood and deep tissue that gives the rig its resting skin; a rig file solves it "
        "again when a layer changes, a subcircuit does not.",
    ):
        yield from _comment(text)


def _definition(name: str, ports: str, parameters: dict[str, float]) -> Iterator[str]:
    yield f".subckt {name} {ports}"
    yield from (f"+ {key}={value!r}" for key, value in parameters.items())


def _module(rig: Rig) -> Iterator[str]:
    module, cells = rig.module, rig.module.leg_nodes
    names = [
        "seebeck_V_per_K",
        "resistance_ohm",
        "thermal_resistance_K_per_W",
        "hot_plate_J_per_K",
        "cold_plate_J_per_K",
    ]
    names += ["leg_capacity_J_per_K"] if cells else []
    parameters = {name: float(getattr(module, name)) for name in names}
    yield from _section("module")
    yield from _definition("thermicon_module", "plus minus hot cold", parameters)
    yield from electrical_lines(_parameter, "minus")
    yield from thermal_lines(_parameter, cells)
    yield ".ends thermicon_module"


def _parameter(name: str, part: int = 1) -> str:
    return f"{{{name}}}" if part == 1 else f"{{{name}/{part}}}"


def _skin(rig: Rig) -> Iterator[str]:
    column, layers = rig.column, rig.skin.layers
    parameters = {
        "area_cm2": rig.contact.area_m2 / CM2,
        "contact_m2K_per_W": float(rig.contact.resistance_m2K_per_W),
        "blood_C": float(rig.deep_C),
    }
    yield from _section("skin")
    for number, layer in enumerate(layers, 1):
        yield from _comment(f"  layer {number}: {layer.name}")
        parameters |= {
            f"thickness{number}_mm": layer.thickness_m / MM,
            f"conductivity{number}_W_per_mK": float(layer.conductivity_W_per_mK),
            f"heat{number}_J_per_m3K": layer.density_kg_per_m3 * layer.heat_capacity_J_per_kgK,
        }
        if layer.perfusion_per_s:
            parameters[f"perfusion{number}_W_per_m3K"] = layer.perfusion_per_s * column.blood_capacity_J_per_m3K
    yield from _definition("thermicon_skin", "display skin cold_receptor warm_receptor", parameters)
    count, ends = len(column.depth_m), [*column.depth_m.tolist(), rig.skin.thickness_m]
    names = ["face", *(f"s{i + 1}" for i in range(count)), "blood"]
    if ends[0] == 0.0:
        names[1] = "face"
    yield f"Rcontact display face {{contact_m2K_per_W/(area_cm2*{CM2!r})}}"
    volumes = _volumes(rig)
    for i, (above, below) in enumerate(pairwise([0.0, *ends])):
        if below > above:
            parts = [f"{share!r}*thickness{k}_mm/conductivity{k}_W_per_mK" for k, share in _shares(rig, above, below)]
            yield f"R{i} {names[i]} {names[i + 1]} {{{MM!r}*({'+'.join(parts)})/(area_cm2*{CM2!r})}}"
    for i, (top, bottom) in enumerate(pairwise(volumes.tolist())):
        shares = _shares(rig, top, bottom)
        heat = "+".join(f"{share!r}*thickness{k}_mm*heat{k}_J_per_m3K" for k, share in shares)
        yield f"C{i} {names[i + 1]} 0 {{{MM * CM2!r}*area_cm2*({heat})}}"
        perfused = [
            f"{share!r}*thickness{k}_mm*perfusion{k}_W_per_m3K" for k, share in shares if layers[k - 1].perfusion_per_s
        ]
        if perfused:
            node = names[i + 1]
            yield f"G{i} {node} blood {node} blood {{{MM * CM2!r}*area_cm2*({'+'.join(perfused)})}}"
    yield "Vblood blood 0 {blood_C}"
    yield "Eskin skin 0 face 0 1"
    for receptor in ("cold_receptor", "warm_receptor"):
        depth_m = float(getattr(rig.skin, f"{receptor}_m"))
        yield f"B{receptor} {receptor} 0 V={_reading(rig, depth_m, names)}"
    yield ".ends thermicon_skin"


def _volumes(rig: Rig) -> Array:
    """Depths in m between which each lump stores heat: whole elements where they are fixed, else halves of cells."""
    depth = rig.column.depth_m
    if rig.skin.elements is not None:
        cells = [
            layer.thickness_m / count
            for layer, count in zip(rig.skin.layers, rig.skin.elements, strict=True)
            for _ in range(count)
        ]
        return np.concatenate([[0.0], np.cumsum(cells)])
    nodes = np.append(depth, rig.skin.thickness_m)
    return np.concatenate([[0.0], (nodes[:-1] + nodes[1:]) / 2])


def _shares(rig: Rig, top_m: float, bottom_m: float) -> list[tuple[int, float]]:
    """Number of each layer between two depths, and the share of its thickness that lies there."""
    shares, begin = [], 0.0
    for number, layer in enumerate(rig.skin.layers, 1):
        inside = min(bottom_m, begin + layer.thickness_m) - max(top_m, begin)
        if inside > 1e-9 * layer.thickness_m:
            shares.append((number, inside / layer.thickness_m))
        begin += layer.thickness_m
    return shares


def _reading(rig: Rig, depth_m: float, names: list[str]) -> str:
    """Temperature at a depth as an expression: that of a lump, or linear in thermal resistance between two."""
    place = np.concatenate([[0.0], np.cumsum(rig.column.resistance_m2K_per_W)])
    at = rig.skin.resistance_to_m2K_per_W(depth_m)
    nearest = int(np.abs(place - at).argmin())
    if abs(place[nearest] - at) < 1e-9 * place[-1]:
        return f"V({names[nearest]})"
    below = int(np.searchsorted(place, at))
    share = float((at - place[below - 1]) / (place[below] - place[below - 1]))
    return f"{1 - share!r}*V({names[below - 1]})+{share!r}*V({names[below]})"
