"""What is wrong with a cue set in JSON, in words: the JSON path, the value, the limit, the unit and the cure."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, get_args

from ..model.errors import CueError
from ..model.words import nearest
from .json_schema import QUANTITIES, CueTable, IconTable, ParameterTable, SetTable, StatementTable, Table, Use

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Path = tuple[int | str, ...]
_STATEMENTS: dict[str, type[Table]] = {
    word: table
    for table in get_args(get_args(StatementTable)[0])
    for word in get_args(table.model_fields["do"].annotation)
}
_NEEDED = {
    "float_type": "a number is needed",
    "int_type": "a whole number is needed",
    "string_type": "a text is needed",
    "bool_type": "true or false is needed",
    "list_type": "a list is needed: [ ... ]",
    "model_type": "an object is needed: { ... }",
    "model_attributes_type": "an object is needed: { ... }",
    "finite_number": "this number is too large",
    "string_unicode": "half a character (a lone surrogate)",
}


def at_path(file: str, code: str, path: Path, what: str, help: str = "") -> CueError:
    """Return an error at a place in a JSON document.

    >>> print(at_path("a.json", "E203", ("icons", 0, "statements", 2, "duration_s"), "0: a time is positive").render())
    a.json  E203 impossible duration
      icons[0].statements[2].duration_s: 0: a time is positive
    """
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")
    text = text if len(text) <= 80 else "…" + text[-79:]
    return CueError(code, file, 0, 0, 0, "", f"{text or 'the file'}: {what}", help)


def schema_error(error: ErrorDetails, file: str) -> CueError:
    """Return an error of the schema in words."""
    loc, kind, value, context = error["loc"], error["type"], error.get("input"), error.get("ctx", {})
    path, code, help = _path(loc), "E012", ""
    unit = QUANTITIES.get(str(path[-1]) if path else "", ("", ""))[1]
    unit = f" in {unit}" if unit else ""
    if kind[0] == "E" and kind[1:].isdigit():
        code, what = kind, f"{_shown(value)}: {context['words']}"
        help = f"the value is{unit}" if unit else ""
    elif kind == "extra_forbidden":
        what, help = f"unknown key {_shown(path[-1])}", _keys(loc)
    elif kind == "missing":
        what, help, path = f'"{path[-1]}" is missing', f'add "{path[-1]}"{unit}', path[:-1]
    elif kind == "one_of":
        what, help = context["words"], f"exactly one is given of: {', '.join(context['names'])}"
    elif kind == "union_tag_not_found" and isinstance(value, dict):
        what, help = '"do" is missing', f"it says what the statement is: {', '.join(_STATEMENTS)}"
    elif kind == "union_tag_invalid":
        path, what, help = (*path, "do"), f"{_shown(value['do'])} is not a statement", _one_of(value["do"], _STATEMENTS)
    elif kind == "literal_error" and path == ("version",):
        code, what, help = "E010", f"this is version 1 of the format, not {value}", 'write: "version": 1'
    elif kind == "literal_error":
        options = context["expected"].replace(" or ", ", ").replace("'", "").split(", ")
        what, help = f"{_shown(value)} is not allowed here", _one_of(value, options)
    elif kind == "too_short":
        what, help = "the list is empty", f"{path[-1]} needs at least one entry"
    elif kind in _NEEDED or kind.startswith("union_tag"):
        what = f"{_shown(value)}: {_NEEDED.get(kind, _NEEDED['model_type'])}{unit if kind == 'float_type' else ''}"
        if value is None:
            help = "a key without a value is left out"
        elif isinstance(value, str) and kind in ("float_type", "int_type"):
            help = "numbers have no quotation marks; the unit is in the name of the key"
    else:
        what = f"{_shown(value)}: {error['msg'][:1].lower()}{error['msg'][1:]}"
    return at_path(file, code, path, what, help)


def _path(loc: Path) -> Path:
    """Return a location without the tags that pydantic adds for the member of a union."""
    path: list[int | str] = []
    for n, part in enumerate(loc):
        of_statement = n > 1 and loc[n - 2] == "statements" and isinstance(loc[n - 1], int)
        of_number = n > 0 and loc[n - 1] in QUANTITIES and part in ("number", "parameter")
        if not of_statement and not of_number:
            path.append(part)
    return tuple(path)


def _keys(loc: Path) -> str:
    """Return the keys of the object that holds an unknown one."""
    last, before = loc[-1], loc[-2:-1]
    tables: dict[str, type[Table]] = {"set": SetTable, **_STATEMENTS, "parameter": Use}
    table: type[Table] = CueTable if len(loc) == 1 else IconTable
    if before and isinstance(before[0], str):
        table = tables[before[0]]
    elif loc[-3:-2] == ("parameters",):
        table = ParameterTable
    keys = [field.alias or name for name, field in table.model_fields.items()]
    close = nearest(str(last), keys) or next((key for key in keys if key.startswith(f"{last}_")), None)
    return f"{f'did you mean {close}? ' if close else ''}keys here are: {', '.join(keys)}"


def _one_of(value: object, options: Any) -> str:
    close = nearest(value, options) if isinstance(value, str) else None
    return f"{f'did you mean {close}? ' if close else ''}one of: {', '.join(options)}"


def _shown(value: object) -> str:
    """Return a value as messages show it: short and on one line."""
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 40 else text[:39] + "…"
