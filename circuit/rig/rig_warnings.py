"""What is unusual about a rig: sentences for people who did not write its file."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING

from thermicon.icons.number_text import signed

from .modules import Build, build_of, module_names
from .settings import changed
from .uncertainty import tightened

if TYPE_CHECKING:
    from .rig import Rig

PLATE_KEYS = ("module.hot_plate_J_per_K", "module.cold_plate_J_per_K")
PLATE_SHARE = 0.2
"""Plates on record are assumed from the footprint, within 20 % for ceramics of 0.5 to 0.8 mm."""

SAME_FACE = 0.01
"""Share by which a contact in cm² may differ from the face of a module by rounding alone."""

LIVING_C = (28.0, 38.5)
"""Blood in a limb is between that of a cold hand and a feverish core; assumed, and only warned about."""

USUAL_COMMAND_V = 10.0
"""Analogue outputs of laboratories end here; larger commands need another output or more gain."""

STEP_S, STEPS = 0.01, 2.0
"""Longest step of the solver, and how many a plate must take to follow: with fewer it is some 0.03 K off, or more."""

HIGH_RESTING_FLUX_W_PER_M2 = 150.0
"""Bare skin in still air loses 40 to 120 W/m²; above this, the rig warns."""


@lru_cache(maxsize=512)
def rig_warnings(rig: Rig) -> tuple[str, ...]:
    """Return a sentence for everything unusual: heat loss, blood, loosened limits, origin of the module's numbers.

    >>> from thermicon.circuit import Rig
    >>> rig_warnings(Rig.load("thenar").with_(**{"ambient.film_W_per_m2K": 30}))[0]
    'skin at rest loses ... W/m², over the 150 W/m² that bare skin in room air can lose'
    """
    skin = _skin(rig) if rig.bench_load is None else ()
    if rig.pump is None:
        return (*skin, *_limits(rig), *_site(rig))
    return (*skin, *_limits(rig), *_driver(rig), *rig.pump.origin.warnings, *_module(rig), *_site(rig))


def _skin(rig: Rig) -> Iterator[str]:
    """Heat loss and blood."""
    loss_W_per_m2 = -rig.resting_flux_W_per_m2
    if loss_W_per_m2 > HIGH_RESTING_FLUX_W_PER_M2:
        yield (
            f"skin at rest loses {loss_W_per_m2:.0f} W/m², over the {HIGH_RESTING_FLUX_W_PER_M2:g} W/m² "
            f"that bare skin in room air can lose"
        )
    if rig.deep_C < rig.skin.rest_C:
        yield f"blood at {rig.deep_C:.2f} °C is colder than the resting surface at {rig.skin.rest_C:g} °C"
    if not LIVING_C[0] <= rig.deep_C <= LIVING_C[1]:
        yield (
            f"blood at {rig.deep_C:.2f} °C lies outside the {LIVING_C[0]:g} … {LIVING_C[1]:g} °C of living limbs; "
            f"check skin.rest_C and the ambient"
        )


def _limits(rig: Rig) -> Iterator[str]:
    """Limits and uncertainties that are looser than shipped, void, or passed at rest."""
    limits, rest_C = rig.limits, rig.skin.rest_C
    if loosened := limits.loosened:
        yield f"limits of safety are loosened: {'; '.join(loosened)}. Reason given: {limits.reason}"
    if claims := tightened(rig.uncertainty):
        yield f"the worst case of safety is milder: {'; '.join(claims)}. Reason given: {rig.uncertainty.reason}"
    for hard, soft in limits.hidden:
        side = "below" if hard.upper else "above"
        yield (
            f"safety.{hard.key} = {signed(hard.limit)} {hard.unit} is hard and lies {side} the soft limit of "
            f"{signed(soft.limit)} {soft.unit}, so that nothing is amber before it is red; set "
            f"safety.{soft.key} {side} {signed(hard.limit)} {hard.unit} too"
        )
    if (rule := limits.passed_at_rest(rest_C)) is not None:
        side, colour = "above" if rule.upper else "below", "red" if rule.severity == "hard" else "amber"
        yield (
            f"the resting skin of {rest_C:g} °C (skin.rest_C) is itself {side} the {rule.severity} limit "
            f"safety.{rule.key} = {signed(rule.limit)} °C, so that every icon that begins there is {colour} "
            f"from its start; change the limit or the baseline"
        )


def _driver(rig: Rig) -> Iterator[str]:
    """A current limit that usual converters cannot command, and a plate that is faster than the solver."""
    driver, stored = rig.driver, rig.module.cold_plate_J_per_K
    gain, limit = driver.transconductance_A_per_V, max(driver.current_max_A, -driver.current_min_A)
    if limit > USUAL_COMMAND_V * gain * (1.0 + 1e-9):
        yield (
            f"driver.current_limit_A = {limit:g} A takes {limit / gain:.3g} V of command at "
            f"driver.transconductance_A_per_V = {gain:g}; cards that end at ±{USUAL_COMMAND_V:g} V, such as those of "
            f"NI, reach {USUAL_COMMAND_V * gain:g} A: set driver.transconductance_A_per_V to that of your driver "
            f"({limit / USUAL_COMMAND_V:.3g} or more for {limit:g} A), or the limit to {USUAL_COMMAND_V * gain:g} A"
        )
    least_s = STEPS * min(STEP_S, 1.0 / driver.update_Hz)
    through = rig.contact.area_m2 / rig.contact.resistance_m2K_per_W + 1.0 / rig.module.thermal_resistance_K_per_W
    if stored < least_s * through:
        yield (
            f"module.cold_plate_J_per_K = {stored:g} J/K follows what it touches within {1e3 * stored / through:.2g} "
            f"ms, under the {1e3 * least_s:.3g} ms of two steps of the solver, and may be tenths of a kelvin off: give "
            f"it {1.05 * least_s * through:.2g} J/K or more, with what is fixed to it, or set driver.update_Hz to "
            f"{1.05 * STEPS * through / stored:.0f} or more"
        )


def _module(rig: Rig) -> Iterator[str]:
    """What does not suit a shipped module: the face, what a former one left behind, plates without a source."""
    document, stated = json.loads(rig.document), changed(rig.changes)
    name = document.get("module", {}).get("name")
    if name not in module_names():
        return
    build, area_cm2 = build_of(name), 1e4 * rig.contact.area_m2
    plates, replaced = (rig.module.hot_plate_J_per_K, rig.module.cold_plate_J_per_K), stated.get("module.name") == name
    if replaced and build.plate_J_per_K is None and not set(PLATE_KEYS) <= set(stated):
        yield (
            f"module {name}: its plates are unknown, so the rig keeps its own, {plates[0]:g} (hot) and "
            f"{plates[1]:g} J/K (cold); set {' and '.join(PLATE_KEYS)}"
        )
    yield from _face(name, build, area_cm2, replaced and "contact.area_cm2" not in stated)
    if replaced and rig.driver.current_max_A > build.i_max_A:
        yield (
            f"module {name}: driver.current_limit_A = {rig.driver.current_max_A:g} A is above its Imax of "
            f"{build.i_max_A:g} A, past which more current cools less; set it to at most that"
        )
    plate = build.plate_J_per_K
    if {*document.get("source", {}), *stated} & set(PLATE_KEYS) or plate is None:
        return
    if any(abs(each - plate) > PLATE_SHARE * plate for each in plates):
        yield (
            f"module {name}: {' and '.join(PLATE_KEYS)} are {plates[0]:g} and {plates[1]:g} J/K, those on record for "
            f"it {plate:g} J/K each: set both to that, or state in [source] where yours are from"
        )


def _face(name: str, build: Build, area_cm2: float, stays: bool) -> Iterator[str]:
    """More in contact than the face of a shipped module, or, where the area `stays` that of another, less."""
    face_cm2 = build.face_cm2
    if face_cm2 is not None and area_cm2 > (1.0 + SAME_FACE) * face_cm2:
        yield (
            f"module {name}: contact.area_cm2 = {area_cm2:g} cm² is more than its face of {face_cm2:g} cm²; set "
            f"contact.area_cm2 to at most that"
        )
    elif stays and (face_cm2 is None or area_cm2 < (1.0 - SAME_FACE) * face_cm2):
        face = "not on record" if face_cm2 is None else f"{face_cm2:g} cm²"
        yield (
            f"module {name}: its face is {face}, and contact.area_cm2 stays the {area_cm2:g} cm² of the rig; set it to "
            f"what touches"
        )


def _site(rig: Rig) -> Iterator[str]:
    """A change that names another site and leaves the skin as it was."""
    from .rig import Rig, rig_names

    stated = changed(rig.changes)
    if "skin.site" not in stated or any(key.split(".")[:2] == ["skin", "layer"] for key in stated):
        return
    there = [shipped for name in rig_names() if (shipped := Rig.load(name)).site == rig.site]
    if any(shipped.skin.layers == rig.skin.layers for shipped in there):
        return
    names = " or ".join(f"--rig {shipped.name}" for shipped in there)
    cure = f"use {names}, or set skin.layer" if there else "use a rig file of that site, or set skin.layer"
    yield (
        f"skin.site = {rig.site} changes the name of the site, and thresholds and nerve path that go by it; layers and "
        f"receptor depths are still those of rig {rig.name}: {cure}, skin.cold_receptor_mm and skin.warm_receptor_mm"
    )
