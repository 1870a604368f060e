"""A rig in words."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING

from thermicon.base.files.inputs import shipped_names
from thermicon.base.files.records import shipped_records
from thermicon.base.words.number_text import signed

from .faults import Unusual, unusual
from .module import Extraction
from .modules import build_of, module_names
from .rigfile import Thermode
from .settings import changed
from .uncertainty import tightened
from .usual import unusual_values

if TYPE_CHECKING:
    from .parts import Contact
    from .rig import Rig

WIDTH = 118
PLATE_KEYS = ("module.hot_plate_J_per_K", "module.cold_plate_J_per_K")
SAME_FACE = 0.01
"""Share by which a contact in cm² may differ from the face of a module by rounding alone."""
PLATE_SHARE = 0.2
"""Plates on record are assumed from the footprint, within 20 % for ceramics of 0.5 to 0.8 mm."""

LIVING_C = (28.0, 38.5)
"""Blood in a limb is between that of a cold hand and a feverish core; assumed, and only warned about."""

STEP_S, STEPS = 0.01, 2.0
"""Longest step of the solver, and how many a plate must take to follow: with fewer it is some 0.03 K off, or more."""

HIGH_RESTING_FLUX_W_PER_M2 = 150.0
"""Bare skin in still air loses 40 to 120 W/m²; above this, the rig warns."""


def rig_summary(rig: Rig, for_methods: bool = False) -> str:
    """What to know of a rig, as lines; a methods section has its driver, but no title that may be out of date."""
    flux = -rig.resting_flux_W_per_m2
    how = "from the heat balance" if rig.skin.deep_C is None else "given"
    lost = f"{abs(flux):.0f} W/m² {'lost' if flux >= 0 else 'taken up'} by bare skin"
    rows = [
        ("site", f"{rig.site}, {rig.contact.area_m2 * 1e4:g} cm² in contact{_resistance(rig.contact)}"),
        ("rest", f"skin {rig.skin.rest_C:.1f} °C, blood and deep tissue {rig.deep_C:.2f} °C ({how}), {lost}"),
        ("receptors", rig.skin.receptor_words()),
        ("module", rig.module_source) if rig.thermode is None else ("thermode", _thermode(rig.thermode)),
    ]
    named = for_methods and "name" in json.loads(rig.document).get("module", {})
    if not for_methods:
        rows += [*(("warning", text) for text in rig.warnings), *(("note", text) for text in rig.notes)]
    elif rig.pump is not None:
        low, driver = signed(rig.driver.current_min_A), rig.driver
        limits = f"{low} … {driver.current_max_A:g} A, {driver.voltage_limit_V:g} V at most"
        rows.append(("driver", f"{limits}, updated at {driver.update_Hz:g} Hz"))
    lines = [f"{rig.name}: {rig.title}" if rig.title and not named else rig.name]
    for label, text in rows:
        said, first = text.rstrip(".") if for_methods else text, f"  {label:<11}"
        lines += textwrap.wrap(said, WIDTH, initial_indent=first, subsequent_indent=" " * 13)
    return "\n".join(lines)


def _resistance(contact: Contact) -> str:
    for record in shipped_records("contacts.toml"):
        low, high = record.interval
        if low <= contact.resistance_m2K_per_W <= high:
            return f", {contact.resistance_m2K_per_W:g} m²K/W ({record.method}: {low:g} to {high:g})"
    return f", {contact.resistance_m2K_per_W:g} m²K/W"


def _thermode(thermode: Thermode) -> str:
    fine = f"set-points in steps of {thermode.resolution_K:g} K" if thermode.resolution_K else "set-points of any step"
    return (
        f"{thermode.lowest_C:g} … {thermode.highest_C:g} °C at up to {thermode.slew_K_per_s:g} K/s, {fine} at "
        f"{thermode.update_Hz:g} Hz, followed with a lag of {thermode.lag_s:g} s; no module, no current"
    )


@lru_cache(maxsize=512)
def rig_warnings(rig: Rig) -> tuple[Unusual, ...]:
    """Return everything unusual: heat loss, blood, loosened limits, origin of the module's numbers."""
    pump = () if rig.pump is None else (*_driver(rig), *rig.pump.origin.warnings, *_module(rig))
    return (*_skin(rig), *_limits(rig), *pump, *_site(rig), *unusual_values(json.loads(rig.document)))


def _skin(rig: Rig) -> Iterator[Unusual]:
    if rig.skin.own:
        yield unusual("receptors")
    loss_W_per_m2 = -rig.resting_flux_W_per_m2
    if loss_W_per_m2 > HIGH_RESTING_FLUX_W_PER_M2:
        yield unusual("flux", loss=loss_W_per_m2, most=HIGH_RESTING_FLUX_W_PER_M2)
    if rig.deep_C < rig.skin.rest_C:
        yield unusual("cold_blood", rig=rig)
    if not LIVING_C[0] <= rig.deep_C <= LIVING_C[1]:
        yield unusual("living", rig=rig, low=LIVING_C[0], high=LIVING_C[1])


def _limits(rig: Rig) -> Iterator[Unusual]:
    """Limits and uncertainties that are looser than shipped, void, or passed at rest."""
    limits, rest_C = rig.limits, rig.skin.rest_C
    if limits.loosened:
        yield unusual("loosened", words="; ".join(limits.loosened), reason=limits.reason)
    if claims := tightened(rig.uncertainty):
        yield unusual("milder", words="; ".join(claims), reason=rig.uncertainty.reason)
    if (rule := limits.passed_at_rest(rest_C)) is not None:
        side, colour = "above" if rule.upper else "below", "red" if rule.severity == "hard" else "amber"
        limit = signed(rule.limit)
        yield unusual("at_rest", rest=rest_C, rule=rule, side=side, limit=limit, colour=colour)


def _driver(rig: Rig) -> Iterator[Unusual]:
    driver, stored = rig.driver, rig.module.cold_plate_J_per_K
    least_s = STEPS * min(STEP_S, 1.0 / driver.update_Hz)
    through = rig.contact.area_m2 / rig.contact.resistance_m2K_per_W + 1.0 / rig.module.thermal_resistance_K_per_W
    if stored < least_s * through:
        numbers = {"lag": 1e3 * stored / through, "least": 1e3 * least_s, "enough": 1.05 * least_s * through}
        yield unusual("fast_plate", stored=stored, rate=1.05 * STEPS * through / stored, **numbers)

    module, limit = rig.module, driver.current_max_A
    figures = Extraction(module.seebeck_V_per_K, module.resistance_ohm, module.thermal_resistance_K_per_W, 0.0)
    imax_A = figures.greatest(rig.heat_sink.temperature_C)[1]
    if limit > 2.0 * imax_A and "module.name" not in changed(rig.changes):
        yield unusual("far_past_imax", limit=limit, imax=imax_A, times=limit / imax_A)


def _module(rig: Rig) -> Iterator[Unusual]:
    """What does not suit a shipped module: plates of a former one, the face, the driver's limit."""
    document, stated = json.loads(rig.document), changed(rig.changes)
    name = document.get("module", {}).get("name")
    if name not in module_names():
        return
    build, area_cm2, keys = build_of(name), 1e4 * rig.contact.area_m2, " and ".join(PLATE_KEYS)
    hot, cold, replaced = rig.module.hot_plate_J_per_K, rig.module.cold_plate_J_per_K, stated.get("module.name") == name
    if replaced and build.plate_J_per_K is None and not set(PLATE_KEYS) <= set(stated):
        yield unusual("plates_unknown", name=name, hot=hot, cold=cold, keys=keys)
    plate, known = build.plate_J_per_K, {*stated, *document.get("source", {})}
    own = [each for key, each in zip(PLATE_KEYS, (hot, cold), strict=True) if key not in known]
    if plate is not None and any(abs(each - plate) > PLATE_SHARE * plate for each in own):
        yield unusual("plates_other", name=name, keys=keys, hot=hot, cold=cold, plate=plate)
    if build.face_cm2 is not None and area_cm2 > (1.0 + SAME_FACE) * build.face_cm2:
        yield unusual("face_small", name=name, area=area_cm2, face=build.face_cm2)
    if replaced and rig.driver.current_max_A > build.i_max_A:
        yield unusual("past_imax", name=name, limit=rig.driver.current_max_A, imax=build.i_max_A)


def _site(rig: Rig) -> Iterator[Unusual]:
    stated = changed(rig.changes)
    if "skin.site" not in stated or any(key.split(".")[:2] == ["skin", "layer"] for key in stated):
        return
    shipped = map(type(rig).load, sorted(shipped_names("rigs"), key=lambda name: name != "thenar"))
    there = [each for each in shipped if each.site == rig.site]
    if any(each.skin.layers == rig.skin.layers for each in there):
        return
    names = " or ".join(f"rig {each.name}" for each in there)
    cure = f"use {names}, or set skin.layer" if there else "use a rig file of that site, or set skin.layer"
    yield unusual("site", rig=rig, cure=cure)
