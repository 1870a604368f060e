"""Icons on several elements in commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from thermicon.base.words.near_words import did_you_mean

from ..loading import site_warnings, warn_of_rig
from ..messages import note, usage
from .options import RigOptions

if TYPE_CHECKING:
    from thermicon.circuit import Layout, LayoutTrace
    from thermicon.circuit.safety.whole import Whole
    from thermicon.icons import IconSet, SpatialIcon


def layout_of(icons: IconSet, asked: RigOptions, file: str) -> Layout:
    """The layout that a command names for icons on several elements, after warnings of it and of its rigs."""
    from thermicon.circuit import Layout

    if asked.changes:
        help = "write set = { … } into an element of the layout file"
        raise usage(f"changes a key of one rig, and a layout has several: {help}", "--set")
    layout = Layout.of(asked.rig, icons.context.site)
    layout.check_elements(icons.context.elements)
    for warning in layout.warnings:
        note(f"warning: {warning}")
    for rig in dict.fromkeys(element.rig for element in layout.elements):
        warn_of_rig(rig, named=True)
        for warning in site_warnings(file, icons, rig):
            note(f"warning: {warning}")
    return layout


def elements_asked(icons: IconSet, name: str | None, asked: RigOptions, file: str) -> tuple[Layout, list[SpatialIcon]]:
    """The layout that a command names, and the icons of a set (or the one named)."""
    names = [icon.name for icon in icons.spatial]
    if name is not None and name not in names:
        raise usage(f"no icon is called {name!r}; {did_you_mean(name, names)}", "--icon")
    layout = layout_of(icons, asked, file)
    return layout, [icon for icon in icons.spatial if name in (None, icon.name)]


def simulate_elements(
    icons: IconSet, name: str | None, asked: RigOptions, file: str, rate_Hz: float, tail_s: float
) -> list[LayoutTrace]:
    """The runs of icons on several elements (or of the one named) on a layout."""
    from thermicon.circuit import simulate

    layout, chosen = elements_asked(icons, name, asked, file)
    return [simulate(icon, layout, rate_Hz=rate_Hz, tail_s=tail_s) for icon in chosen]


def together_line(whole: Whole) -> str:
    """What all elements do together beside its limits, and whether that needs one clock."""
    sums = [
        f"{check.quantity} {check.figures[0]} {check.unit} of {check.figures[1]}"
        for check in whole.checks
        if check.severity == "hard"
    ]
    clock = "whatever their clocks do" if whole.offset_s is None else f"with clocks {whole.offset_s:g} s apart at most"
    return f"all elements together: {', '.join([whole.colour, *sums])}, {clock}"
