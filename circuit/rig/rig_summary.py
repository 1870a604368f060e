"""A rig in plain text: what to know about it before trusting its results."""

from __future__ import annotations

import json
import textwrap
from typing import TYPE_CHECKING

from .load import with_article
from .parts import Thermode

if TYPE_CHECKING:
    from .rig import Rig

WIDTH = 118


def rig_summary(rig: Rig) -> str:
    """Return title, site, rest, receptor depths in both conventions, module, warnings and notes, as lines of text."""
    rows = [
        *_rows(rig),
        *(("warning", text) for text in rig.warnings),
        *(("note", text) for text in rig.notes),
    ]
    head = f"{rig.name}: {rig.title}" if rig.title else rig.name
    return "\n".join([head, *(line for label, text in rows for line in _wrapped(label, text))])


def rig_for_methods(rig: Rig) -> str:
    """Return what a methods section says of a rig: the summary with its driver, without warnings and notes.

    A title is left out where the module has a name, since it may describe the module that was there before.
    """
    rows = _rows(rig)
    if rig.pump is not None:
        driver = rig.driver
        rows.append(
            (
                "driver",
                f"{driver.current_min_A:g} … ".replace("-", "−")
                + f"{driver.current_max_A:g} A, {driver.voltage_limit_V:g} V at most, "
                f"updated at {driver.update_Hz:g} Hz",
            )
        )
    named = "name" in json.loads(rig.document).get("module", {})
    head = f"{rig.name}: {rig.title}" if rig.title and not named else rig.name
    return "\n".join([head, *(line for label, text in rows for line in _wrapped(label, text.rstrip(".")))])


def _rows(rig: Rig) -> list[tuple[str, str]]:
    """Site, skin or load, and module or thermode, with their labels."""
    flux = -rig.resting_flux_W_per_m2
    how = "from the heat balance" if rig.skin.deep_C is None else "given"
    skin = [
        (
            "rest",
            f"skin {rig.skin.rest_C:.1f} °C, blood and deep tissue {rig.deep_C:.2f} °C ({how}), "
            f"{abs(flux):.0f} W/m² {'lost' if flux >= 0 else 'taken up'} by bare skin",
        ),
        ("receptors", str(rig.receptor_depths())),
    ]
    if (load := rig.bench_load) is not None:
        words = f"{load.capacity_J_per_K:.3g} J/K, {load.conductance_W_per_K:.3g} W/K to a room of {rig.deep_C:g} °C"
        skin = [("load", f"{with_article(load.site)} in place of skin: {words}; nothing is judged for people")]
    return [
        ("site", f"{rig.site}, {rig.contact.area_m2 * 1e4:g} cm² in contact"),
        *skin,
        ("module", rig.module_source) if rig.thermode is None else ("thermode", _thermode(rig.thermode)),
    ]


def _thermode(thermode: Thermode) -> str:
    fine = f"set-points in steps of {thermode.resolution_K:g} K" if thermode.resolution_K else "set-points of any step"
    return (
        f"{thermode.lowest_C:g} … {thermode.highest_C:g} °C at up to {thermode.slew_K_per_s:g} K/s, {fine} at "
        f"{thermode.update_Hz:g} Hz, followed with a lag of {thermode.lag_s:g} s; no module, no current"
    )


def _wrapped(label: str, text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=f"  {label:<11}", subsequent_indent=" " * 13)
