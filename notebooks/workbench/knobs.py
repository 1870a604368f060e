"""Knobs for the usual unknowns of a rig."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from thermicon.base.words.number_text import number, span
from thermicon.circuit import Rig
from thermicon.circuit.rig.module import ZERO_C_IN_K
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.steady import steady_state
from thermicon.perception.observer.observer import load_thresholds

LIGHTEST_TIMES, FIRMEST_TIMES = 5.5, 0.5
"""Light touch of 3e-4 to 3e-3 m²·K/W, over the 5.4e-4 m²·K/W of the shipped rigs."""
LEAST_A = 0.1


@dataclass(frozen=True, slots=True)
class Knob:
    """One unknown: its range and step in its unit, the value that a rig has, what it changes, where its range is from.

    ``key`` is that of the rig file, whose value is ``times`` that of the knob.
    """

    key: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    value: float
    what: str
    source: str
    times: float = 1.0

    def shown(self, value: float) -> str:
        """A value with its unit, as a label has it."""
        return f"{number(value, 2)} {self.unit}"


@lru_cache(maxsize=32)
def knobs_of(rig: Rig) -> tuple[Knob, ...]:
    """Return the knobs of a rig, each at the value that the rig has."""
    known = load_thresholds()
    zone, spread = (known.one(name) for name in ("complete adaptation", "contact resistance spread"))
    thermode = known.one("thermode area of the forced-choice thresholds")
    area = round(rig.contact.area_m2 * 1e4, 6)
    smallest = round(min(Rig.load(name).contact.area_m2 for name in rig_names()) * 1e4, 6)
    contact = f"light touch of 3e-4 to 3e-3 m²·K/W, as stated in the shipped rigs; {spread.source}"
    areas = f"the finger pad of the fingertip rig; {thermode.quantity}: {thermode.source}"
    knobs = (
        Knob("contact.resistance_m2K_per_W", "contact resistance", "×", FIRMEST_TIMES, LIGHTEST_TIMES, 0.05, 1.0,
             "resistance between display and skin, as a multiple of the rig's", contact,
             times=rig.contact.resistance_m2K_per_W),
        Knob("contact.area_cm2", "contact area", "cm²", min(smallest, area), max(thermode.interval[1], area), 0.5, area,
             "affects the heat needed, and thresholds, which fall with area", areas),
        Knob("skin.rest_C", "rest temperature", "°C", min(zone.interval[0], rig.skin.rest_C),
             max(zone.interval[1], rig.skin.rest_C), 0.1, rig.skin.rest_C,
             "temperature of bare skin at rest, and baseline of icons that give none",
             f"{zone.quantity}: {zone.source}"),
    )  # fmt: skip
    if rig.thermode is not None:  # it has no current
        return knobs
    module, limit = rig.module, rig.driver.current_max_A
    # Greatest cooling, with the cold plate at rest temperature, is at αT/R.
    greatest_A = module.seebeck_V_per_K * (rig.skin.rest_C + ZERO_C_IN_K) / module.resistance_ohm
    return (
        *knobs,
        Knob("driver.current_limit_A", "current limit", "A", min(LEAST_A, limit),
             max(math.floor(10 * greatest_A) / 10, limit), 0.05, limit,
             "largest current: limits how fast and how far temperature changes",
             "up to the current of greatest cooling of the rig's module"),
    )  # fmt: skip


def turned(rig: Rig, values: Mapping[str, float]) -> tuple[Rig, tuple[str, ...]]:
    """Return the rig with knobs set, one by one, and what is to be said of it.

    A value that cannot be leaves the rig as it was before it. Knobs that are not named stay where they are.
    """
    table = {knob.key: knob for knob in knobs_of(rig)}
    made, notes = rig, list[str]()
    for key, value in values.items():
        knob = table[key]
        try:
            changed = made.with_(**{key: value * knob.times})
            if changed.thermode is None:  # there must be a current that holds its skin at rest
                steady_state(changed, "skin", changed.skin.rest_C)
        except RigError as wrong:
            before = f"{knob.label} stays at {knob.shown(knob.value)}, {knob.shown(value)} is not possible"
            notes.append(f"{before}: {str(wrong).splitlines()[0]}")
            continue
        made = changed
        if not knob.low - 1e-9 <= value <= knob.high + 1e-9:
            usual = span(knob.low, knob.high, knob.unit, 2)
            notes.append(f"{knob.label} of {knob.shown(value)} is outside the usual {usual}")
    return made, tuple(notes)
