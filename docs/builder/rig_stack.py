"""The stack of a rig from heat sink to blood."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermicon.circuit import Rig
from thermicon.icons.pictures.draw import as_svg

LEFT, ROW, LETTERS, SKIN_HIGH, KEYS_WIDE = 24.0, 10.5, 6.0, 210.0, 143.0
"""Points: margin, one line, its letters, all layers of skin, the longest key."""
SCALE = "depth in skin (mm): logarithmic; display: not to scale"
LINEAR_MM, TICKS_MM = 0.05, (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
RECEPTORS: dict[str, tuple[str, Any]] = {"cold": ("#2166ac", "-"), "warm": ("#e08214", (0, (3.0, 1.5)))}
LEGS = "p–n couples"
ABOVE = {
    "heat sink": ("0.72", ("heat_sink.temperature_C", "heat_sink.resistance_K_per_W")),
    "hot plate": ("#f6c98f", ("module.hot_plate_J_per_K",)),
    LEGS: ("none", ("module.seebeck_V_per_K", "module.resistance_ohm", "module.thermal_resistance_K_per_W")),
    "cold plate": ("#8fb8de", ("module.cold_plate_J_per_K",)),
    "contact": ("w", ("contact.area_cm2", "contact.resistance_m2K_per_W")),
}
BELOW = {"blood": ("#efe0e0", ("skin.rest_C", "blood.density_kg_per_m3", "blood.heat_capacity_J_per_kgK"))}
"""Parts above and below the layers of the skin: colour and keys."""


def plot_stack(rig: Rig, width_mm: float = 107.0) -> Axes:
    """Draw the parts of a rig with a module and an ideal heat sink, each joined to its keys and their values."""
    file: Any = json.loads(rig.document)
    wide, top, depth_mm, free = width_mm / 25.4 * 72.0, 0.0, 0.0, 0.0
    right, scale = wide - LEFT - KEYS_WIDE - 12.0, SKIN_HIGH / np.log1p(1e3 * rig.skin.thickness_m / LINEAR_MM)
    surface = sum(ROW * len(keys) + 4.0 for _, keys in ABOVE.values())
    axes = Figure().add_axes((LEFT / wide, 0.0, 1.0 - LEFT / wide, 1.0), frame_on=False, xticks=[])

    def at(mm: float) -> float:
        return surface + float(scale * np.log1p(mm / LINEAR_MM))

    stack: list[tuple[str, str, float, list[str]]] = []  # name, colour, height, and what is said of each part
    for name, (colour, keys) in (ABOVE | BELOW).items():
        values = [file[table][key] for table, key in (each.split(".") for each in keys)]
        lines = [f"{key} = {value:g}" for key, value in zip(keys, values, strict=True)]
        stack.append((name, colour, ROW * len(keys) + 4.0, lines))
    for place, layer in enumerate(file["skin"]["layer"]):
        name, thick = layer.pop("name"), layer.pop("thickness_mm")
        lines = [f"thickness_mm = {thick:g}{', …' * (place > 0)}"]
        lines += [f"{key} = {value:g}" for key, value in layer.items() if place == 0]
        high, lines = at(depth_mm + thick) - at(depth_mm), [f"skin.layer.{place}.{each}" for each in lines]
        stack.insert(len(ABOVE) + place, (name, ("#faf1e6", "#efdfcc")[place % 2], high, lines))
        depth_mm += thick
    rows: list[tuple[float, str, str]] = []  # where a key belongs, what it says, the colour of its line
    for name, colour, high, lines in stack:
        axes.fill_between((0.0, right), top, top + high, fc=colour, ec="0.15", lw=0.6)
        axes.text(right / 2.0, top + high / 2.0, name, ha="center", va="center", fontsize=LETTERS)
        rows += [(top + high / 2.0 + ROW * (k - len(lines) / 2.0 + 0.5), each, "0.45") for k, each in enumerate(lines)]
        if name == LEGS:
            legs = right * (np.arange(8) + 0.5) / 8.0
            axes.bar(legs, high, right / 11.0, top, color=["0.94", "0.85"] * 4, zorder=0.0)
        top += high
    for name, (colour, dashes) in RECEPTORS.items():
        mm = 1e3 * getattr(rig.skin, f"{name}_receptor_m")
        axes.plot((0.0, right), (at(mm), at(mm)), color=colour, lw=2.2, ls=dashes)
        rows.append((at(mm), f"skin.{name}_receptor_mm, else {mm:.3g}", colour))
    for where, text, colour in sorted(rows):
        free = max(free, where)
        axes.plot((right, right + 4.0, right + 9.0, right + 11.0), (where, where, free, free), color=colour, lw=0.7)
        axes.text(right + 12.0, free, text, va="center", fontsize=LETTERS)
        free += ROW
    shown = [mm for mm in TICKS_MM if mm <= depth_mm]
    axes.set_yticks([at(mm) for mm in shown], [f"{mm:g}" for mm in shown], fontsize=LETTERS)
    axes.text(3.0 - LEFT, top + 9.0, SCALE, va="center", fontsize=LETTERS)
    axes.set(xlim=(0.0, wide - LEFT), ylim=(top + 15.0, -2.0))
    axes.figure.set_size_inches(wide / 72.0, (top + 17.0) / 72.0)
    return axes


def rig_stack(write: Callable[[str, str | bytes], None]) -> str:
    """Write the stack of the rig that most pages use, and return the Markdown that shows it."""
    write("reference/rig-stack.svg", as_svg(plot_stack(Rig.load("thenar"))))
    what = "The rig thenar: heat sink, Peltier module, contact, layers of skin, blood, and the keys of each"
    return f"```{{image}} rig-stack.svg\n:alt: {what}\n:width: 600px\n```\n"
