"""A layout: display elements at their places on the body."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from math import dist
from pathlib import Path
from typing import Literal

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import named_text, read_toml, shipped_names
from thermicon.base.files.records import shipped_records
from thermicon.base.words.clean_text import name_fault

from .faults import unusual
from .layoutfile import LayoutTable, Sink, Supply, by_name, read_layout_table
from .rig import AnyRig, Rig, rig_names
from .rigfile import RigError
from .usual import unusual_values

NEIGHBOURS = ((0.0, 0.022, 0.14), (0.5, 0.011, 0.07), (1.0, 0.006, 0.04), (2.0, 0.0014, 0.009))
"""Bare skin in mm between two elements, and by how much 1 K of one changes the other, in the mean and in its nearest
millimetre: solution in two dimensions of skin under elements 7.4 mm wide, after 10 s, by this project."""
_ELEMENTS = re.compile(rb"(?m)^\s*(\[\[\s*element\s*\]\]|element\s*=)")


@dataclass(frozen=True, slots=True)
class Element:
    """One display element.

    Parameters
    ----------
    rig
        What it is made of, and the skin under it.
    name
        By which icon sets address it; empty where it is the only one.
    place_m
        Where it is (x, y) in m; None where it is the only one.
    sink
        Name of the sink of the layout that it is on; None: that of its rig.
    gap_m
        Bare skin in m between it and the next element; None: not told.

    Raises
    ------
    RigError
        For a name that no element of a set can have.

    Examples
    --------
    >>> Element(Rig.load("thenar"), "left")
    Element(rig=Rig('thenar', ...), name='left', place_m=None, sink=None, gap_m=None)
    """

    rig: Rig
    name: str = ""
    place_m: tuple[float, float] | None = None
    sink: str | None = None
    gap_m: float | None = None

    def __post_init__(self) -> None:
        if self.name and (wrong := name_fault(self.name)):
            raise RigError(f"element: {wrong}")


@dataclass(frozen=True, slots=True)
class Layout:
    """Several display elements; a layout of one element is its rig.

    Parameters
    ----------
    elements
        The elements in their order.
    name, title
        Name of the layout, and one line for people.
    surfaces
        Whether elements are on one piece of skin, or apart, as on two hands.
    sinks, supply
        Bodies that several elements give their heat to, and what all drivers together may take; none where not told.
    lapse
        Share of trials (0–1) in which what people do besides, such as driving, makes them give any name.

    Raises
    ------
    RigError
        Without elements, where one of several has no name, or the name of another, and for a lapse beyond 0 to 1.

    Examples
    --------
    >>> rig = Rig.load("thenar")
    >>> Layout((Element(rig),)).alone is rig
    True
    """

    elements: tuple[Element, ...]
    name: str = ""
    title: str = ""
    surfaces: Literal["apart", "one"] = "apart"
    sinks: tuple[Sink, ...] = ()
    supply: Supply | None = None
    lapse: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "elements", tuple(self.elements))
        names = [element.name for element in self.elements]
        if not 0.0 <= self.lapse < 1.0:
            raise RigError(f"a lapse of {self.lapse:g} must lie in 0 to 1, a share of trials")
        if not names:
            raise RigError("a layout needs at least one element")
        if len(names) > 1 and "" in names:
            raise RigError("of several elements each needs a name; give all of them one")
        if again := next((name for place, name in enumerate(names) if name in names[:place]), None):
            raise RigError(f"two elements are called {again}; give each a name of its own")

    @staticmethod
    def of(rig: AnyLayout, site: str | None = None) -> Layout:
        """A layout as it is or by its name or file, or one with a single element, whose rig is that of `Rig.of`.

        >>> Layout.of("thenar").alone.name, [element.name for element in Layout.of("wheel").elements]
        ('thenar', ['left', 'right'])
        """
        if isinstance(rig, str | Path) and _is_layout(rig):
            return Layout.load(rig)
        return rig if isinstance(rig, Layout) else Layout((Element(Rig.of(rig, site)),))

    @staticmethod
    @checked
    def load(source: str | Path) -> Layout:
        """Return a shipped layout by name, or a layout from a `.toml` file; its rigs may be files beside it.

        Raises RigError with every fault of the file on a line of its own, or the nearest name where there is none.
        """
        text, where = named_text(source, layout_names(), "layout", RigError)
        table = read_layout_table(read_toml(text, where, "layout file", ("element",), RigError), where)
        try:
            elements = tuple(_element(table, place, Path(source).parent) for place in range(len(table.element)))
        except RigError as problem:
            raise RigError(f"{where}: {problem}") from None
        return Layout(elements, table.name, table.title, table.surfaces, tuple(table.sink), table.supply, table.lapse)

    def check_elements(self, names: Sequence[str]) -> None:
        """Raise RigError, with a cure, unless the layout has every element of a set; others may idle."""
        own = [element.name for element in self.elements]
        if not set(names) <= set(own):
            what = f"the rig {self.elements[0].rig.name} is one element: "
            if any(own):
                what = f"the layout {self.name or 'given'} has {', '.join(own)}: give elements these names, or "
            shipped = (Layout.load(name) for name in layout_names())
            fits = [each.name for each in shipped if {*names} <= {element.name for element in each.elements}]
            cure = f"give a layout that has them, such as {fits[0]}" if fits else "give the file of a layout with them"
            raise RigError(f"the icons play on {', '.join(names)}, and {what}{cure}")

    @property
    def document(self) -> str:
        """All that counts of the layout as JSON: layouts are equal if their documents are; of one, that of its rig."""
        if len(self.elements) == 1:
            return self.alone.document
        own = ("name", "place_m", "sink", "gap_m")
        told = {
            **{key: getattr(self, key) for key in ("name", "title", "surfaces", "lapse")},
            "sink": [sink.model_dump() for sink in self.sinks],
            "supply": self.supply and self.supply.model_dump(),
            "element": [
                {**{key: getattr(element, key) for key in own}, "rig": json.loads(element.rig.document)}
                for element in self.elements
            ],
        }
        return json.dumps(told, sort_keys=True, ensure_ascii=False)

    @property
    def toml(self) -> str:
        """The rig of the only element as the text of a rig file, or those of all, each once, under their names."""
        if len(self.elements) == 1:
            return self.alone.toml
        names: dict[Rig, list[str]] = {}
        for element in self.elements:
            names.setdefault(element.rig, []).append(element.name)
        return "\n".join(f"# {', '.join(named)}\n{rig.toml}" for rig, named in names.items())

    @property
    def near(self) -> tuple[tuple[int, int], ...]:
        """Places of any two elements between which warm and cold are one; who has no place is taken at the origin."""
        limit = shipped_records("whole-limits.toml", "severity", "cold_C").one("distance of opposite qualities").central
        at_m = [element.place_m or (0.0, 0.0) for element in self.elements]
        return tuple((a, b) for a, b in combinations(range(len(at_m)), 2) if dist(at_m[a], at_m[b]) < limit)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what is unusual about gaps, sinks and the supply; rigs have warnings of their own."""
        gaps = [element.gap_m for element in self.elements]
        told = {
            "element": [
                {"name": one.name, "gap_mm": 1e3 * one.gap_m if one.gap_m and place == gaps.index(one.gap_m) else None}
                for place, one in enumerate(self.elements)
            ],
            "sink": [sink.model_dump() for sink in self.sinks],
            "supply": {} if self.supply is None else self.supply.model_dump(),
        }
        close = []
        for gap in dict.fromkeys(gaps):
            if gap is not None and 1e3 * gap < NEIGHBOURS[-1][0]:
                at_mm, mean, near = zip(*NEIGHBOURS, strict=True)
                by = {"mean": np.interp(1e3 * gap, at_mm, mean), "near": np.interp(1e3 * gap, at_mm, near)}
                names = ", ".join(element.name for element in self.elements if element.gap_m == gap)
                close.append(unusual("close", names=names, gap=1e3 * gap, **by))
        if self.surfaces == "apart":
            for element, other in ((self.elements[a], self.elements[b]) for a, b in self.near):
                if element.place_m is not None and other.place_m is not None:
                    apart_mm = 1e3 * dist(element.place_m, other.place_m)
                    close.append(unusual("beside", names=f"{element.name} and {other.name}", apart=apart_mm))
        return tuple(by_name(fault.text, told) for fault in (*close, *unusual_values(told, "layout")))

    @property
    def alone(self) -> Rig:
        """The rig of the only element; raises RigError, with a cure, where there are several."""
        if len(self.elements) > 1:
            names = ", ".join(element.name for element in self.elements)
            here = f"{self.name or 'this'} is a layout of several elements ({names}), and one plays here"
            raise RigError(f"{here}; give the rig of one, such as {self.elements[0].rig.name}")
        return self.elements[0].rig


AnyLayout = Layout | AnyRig
"""What is taken where a layout is needed: the layout, or what is taken where a rig is."""


def layout_names() -> tuple[str, ...]:
    """Return the names of the shipped layouts, which `Layout.load` accepts."""
    return tuple(shipped_names("layouts"))


def _is_layout(source: str | Path) -> bool:
    """Whether a name or a file is that of a layout; no rig has elements."""
    if Path(source).is_file():
        with suppress(OSError), Path(source).open("rb") as opened:  # whose faults the reader of the file reports
            return _ELEMENTS.search(opened.read(1_000_000)) is not None
    return str(source) not in rig_names() and str(source) in layout_names()


def _element(table: LayoutTable, place: int, folder: Path) -> Element:
    """The element at a place of a table: all but its name and its place may be that of another."""
    element = table.element[place]
    first, *changed = reversed(table.chain(element))
    beside = folder / str(first.rig)
    rig = Rig.load(beside if beside.is_file() else str(first.rig))
    for each in (first, *changed):
        rig = rig.with_(**each.set) if each.set else rig
    sink = next((each.sink for each in table.chain(element) if each.sink is not None), None)
    gap = next((each.gap_mm for each in table.chain(element) if each.gap_mm is not None), None)
    return Element(rig, element.name, table.point_m(element), sink, None if gap is None else gap * 1e-3)
