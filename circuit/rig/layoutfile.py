"""The schema of a layout file."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import partial
from math import cos, sin, tau
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError

from thermicon.base.files.inputs import LONGEST_NAME, Place, key_faults
from thermicon.base.words.near_words import did_you_mean
from thermicon.icons.model.context import MOST_ELEMENTS

from . import faults as kinds
from .faults import KeyTable, unit_of
from .rigfile import RigError
from .usual import likely_unit

Millimetres = Annotated[float, Field(ge=-5000, le=5000)]
"""Farther apart than arms reach, elements are not on one person."""


class ElementTable(KeyTable):
    """One element: its rig with changes, or another element that it is like, and where it is."""

    name: Annotated[kinds.Name, Field(max_length=LONGEST_NAME)]
    rig: kinds.Text | None = None
    like: kinds.Name | None = None
    set: dict[kinds.Text, Any] = Field(default_factory=dict)
    place_mm: Annotated[list[Millimetres], BeforeValidator(lambda place: place if isinstance(place, list) else [place])]
    gap_mm: Annotated[float, Field(ge=0, le=1000)] | None = None
    sink: kinds.Name | None = None

    def faults(self) -> Iterable[str]:
        """No rig, or two."""
        if (self.rig is None) == (self.like is None):
            yield f"{self.name} needs either a rig, or like with the name of another element"


class Sink(KeyTable):
    """A body that several elements give their heat to: its resistance to the air in K/W, for all of them together.

    With its heat capacity in J/K, where that is known, it follows their mean and not each peak.
    """

    name: kinds.Name
    resistance_K_per_W: kinds.Ideal
    capacity_J_per_K: kinds.Ideal | None = None


class Supply(KeyTable):
    """What all drivers together may take: current A, power W."""

    current_limit_A: kinds.Amperes
    power_limit_W: Annotated[float, Field(gt=0, le=1e5)]


class LayoutTable(KeyTable):
    """A whole layout file."""

    format: Literal[1]
    name: Annotated[kinds.Name, Field(max_length=LONGEST_NAME)]
    title: kinds.Text = ""
    surfaces: Literal["apart", "one"]
    around_mm: Annotated[float, Field(ge=10, le=2000)] | None = None
    lapse: Annotated[float, Field(ge=0)] = 0.0
    element: list[ElementTable]
    sink: list[Sink] = Field(default_factory=list)
    supply: Supply | None = None
    source: dict[kinds.Text, kinds.Paragraph] = Field(default_factory=dict)

    def faults(self) -> Iterable[str]:
        """Names that mean two things or nothing, elements that are like each other in a circle, impossible places."""
        names, sinks = [item.name for item in self.element], [item.name for item in self.sink]
        for what, listed in (("element", names), ("sink", sinks)):
            for name in (name for name, count in Counter(listed).items() if count > 1):
                yield f"two {what}s are called {name}; give each a name of its own"
        if not 2 <= len(names) <= MOST_ELEMENTS:
            yield f"a layout has 2 to {MOST_ELEMENTS} elements, not {len(names)}; for one, give its rig"
        if self.lapse >= 1.0:
            yield f"lapse = {self.lapse:g} is no share of trials below 1; for per cent, write {self.lapse / 100:g}"
        if "all" in names:
            yield '"all" means every element, and cannot be the name of one; give that element another name'
        likes = {item.name: item.like for item in self.element}
        for item in self.element:
            if item.like is not None and item.like not in likes:
                yield f"{item.name} is like {item.like}, which is not an element; {did_you_mean(item.like, names)}"
            elif len(self.chain(item)) > len(names):
                yield f"{item.name} is like {item.like}, in a circle that has no rig; give one of the elements a rig"
            if item.sink is not None and item.sink not in sinks:
                cure = did_you_mean(item.sink, sinks) if sinks else "remove its sink, or describe it in the file"
                yield f"{item.name} is on {item.sink}, which is no [[sink]]; {cure}"
            if len(item.place_mm) != (2 if self.around_mm is None else 1):
                shape = "[x, y]" if self.around_mm is None else "a length around the circle, one number"
                yield f"{item.name}: place_mm is {shape}"
        for sink in (sink for sink in sinks if sink not in {item.sink for item in self.element}):
            yield f"no element is on the sink {sink}; remove it, or name it as sink of an element"
        if any(len(item.place_mm) != (2 if self.around_mm is None else 1) for item in self.element):
            return
        places = {item.name: tuple(round(1e6 * length) for length in self.point_m(item)) for item in self.element}
        if twice := next((place for place, count in Counter(places.values()).items() if count > 1), None):
            here = [name for name, place in places.items() if place == twice]
            yield f"{' and '.join(here)} are at one place; give each a place_mm of its own"

    def chain(self, element: ElementTable) -> list[ElementTable]:
        """An element, the one that it is like, and so on; longer than there are elements in a circle."""
        known, found = {each.name: each for each in self.element}, [element]
        while found[-1].like in known and len(found) <= len(known):
            found.append(known[str(found[-1].like)])
        return found

    def point_m(self, element: ElementTable) -> tuple[float, float]:
        """Where an element is, in m: a length around a circle becomes a point of its plane."""
        if self.around_mm is None:
            return element.place_mm[0] * 1e-3, element.place_mm[1] * 1e-3
        angle, radius = tau * element.place_mm[0] / self.around_mm, self.around_mm * 1e-3 / tau
        return radius * cos(angle), radius * sin(angle)


def read_layout_table(document: Mapping[str, Any], where: str) -> LayoutTable:
    """Return the validated table of a layout document, or raise RigError with all its faults at once."""
    try:
        return LayoutTable.model_validate(dict(document))
    except ValidationError as problem:
        faults = key_faults(problem, _nearest, unit_of, likely_unit=partial(likely_unit, of="layout"))
        raise RigError("\n".join(f"{where}: {by_name(fault, document)}" for fault in faults)) from None


def by_name(told: str, document: Mapping[str, Any]) -> str:
    """Name the element, or the sink, in a message about a key such as `element.1.gap_mm`.

    >>> by_name("element.0.gap_mm = 9000 mm: must be at most 5000 mm", {"element": [{"name": "left"}]})
    'left: gap_mm = 9000 mm: must be at most 5000 mm'
    """
    found = re.match(r"(element|sink)\.(\d+)\.", told)
    name = found and document[found[1]][int(found[2])].get("name")
    return f"{name}: {told[found.end() :]}" if found and isinstance(name, str) else told


def _nearest(parts: Place) -> str:
    tables: dict[str, type[KeyTable]] = {"element": ElementTable, "sink": Sink, "supply": Supply}
    table = tables.get(str(parts[0]), LayoutTable) if len(parts) > 1 else LayoutTable
    return did_you_mean(str(parts[-1]), list(table.model_fields))
