"""A cue set in JSON, checked against the schema and written as cue text, so that the language checks what it means."""

from __future__ import annotations

import json
from bisect import bisect_right
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NoReturn

from pydantic import ValidationError

from ..language.assemble import analyse
from ..language.source import MOST_JSON_BYTES, Finding, Source, utf8_of
from ..model.context import Metadata
from ..model.errors import MOST_ERRORS, CueError, CueErrors, whole_file
from ..model.format import metadata_texts, quoted
from ..model.units import KIND_WORDS, UNITS, decimal_text
from ..model.words import EXAMPLES, nearest
from .json_messages import Path, at_path, schema_error
from .json_schema import QUANTITIES, CueTable, IconTable, MetadataTable, ParameterTable, Use

if TYPE_CHECKING:
    from ..model.iconset import IconSet

# In the order of a statement in cue text; what stands before a value.
_WORDS = {
    **{"direction": "", "bound": "", "icon": "", "count": ""},
    **{"by_K": "by ", "to_C": "to ", "by_A": "by ", "to_A": "to ", "rate_K_per_s": "at ", "rate_A_per_s": "at "},
    **{"period_s": "every ", "duration_s": "for ", "start": "starting ", "cut": ""},
}
_LEFT_OUT = {"direction": "change", "bound": "exactly"}
_TIME_WORDS = {"total": "", **dict.fromkeys(("warm", "cool", "change", "drive", "return"), "over ")}
_JSON = 'an object is { "key": value, ... }, a list [ value, ... ]; no comma stands behind the last value'


def read_json(data: str | bytes, file: str) -> IconSet:
    """Return the set in a JSON document; CueErrors with everything that is wrong, each with its JSON path."""
    document = _document(data, file)
    try:
        table = CueTable.model_validate(document)
    except ValidationError as error:
        raise _several([schema_error(each, file) for each in error.errors(include_url=False)]) from None
    text = _CueText(table, file)
    if text.errors:
        raise _several(text.errors)
    analysis = analyse(Source(file, text.text))
    if analysis.icons is not None:
        return analysis.icons
    raise _several([_meaning_error(each, text.path(each.start), document, file) for each in analysis.findings])


def _meaning_error(found: Finding, path: Path, document: Any, file: str) -> CueError:
    """Return what the language finds wrong as an error of the JSON: with the number, and its unit for cue text."""
    value, help = document, found.help
    with suppress(KeyError):  # of a key that is left out
        for part in path:
            value = value[part]
    what = f"{value:g}: {found.what}" if isinstance(value, (int, float)) else found.what
    if help in EXAMPLES.values() and str(path[-1]) in QUANTITIES:
        help = f"the value is in {QUANTITIES[str(path[-1])][1]}"
    cure = next((cure.text for cure in found.cures if (cure.start, cure.end) == (found.start, found.end)), None)
    return at_path(
        file, found.code, path, what, f"did you mean {cure}? {help}" if cure and cure not in help.split() else help
    )


class _CueText:
    """The cue text of a set, with the JSON path that each part of it comes from; ``errors`` it cannot express."""

    def __init__(self, table: CueTable, file: str) -> None:
        self.file = file
        self.errors: list[CueError] = []
        self._parts: list[str] = []
        self._starts: list[int] = []
        self._paths: list[Path] = []
        self._length = 0
        self.write("cue 1\n", ())
        self.settings(table)
        names: dict[str, int] = {}
        for place, icon in enumerate(table.icons):
            first = names.setdefault(icon.name, place)
            if first != place:
                what = f"icons[{first}] is called {icon.name} already"
                self.add("E211", ("icons", place, "name"), what, "each icon needs a different name")
            self.icon(icon, ("icons", place))

    @property
    def text(self) -> str:
        """The cue text."""
        return "".join(self._parts)

    def path(self, offset: int) -> Path:
        """Return the JSON path of what stands at an offset of the text."""
        return self._paths[bisect_right(self._starts, offset) - 1]

    def add(self, code: str, path: Path, what: str, help: str) -> None:
        """Add an error."""
        self.errors.append(at_path(self.file, code, path, what, help))

    def write(self, text: str, path: Path) -> None:
        """Append a part, and where it comes from."""
        self._parts.append(text + " ")
        self._starts.append(self._length)
        self._paths.append(path)
        self._length += len(text) + 1

    def settings(self, table: CueTable) -> None:
        """Write the set block."""
        settings = table.set
        self.write("set", ("set",))
        if settings.name is not None:
            self.write(settings.name, ("set", "name"))
        if settings.title is not None:
            self.write(quoted(settings.title), ("set", "title"))
        self.write(f"{{\ncontrol {settings.control}\n", ("set", "control"))
        if settings.site is not None:
            self.write(f"site {settings.site}\n", ("set", "site"))
        if settings.baseline_C is not None:
            self.write(f"baseline {decimal_text(settings.baseline_C)} °C\n", ("set", "baseline_C"))
        self.metadata(settings, ("set",))
        self.write("}\n", ("set",))

    def metadata(self, table: MetadataTable, path: Path) -> None:
        """Write metadata, one key a line."""
        for text in metadata_texts(Metadata(table.means, table.by, table.doi, table.licence, tuple(table.tags))):
            self.write(text + "\n", (*path, text.partition(" ")[0]))

    def icon(self, table: IconTable, path: Path) -> None:
        """Write an icon or a family."""
        self.write("icon", path)
        self.write(table.name, (*path, "name"))
        parameters: dict[str, ParameterTable] = {}
        for place, parameter in enumerate(table.parameters or ()):
            here = (*path, "parameters", place)
            if parameter.name in parameters:
                self.add("E213", (*here, "name"), f'"{parameter.name}" is already in this list', "keep one of them")
            parameters[parameter.name] = parameter
            self.write("," if place else "(", path)
            self.write(f"{parameter.name} in", (*here, "name"))
            if parameter.values is not None:
                self.write(f"[{', '.join(map(decimal_text, parameter.values))}]", (*here, "values"))
            else:
                low, high, step = map(decimal_text, (parameter.low, parameter.high, parameter.step))
                self.write(f"{low}..{high} step {step}", here)
            self.write(parameter.unit, (*here, "unit"))
        self.write(")\n" if parameters else "\n", path)
        self.metadata(table, path)
        self.write("{\n", path)
        self.body(table.statements, (*path, "statements"), parameters)
        self.write("}\n", path)

    def body(self, tables: Sequence[Any], path: Path, parameters: dict[str, ParameterTable]) -> None:
        """Write statements, one a line."""
        for place, table in enumerate(tables):
            here = (*path, place)
            self.write("" if table.do == "drive" else table.do, here)
            for key, word in _WORDS.items():
                value = getattr(table, key, None)
                if value is not None and value is not False and value != _LEFT_OUT.get(key):
                    word = _TIME_WORDS.get(table.do, word) if key == "duration_s" else word
                    self.write(word + self.value(key, value, (*here, key), parameters), (*here, key))
            if table.do == "repeat":
                self.write("{\n", here)
                self.body(table.statements, (*here, "statements"), parameters)
                self.write("}", here)
            self.write("\n", here)

    def value(self, key: str, value: Any, path: Path, parameters: dict[str, ParameterTable]) -> str:
        """Return a value as cue text; a parameter must have a unit of the kind that its key says."""
        kind, unit = QUANTITIES.get(key, (None, ""))
        if isinstance(value, Use):
            own = parameters.get(value.parameter)
            if own is None:
                close = nearest(value.parameter, list(parameters))
                listed = f"parameters of this icon are: {', '.join(parameters) or 'none; only a family has parameters'}"
                help = f"did you mean {close}? {listed}" if close else listed
                self.add("E226", path, f'"{value.parameter[:40]}" is not a parameter', help)
            elif kind is not None and own.unit not in UNITS[kind]:
                what = f"{own.name} is in {own.unit}" if own.unit else f"{own.name} has no unit"
                self.add(
                    "E104", path, f"{what}; {KIND_WORDS[kind]} is needed here", f"such as in {unit}" if unit else ""
                )
            return value.parameter
        if kind is None:
            return key if value is True else str(value)
        return f"{decimal_text(value)} {unit}".strip()


class _NotJson(ValueError):
    """What Python's reader takes, but is not JSON."""


def _document(data: str | bytes, file: str) -> Any:
    """Return the document in a JSON text; CueErrors when it is too large, empty, not UTF-8 or not JSON."""
    if len(data) > MOST_JSON_BYTES:
        help = f"a cue set in JSON has at most {MOST_JSON_BYTES:,} bytes; split the set"
        raise whole_file("E004", file, f"{len(data):,} bytes", help)
    text = (data if isinstance(data, str) else utf8_of(data, file)).removeprefix("\ufeff")
    if not text.strip():
        raise whole_file("E005", file, "nothing but white space", "thermicon convert writes sets as JSON")
    try:
        return json.loads(text, parse_constant=_no_constant, object_pairs_hook=_without_twins)
    except RecursionError:
        help = "a cue set needs fewer levels"
        raise whole_file("E115", file, "objects and lists are nested too deeply", help) from None
    except json.JSONDecodeError as error:
        line = f"{text}\n".split("\n")[error.lineno - 1]
        what = error.msg[:1].lower() + error.msg[1:].removesuffix(" at").removesuffix(" starting")
        raise CueErrors((CueError("E011", file, error.lineno, error.colno, 1, line, what, _JSON),)) from None
    except _NotJson as error:
        raise whole_file("E011", file, *error.args) from None
    except ValueError:  # Python refuses whole numbers of thousands of digits
        raise whole_file("E011", file, "a number has thousands of digits", "numbers are written as 6 or 1e-3") from None


def _no_constant(name: str) -> NoReturn:
    raise _NotJson(f"{name} is not a number in JSON", "numbers are written as 6, 0.5 or 1e-3")


def _without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in found if keys.count(key) > 1)
        raise _NotJson(f"the key {json.dumps(twice[:40])} stands twice in one object", "keep one of them")
    return found


def _several(errors: Sequence[CueError]) -> CueErrors:
    return CueErrors(tuple(errors[:MOST_ERRORS]), max(0, len(errors) - MOST_ERRORS))
