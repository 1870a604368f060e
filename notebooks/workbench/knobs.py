"""The usual unknowns as knobs: what is rarely known of contact, skin, person and driver, each with its range."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from thermicon.circuit import Rig
from thermicon.circuit.rig.module import ZERO_C_IN_K
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons.number_text import number, span
from thermicon.perception import Observer
from thermicon.perception.observer.observer import load_thresholds, observer_records
from thermicon.perception.observer.people import YOUNG_YEARS, age_factor

if TYPE_CHECKING:
    from thermicon.perception.observer.observer import Channel, Receptor

OLDEST_YEARS, YOUNGEST_YEARS = 100.0, 18.0
"""What ``age_factor`` covers."""
LIGHTEST_TIMES, FIRMEST_TIMES = 5.5, 0.5
"""Light touch of 3e-4 to 3e-3 m²·K/W, over the 5.4e-4 m²·K/W of the shipped rigs."""
LEAST_A = 0.1


@dataclass(frozen=True, slots=True)
class Knob:
    """One unknown: its range and step in its unit, the value that a rig has, what it changes, where its range is from.

    A knob with ``options`` is a choice among words, and has no range.
    """

    key: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    value: float | str
    what: str
    source: str
    options: tuple[str, ...] = ()

    def shown(self, value: float | str) -> str:
        """A value with its unit, as a label has it."""
        return value if isinstance(value, str) else f"{number(value, 2)} {self.unit}".strip()


class KnobResult(NamedTuple):
    """The rig and the observer with the knobs set, and a sentence for every value that could not be."""

    rig: Rig
    observer: Observer
    notes: tuple[str, ...]


@lru_cache(maxsize=32)
def knobs_of(rig: Rig) -> tuple[Knob, ...]:
    """Return the knobs of a rig, each at the value that the rig has."""
    known = load_thresholds()
    zone, spread = (known.one(name) for name in ("complete adaptation", "contact resistance spread"))
    lost = observer_records().one("sensitivity lost per decade", channel="cold")
    thermode = known.one("thermode area of the forced-choice thresholds")
    area = round(rig.contact.area_m2 * 1e4, 6)
    smallest = round(min(Rig.load(name).contact.area_m2 for name in rig_names()) * 1e4, 6)
    contact = f"light touch of 3e-4 to 3e-3 m²·K/W, as stated in the shipped rigs; {spread.source}"
    areas = f"the finger pad of the fingertip rig; {thermode.quantity}: {thermode.source}"
    return (
        Knob("contact", "contact resistance", "×", FIRMEST_TIMES, LIGHTEST_TIMES, 0.05, 1.0,
             "resistance between display and skin, as a multiple of the rig's", contact),
        Knob("area", "contact area", "cm²", min(smallest, area), max(thermode.interval[1], area), 0.5, area,
             "affects the heat needed, and thresholds, which fall with area", areas),
        Knob("rest", "rest temperature", "°C", min(zone.interval[0], rig.skin.rest_C),
             max(zone.interval[1], rig.skin.rest_C), 0.1, rig.skin.rest_C,
             "temperature of bare skin at rest, and baseline of icons that give none",
             f"{zone.quantity}: {zone.source}"),
        Knob("site", "site", "", 0.0, 0.0, 0.0, rig.site,
             "selects layers of skin, depths of receptors, thresholds and nerve path", "the shipped rigs",
             tuple(dict.fromkeys((rig.site, *_sites())))),
        Knob("age", "age", "years", YOUNGEST_YEARS, OLDEST_YEARS, 1.0, YOUNG_YEARS,
             "thresholds of both channels, each by its own loss per decade",
             f"{lost.quantity}: {lost.source}"),
        *([] if rig.thermode is not None else [_limit_knob(rig)]),  # a thermode has no current
    )  # fmt: skip


def _limit_knob(rig: Rig) -> Knob:
    module, limit = rig.module, rig.driver.current_max_A
    # Greatest cooling, with the cold plate at rest temperature, is at αT/R.
    greatest_A = module.seebeck_V_per_K * (rig.skin.rest_C + ZERO_C_IN_K) / module.resistance_ohm
    return Knob(
        "limit", "current limit", "A", min(LEAST_A, limit), max(math.floor(10 * greatest_A) / 10, limit), 0.05, limit,
        "largest current: limits how fast and how far temperature changes",
        "up to the current of greatest cooling of the rig's module",
    )  # fmt: skip


def apply(rig: Rig, values: Mapping[str, float | str], observer: Observer | None = None) -> KnobResult:
    """Return rig and observer with knobs set; what cannot be leaves them as they were before it, and says so.

    Knobs that are not named stay where they are. Raises KeyError for a name that no knob has.
    """
    table = {knob.key: knob for knob in knobs_of(rig)}
    if unknown := [key for key in values if key not in table]:
        raise KeyError(f"no knob is called {unknown[0]}; there are {', '.join(table)}")
    person, notes = Observer.load() if observer is None else observer, list[str]()
    wanted = {}
    for key, value in values.items():
        if wrong := _fault(table[key], value):
            notes.append(wrong)
        elif value != table[key].value:
            wanted[key] = value
    if (age := wanted.pop("age", None)) is not None:
        try:
            person = aged(person, float(age))
        except ValueError as wrong:
            notes.append(f"age stays at {table['age'].shown(table['age'].value)}: {wrong}")
        else:
            notes += _unusual(table["age"], age)
    # Site first: it brings layers and depths, and leaves what the other knobs are about.
    ordered = dict(sorted(wanted.items(), key=lambda item: item[0] != "site"))
    try:
        made = _held(_turned(rig, ordered))
        unusual = [said for key, value in ordered.items() for said in _unusual(table[key], value)]
        return KnobResult(made, person, (*notes, *unusual))
    except RigError:
        made = rig
    for key, value in ordered.items():
        try:
            made = _held(_turned(made, {key: value}, rig))
            notes += _unusual(table[key], value)
        except RigError as wrong:
            knob = table[key]
            before = f"{knob.label} stays at {knob.shown(knob.value)}, {knob.shown(value)} is not possible"
            notes.append(f"{before}: {str(wrong).splitlines()[0]}")
    return KnobResult(made, person, tuple(notes))


def aged(observer: Observer, age_years: float) -> Observer:
    """Return an observer of an age: thresholds times ``age_factor`` of their channel, as for drawn people."""

    def raised(channel: Channel) -> Receptor:
        receptor = observer.receptor(channel)
        return replace(receptor, threshold_drive=receptor.threshold_drive * age_factor(age_years, channel))

    return replace(observer, cold=raised("cold"), warm=raised("warm"))


def _turned(rig: Rig, values: Mapping[str, float | str], nominal: Rig | None = None) -> Rig:
    """The rig with these values; a multiple counts from the nominal rig. Raises RigError for what no rig can be."""
    changes: dict[str, object] = {}
    said: list[str] = []
    for key, value in values.items():
        match key, value:
            case "site", str(site):
                changes |= _skin_of(site)
                said.append(f"site={site}")
            case "contact", times:
                resistance = (nominal or rig).contact.resistance_m2K_per_W
                changes["contact.resistance_m2K_per_W"] = resistance * float(times)
            case _, amount:
                changes[_KEYS[key]] = float(amount)
    if not changes:
        return rig
    made = rig.with_(**changes)
    # A whole table of layers is no note for people: the site's name stands for it.
    kept = [text for text in made.changes if not (said and text.startswith("skin.") and "rest_C" not in text)]
    return replace(made, changes=(*kept, *said))


_KEYS = {"area": "contact.area_cm2", "rest": "skin.rest_C", "limit": "driver.current_limit_A"}
_OF_SITE = ("site", "cold_receptor_mm", "warm_receptor_mm", "depth_from", "layer", "elements")


def _held(rig: Rig) -> Rig:
    """The rig, if there is a current that holds its skin at rest; RigError otherwise. A thermode needs none."""
    if rig.thermode is None:
        steady_state(rig, "skin", rig.skin.rest_C)
    return rig


def _fault(knob: Knob, value: float | str) -> str | None:
    if knob.options:
        if value in knob.options:
            return None
        return f"{knob.label} stays at {knob.value}: {value} is not one of {', '.join(knob.options)}"
    if isinstance(value, str) or not math.isfinite(value):
        return f"{knob.label} stays at {knob.shown(knob.value)}: {value} is not a number"
    return None


def _unusual(knob: Knob, value: float | str) -> list[str]:
    if isinstance(value, str) or knob.low - 1e-9 <= value <= knob.high + 1e-9:
        return []
    return [f"{knob.label} of {knob.shown(value)} is outside the usual {span(knob.low, knob.high, knob.unit, 2)}"]


@lru_cache(maxsize=1)
def _sites() -> dict[str, str]:
    """The sites of the shipped rigs, with the first rig of each."""
    found: dict[str, str] = {}
    for name in rig_names():
        found.setdefault(Rig.load(name).site, name)
    return found


def _skin_of(site: str) -> dict[str, object]:
    """Keys of a rig file that make the skin of a site, as in the shipped rig for it; what lies deep stays the rig's."""
    import json

    skin = json.loads(Rig.load(_sites()[site]).document)["skin"]
    own = {key: skin.get(key) for key in _OF_SITE}
    own["depth_from"] = skin.get("depth_from", "surface")
    return {f"skin.{key}": value for key, value in own.items()}
