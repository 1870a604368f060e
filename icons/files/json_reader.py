"""From the checked tables of a JSON file to a set: parameters in their places, icons that play others, the meaning."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import Any

from ..language.assemble import MOST_CORNERS_A_FILE
from ..language.recover import DEEPEST
from ..language.source import Finding, Source
from ..model.check import MOST_CORNERS, corner_count
from ..model.context import Context, Metadata
from ..model.errors import CueErrors
from ..model.expand import HOLE
from ..model.family import MOST_MEMBERS, Family
from ..model.family_check import MOST_EFFORT, effort
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.parameter import Parameter
from ..model.shapes import Pulse, Step, Wave
from ..model.slots import Slot, value_fault
from ..model.statements import Current, Hold, Play, Ramp, Repeat, Rest, Return, Statement, Total
from ..model.units import KIND_WORDS, Kind
from ..model.words import nearest
from . import json_schema as model
from .exchangetypes import Use
from .jsonplaces import Path, Places, path_text

_KINDS: dict[str, Kind] = {
    **{"by_K": "change", "to_C": "absolute", "by_A": "current", "to_A": "current", "count": "count"},
    **{"rate_K_per_s": "rate", "rate_A_per_s": "current_rate", "duration_s": "time", "period_s": "time"},
}


@dataclass(slots=True)
class _Scope:
    """The parameters of the icon that is being read, and where they were found to stand."""

    parameters: dict[str, Parameter]
    slots: list[Slot] = field(default_factory=list)


class Reader:
    """Builds the set of a table; ``findings`` holds what is wrong when there is none."""

    def __init__(self, source: Source, places: Places, table: model.CueTable) -> None:
        self.source = source
        self.places = places
        self.table = table
        self.findings: list[Finding] = []
        self.context = Context(table.set.control, table.set.baseline_C, table.set.site)
        self.index: dict[str, int] = {}
        self.done: dict[int, Icon | Family | None] = {}
        self.playing: list[int] = []
        self.corners = self.members = self.effort = 0

    def icons(self) -> IconSet | None:
        """Return the set, or None and findings."""
        for place, icon in enumerate(self.table.icons):
            if icon.name in self.index:
                what = f"{path_text(('icons', self.index[icon.name]))} is called {icon.name} already"
                self.add("E211", ("icons", place, "name"), what, "each icon needs a different name")
            self.index.setdefault(icon.name, place)
        made = [self.made(place) for place in range(len(self.table.icons))]
        entries = tuple(icon for icon in made if icon is not None)
        if self.findings or len(entries) < len(made):
            return None
        table = self.table.set
        try:
            return IconSet(table.name or "", table.title or "", self.context, _metadata(table), entries)
        except ValueError as error:
            self.add("E012", (), str(error))
            return None

    def made(self, place: int) -> Icon | Family | None:
        """Return the icon or family at a place in the list; None, with findings, when it is not valid."""
        if place not in self.done:
            self.playing.append(place)
            before = len(self.findings)
            icon = self.icon(place, self.table.icons[place])
            self.done[place] = None if len(self.findings) > before else icon
            self.playing.pop()
        return self.done[place]

    def icon(self, place: int, table: model.IconTable) -> Icon | Family | None:
        """Return what a table describes, proven."""
        path: Path = ("icons", place)
        before = len(self.findings)
        scope = _Scope(self.parameters(table.parameters or [], path))
        body = self.body(table.statements, (*path, "statements"), (), scope)
        if table.parameters and len(self.findings) == before:
            self.unused(table, path, scope)
        if len(self.findings) > before or len(body) < len(table.statements):
            return None
        count = corner_count(body)
        self.corners += count if count <= MOST_CORNERS else 0
        if self.corners > MOST_CORNERS_A_FILE:
            what = f"written out, the icons up to here have {self.corners:,} corners"
            self.add("E220", (*path, "name"), what, f"a file has at most {MOST_CORNERS_A_FILE:,}")
            return None
        try:
            if table.parameters is None:
                return Icon(table.name, body, self.context, _metadata(table))
            named = tuple(scope.parameters.values())
            self.members += prod(len(each) for each in named)
            if self.members > MOST_MEMBERS:
                what = f"the families up to here have {self.members:,} members"
                self.add("E231", (*path, "name"), what, f"a file has at most {MOST_MEMBERS:,}")
                return None
            self.effort += effort(prod(len(each) for each in named), body, scope.slots)
            if self.effort > MOST_EFFORT:
                what = f"{self.members:,} members have {self.effort:,} statements to check"
                help = f"a file has at most {MOST_EFFORT:,}: fewer members, statements or repeats, or several files"
                self.add("E231", (*path, "name"), what, help)
                return None
            return Family(table.name, named, body, tuple(scope.slots), self.context, _metadata(table))
        except CueErrors as found:
            for error in found.errors:
                offset = self.source.starts[error.line - 1] + error.column - 1
                self.add(error.code, self.places.path(offset) if offset else (*path, "name"), error.what, error.help)
        except ValueError as error:
            self.add("E012", (*path, "name"), str(error))
        return None

    def parameters(self, tables: Sequence[model.ParameterTable], path: Path) -> dict[str, Parameter]:
        """Return parameters by name."""
        found: dict[str, Parameter] = {}
        for place, table in enumerate(tables):
            here = (*path, "parameters", place)
            span = None if table.low is None else (table.low, table.high, table.step)
            if table.name in found:
                self.add("E213", (*here, "name"), f'"{table.name}" is already in this list', "keep one of them")
            try:
                found[table.name] = Parameter(table.name, table.unit, tuple(table.values or ()), span)  # type: ignore[arg-type]
            except (ValueError, OverflowError) as error:
                self.add("E228", here, str(error), "values all differ; a range runs from low to high in whole steps")
        return found

    def unused(self, table: model.IconTable, path: Path, scope: _Scope) -> None:
        """Tell of parameters that stand nowhere, and of names in the intent that are no parameters."""
        used = {slot.parameter for slot in scope.slots}
        for place, name in enumerate(scope.parameters):
            if name not in used:
                what = f"{name} is never used, so that members would be equal"
                self.add("E227", (*path, "parameters", place), what, f'use it: {{"parameter": "{name}"}}')
        for hole in HOLE.findall(table.means or ""):
            if hole not in scope.parameters:
                self.add("E226", (*path, "means"), f'"{hole}" is not a parameter', _names(scope))

    def body(self, tables: Sequence[Any], path: Path, inside: tuple[int, ...], scope: _Scope) -> tuple[Statement, ...]:
        """Return statements in order, without invalid ones."""
        if len(inside) > DEEPEST:
            self.add("E115", path, f"repeats are nested more than {DEEPEST} deep", "write the innermost out")
            return ()
        made = (self.statement(table, (*path, n), (*inside, n), scope) for n, table in enumerate(tables))
        return tuple(part for part in made if part is not None)

    def statement(self, table: Any, path: Path, inside: tuple[int, ...], scope: _Scope) -> Statement | None:
        """Return the statement of a table; None, with findings, when it is not valid."""
        at = self.source.place(self.places.of(path)[0])
        if isinstance(table, model.PlayTable):
            icon = self.played(table.icon, (*path, "icon"))
            return None if icon is None else Play(icon, at)
        if isinstance(table, model.RepeatTable):
            body = self.body(table.statements, (*path, "statements"), inside, scope)
            count = dict(self.values(table, path, inside, scope)).get("count")
            total = next((n for n, part in enumerate(body) if isinstance(part, Total)), None)
            if total is not None:
                help = "put it among the statements of the icon"
                self.add("E229", (*path, "statements", total), "a total concerns the whole icon, not a repeat", help)
            sound = count is not None and total is None and len(body) == len(table.statements)
            return Repeat(int(count), body, at) if sound and count is not None else None
        before = len(self.findings)
        values: dict[str, Any] = dict(self.values(table, path, inside, scope))
        if len(self.findings) > before:
            return None
        try:
            return _statement(table, values, at)
        except ValueError as error:
            self.add("E012", path, str(error).partition(".")[2] or str(error))
            return None

    def values(
        self, table: Any, path: Path, inside: tuple[int, ...], scope: _Scope
    ) -> Iterator[tuple[str, float | str | bool]]:
        """Yield the given values of a statement by key, a parameter's first value in its place."""
        for name in type(table).model_fields:
            value = getattr(table, name)
            if name in ("do", "statements") or value is None:
                continue
            kind = _KINDS.get(name)
            up_only = table.do in ("warm", "cool") or getattr(table, "direction", "") in ("warm", "cool")
            if kind == "change" and (up_only or isinstance(table, model.WaveTable)):
                kind = "difference"
            here = (*path, name)
            wrong = self.misfit(table, name, value, kind)
            if wrong:
                self.add(*wrong[:1], here, *wrong[1:])
            elif isinstance(value, Use) and kind is not None:
                number = self.use(value.parameter, here, kind, scope, isinstance(table, model.WaveTable))
                if number is not None:
                    own = "rate_per_s" if table.do == "return" and name.startswith("rate") else name
                    scope.slots.append(Slot(inside, own, kind, value.parameter))
                    yield name, number
            else:
                yield name, value

    def misfit(self, table: Any, name: str, value: Any, kind: Kind | None) -> tuple[str, str, str] | None:
        """Return code, words and help for a value that does not fit its statement or the control, or None."""
        wrong, right = ("rate_K_per_s", "A") if self.context.control == "current" else ("rate_A_per_s", "K")
        if table.do == "return" and name == wrong:
            return "E210", f"this set controls the {self.context.control}", f"the key is rate_{right}_per_s"
        if kind == "difference" and isinstance(value, float | int) and value <= 0:
            return "E202", f"{value:g} K: a change has a positive size; its direction is in the word", ""
        if name == "by_A" and isinstance(value, float | int):
            if isinstance(table, model.WaveTable) and value <= 0:
                return "E202", f"{value:g} A: an amplitude is positive", 'write "start": "down" to begin downwards'
            if value == 0:
                return "E202", "a change must not be zero", ""
        return None

    def use(self, name: str, path: Path, kind: Kind, scope: _Scope, wave: bool) -> float | None:
        """Return the first value of a parameter where it stands for a number of some kind."""
        own = scope.parameters.get(name)
        if own is None:
            close = nearest(name, list(scope.parameters))
            self.add(
                "E226",
                path,
                f'"{name[:40]}" is not a parameter',
                f"{f'did you mean {close}? ' if close else ''}{_names(scope)}",
            )
            return None
        found = value_fault(own, kind)
        if found is None and path[-1] == "by_A":
            if wave and min(own.si(0, kind), *own.listed) < 0:
                found = "E202", "an amplitude is positive"
            elif own.place("0") is not None:
                found = "E202", "a change must not be zero"
        if found is not None:
            self.add(found[0], path, f"{name}: {found[1]}", f"{KIND_WORDS[kind]} stands here")
            return None
        return own.si(0, kind)

    def played(self, name: str, path: Path) -> Icon | None:
        """Return the icon that is to be played; None, and a finding, when there is none, or it plays this one."""
        head, _, values = name.partition("_")
        known = name if name in self.index else head if values and head in self.index else None
        if known is None:
            close = nearest(name, list(self.index))
            help = f"did you mean {close}?" if close else "play names an icon of this file"
            self.add("E230", path, f'no icon is called "{name[:60]}"', help)
            return None
        index = self.index[known]
        if index in self.playing:
            circle = [self.table.icons[n].name for n in self.playing[self.playing.index(index) :]] + [known]
            self.add(
                "E232",
                path,
                f"these icons play each other in a circle: {' plays '.join(circle)}",
                "leave one of them out",
            )
            return None
        if len(self.playing) > DEEPEST:
            self.add("E115", path, f"icons play one another more than {DEEPEST} deep", "write the innermost out")
            return None
        found = self.made(index)
        if isinstance(found, Family):
            member = found.find(name)
            if member is None:
                self.add(
                    "E230", path, f'"{name[:60]}" is not a member of the family {known}', f"such as {found[0].name}"
                )
            return member
        return found

    def add(self, code: str, path: Path, what: str, help: str = "") -> None:
        """Add a finding at a path."""
        self.findings.append(Finding(code, *self.places.of(path), f"{path_text(path)}: {what}", help))


def _statement(table: Any, values: dict[str, Any], at: tuple[int, int]) -> Statement:
    match table:
        case model.ChangeTable():
            return Ramp(table.do, **values, span=at)
        case model.DriveTable():
            return Current(**values, span=at)
        case model.HoldTable():
            return (Hold if table.do == "hold" else Rest)(**values, span=at)
        case model.StepTable():
            return Step(**values, span=at)
        case model.PulseTable():
            return Pulse(**values, span=at)
        case model.WaveTable():
            return Wave(table.do, **values, span=at)
        case model.TotalTable():
            return Total(**values, span=at)
    rate = values.get("rate_K_per_s", values.get("rate_A_per_s"))
    return Return(rate, values.get("duration_s"), at)


def _metadata(table: model.MetadataTable) -> Metadata:
    return Metadata(table.means, table.by, table.doi, table.licence, tuple(table.tags))


def _names(scope: _Scope) -> str:
    if not scope.parameters:
        return 'only a family has parameters: "parameters": [{"name": ..., "unit": ..., "values": [...]}]'
    return f"parameters of this icon are: {', '.join(scope.parameters)}"
