"""What is unusual about a rig: sentences for people who did not write its file."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import TYPE_CHECKING

from .modules import beyond_the_face, module_names, unlike_before, unlike_record
from .uncertainty import tightened

if TYPE_CHECKING:
    from .rig import Rig

PLATE_KEYS = ("hot_plate_J_per_K", "cold_plate_J_per_K")
PLATE_SHARE = 0.2
"""Plates on record are assumed from the footprint, within 20 % for ceramics of 0.5 to 0.8 mm."""

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
    sentences = [] if rig.bench_load is not None else _skin_sentences(rig)
    if loosened := rig.limits.loosened:
        sentences.append(f"limits of safety are loosened: {'; '.join(loosened)}. Reason given: {rig.limits.reason}")
    if claims := tightened(rig.uncertainty):
        sentences.append(
            f"the worst case of safety is milder: {'; '.join(claims)}. Reason given: {rig.uncertainty.reason}"
        )
    sentences += rig.limits.hidden
    if resting := rig.limits.passed_at_rest(rig.skin.rest_C):
        sentences.append(resting)
    sentences += _beyond_the_command(rig) + _faster_than_steps(rig)
    origin = () if rig.pump is None else rig.pump.origin.warnings
    left = (*_left_from_another_module(rig), *_plates_of_another_module(rig), *_left_from_another_site(rig))
    return (*sentences, *origin, *left)


def _skin_sentences(rig: Rig) -> list[str]:
    """What is unusual about heat loss and blood."""
    sentences = []
    loss_W_per_m2 = -rig.resting_flux_W_per_m2
    if loss_W_per_m2 > HIGH_RESTING_FLUX_W_PER_M2:
        sentences.append(
            f"skin at rest loses {loss_W_per_m2:.0f} W/m², over the {HIGH_RESTING_FLUX_W_PER_M2:g} W/m² "
            f"that bare skin in room air can lose"
        )
    if rig.deep_C < rig.skin.rest_C:
        sentences.append(f"blood at {rig.deep_C:.2f} °C is colder than the resting surface at {rig.skin.rest_C:g} °C")
    if not LIVING_C[0] <= rig.deep_C <= LIVING_C[1]:
        sentences.append(
            f"blood at {rig.deep_C:.2f} °C lies outside the {LIVING_C[0]:g} … {LIVING_C[1]:g} °C of living limbs; "
            f"check skin.rest_C and the ambient"
        )
    return sentences


def _beyond_the_command(rig: Rig) -> list[str]:
    """A sentence where the usual ±10 V of a converter do not command the whole current limit."""
    if rig.pump is None:
        return []
    driver = rig.driver
    gain, limit = driver.transconductance_A_per_V, max(driver.current_max_A, -driver.current_min_A)
    if limit <= USUAL_COMMAND_V * gain * (1.0 + 1e-9):
        return []
    return [
        f"driver.current_limit_A = {limit:g} A takes {limit / gain:.3g} V of command at "
        f"driver.transconductance_A_per_V = {gain:g}; cards that end at ±{USUAL_COMMAND_V:g} V, such as those of NI, "
        f"reach {USUAL_COMMAND_V * gain:g} A: set driver.transconductance_A_per_V to that of your driver "
        f"({limit / USUAL_COMMAND_V:.3g} or more for {limit:g} A), or the limit to {USUAL_COMMAND_V * gain:g} A"
    ]


def _faster_than_steps(rig: Rig) -> list[str]:
    """A sentence where the cold plate follows what it touches within two steps of the solver."""
    if rig.pump is None:
        return []
    stored, limit = rig.module.cold_plate_J_per_K, STEPS * min(STEP_S, 1.0 / rig.driver.update_Hz)
    through = rig.contact.area_m2 / rig.contact.resistance_m2K_per_W + 1.0 / rig.module.thermal_resistance_K_per_W
    if stored >= limit * through:
        return []
    return [
        f"module.cold_plate_J_per_K = {stored:g} J/K follows what it touches within {1e3 * stored / through:.2g} ms, "
        f"under the {1e3 * limit:.3g} ms of two steps of the solver, and may be tenths of a kelvin off: give it "
        f"{1.05 * limit * through:.2g} J/K or more, with what is fixed to it, or set driver.update_Hz to "
        f"{1.05 * STEPS * through / stored:.0f} or more"
    ]


def _left_from_another_site(rig: Rig) -> list[str]:
    """A sentence where a change names another site and leaves the skin as it was."""
    from .rig import Rig, rig_names

    changed = [text.partition("=")[0].strip() for text in rig.changes]
    if "skin.site" not in changed or any(key.startswith("skin.layer") for key in changed):
        return []
    there = [shipped for name in rig_names() if (shipped := Rig.load(name)).site == rig.site]
    if any(shipped.skin.layers == rig.skin.layers for shipped in there):
        return []
    names = " or ".join(f"--rig {shipped.name}" for shipped in there)
    cure = f"use {names}, or set skin.layer" if there else "use a rig file of that site, or set skin.layer"
    return [
        f"skin.site = {rig.site} changes the name of the site, and thresholds and nerve path that go by it; layers and "
        f"receptor depths are still those of rig {rig.name}: {cure}, skin.cold_receptor_mm and skin.warm_receptor_mm"
    ]


def _plates_of_another_module(rig: Rig) -> list[str]:
    """A sentence where a rig names a module and has the plates of another, without a source for them."""
    document = json.loads(rig.document)
    name, plates = document.get("module", {}).get("name"), [f"module.{key}" for key in PLATE_KEYS]
    stated = {*document.get("source", {}), *(text.partition("=")[0] for text in rig.changes)}
    if name not in module_names() or stated & set(plates):
        return []
    pair = (rig.module.hot_plate_J_per_K, rig.module.cold_plate_J_per_K)
    return unlike_record(str(name), pair, PLATE_SHARE)


def _larger_than_its_module(rig: Rig) -> list[str]:
    """A sentence where more skin is in contact than the face of a shipped module has."""
    name = json.loads(rig.document).get("module", {}).get("name")
    return [] if name not in module_names() else beyond_the_face(name, 1e4 * rig.contact.area_m2)


def _left_from_another_module(rig: Rig) -> list[str]:
    """Sentences on what still fits the former module, where a change names another one."""
    changed = dict(text.split("=", 1) for text in rig.changes)
    if (name := changed.get("module.name")) not in module_names():
        return _larger_than_its_module(rig)
    plates = (rig.module.hot_plate_J_per_K, rig.module.cold_plate_J_per_K)
    return unlike_before(str(name), 1e4 * rig.contact.area_m2, rig.driver.current_max_A, plates, [*changed])
