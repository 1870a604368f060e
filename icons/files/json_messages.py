"""What is wrong with a cue set in JSON, in words: the path, what was found, the limit, the unit and the cure."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from ..language.source import Finding
from ..model.words import nearest
from . import json_schema as model
from .exchangetypes import Use
from .jsonplaces import Path, Places, path_text

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic_core import ErrorDetails

_STATEMENTS: dict[str, type[BaseModel]] = {
    **dict.fromkeys(("warm", "cool", "change"), model.ChangeTable),
    **dict.fromkeys(("hold", "rest"), model.HoldTable),
    **dict.fromkeys(("sine", "square", "triangle", "sawtooth"), model.WaveTable),
    **{"drive": model.DriveTable, "return": model.ReturnTable, "step": model.StepTable, "pulse": model.PulseTable},
    **{"total": model.TotalTable, "play": model.PlayTable, "repeat": model.RepeatTable},
}
_WORDS = {
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
_UNITS = (("rate_K_per_s", "K/s"), ("rate_A_per_s", "A/s"), ("_K", "K"), ("_C", "°C"), ("_A", "A"), ("_s", "s"))


def unit_of(path: Path) -> str:
    """Return the unit that ends the last key of a path, or "".

    >>> unit_of(("icons", 0, "statements", 1, "rate_K_per_s")), unit_of(("set", "name"))
    ('K/s', '')
    """
    last = str(path[-1]) if path else ""
    return next((unit for ending, unit in _UNITS if last.endswith(ending)), "")


def shown(value: object) -> str:
    """Return a value as messages show it: short, on one line, and printable."""
    text = json.dumps(value, ensure_ascii=False, default=str)
    text = text if len(text) <= 40 else text[:39] + "…"
    return "".join(char if char.isprintable() else "�" for char in text)


def finding(error: ErrorDetails, document: Any, places: Places) -> Finding:
    """Return an error of the models as a finding at its place in the text."""
    loc = error["loc"]
    path = (*_path(loc[:-1], document), loc[-1]) if error["type"] == "missing" else _path(loc, document)
    kind, value, context = error["type"], error.get("input"), error.get("ctx", {})
    code, about_key = "E012", False
    unit = f" in {unit_of(path)}" if unit_of(path) else ""
    help = ""
    if kind[0] == "E" and kind[1:].isdigit():
        code, what = kind, f"{shown(value)}: {context['words']}"
        help = f"the value is{unit}" if unit else ""
    elif kind == "extra_forbidden":
        what, help, about_key = f"unknown key {shown(path[-1])}", _other_key(path, document), True
    elif kind == "missing":
        what, help, path = f'"{path[-1]}" is missing', f'add "{path[-1]}"{unit}', path[:-1]
    elif kind == "null":
        what, help = "null is not a value here", "leave the key out"
    elif kind == "one_of":
        what, help = context["words"], f"exactly one is given of: {', '.join(context['names'])}"
    elif kind in ("union_tag_not_found", "union_tag_invalid") and isinstance(value, dict):
        what, help = _statement(value)
        path = (*path, "do") if "do" in value else path
    elif kind == "literal_error":
        value = document["version"] if path == ("version",) else value  # not as `whole` made it
        code, what, help = _choice(path, value, str(context["expected"]))
    elif kind == "too_short":
        what, help = "the list is empty", f"{path[-1]} needs one entry at least"
    elif kind in _WORDS:
        what = f"{shown(value)}: {_WORDS[kind]}{unit if kind == 'float_type' else ''}"
        text = isinstance(value, str) and kind in ("float_type", "int_type")
        help = "numbers have no quotation marks; the unit is in the name of the key" if text else ""
    elif kind == "ways":
        what, help = error["msg"], 'such as "values": [1, 2, 3], or "low": 1, "high": 3, "step": 0.5'
    else:
        what = f"{shown(value)}: {error['msg'][:1].lower()}{error['msg'][1:]}"
    return Finding(code, *places.of(path, about_key), f"{_plain(path_text(path))}: {what}", help)


def _path(loc: tuple[int | str, ...], document: Any) -> Path:
    """Return the path in the document; what the models add to it, such as which of a union was tried, is dropped."""
    path: list[int | str] = []
    here = document
    for place, part in enumerate(loc):
        inside = range(len(here)) if isinstance(here, list) else here if isinstance(here, dict) else ()
        if part in inside:
            here = here[part]
        elif not (place == len(loc) - 1 and isinstance(here, dict) and not _is_tag(part, here)):
            continue
        path.append(part)
    return tuple(path)


def _is_tag(part: int | str, here: dict[str, Any]) -> bool:
    return part in ("number", "parameter") or part == here.get("do")


def _other_key(path: Path, document: Any) -> str:
    keys = [field.alias or name for name, field in _table(path, document).model_fields.items()]
    close = nearest(str(path[-1]), keys)
    if close is None:
        close = next((key for key in keys if key.startswith(str(path[-1])[:40] + "_")), None)
    return f"{f'did you mean {close}? ' if close else ''}keys here are: {', '.join(keys)}"


def _table(path: Path, document: Any) -> type[BaseModel]:
    if len(path) == 1:
        return model.CueTable
    if path[0] == "set":
        return model.SetTable
    if len(path) == 3:
        return model.IconTable
    if path[2] == "parameters":
        return model.ParameterTable
    here = document
    for part in path[:-1]:
        here = here[part]
    word = here.get("do")
    return _STATEMENTS.get(word, Use) if isinstance(word, str) else Use


def _statement(value: dict[str, Any]) -> tuple[str, str]:
    words = ", ".join(_STATEMENTS)
    if "do" not in value:
        return '"do" is missing', f"it says what the statement is: {words}"
    word = value["do"]
    close = nearest(word, list(_STATEMENTS)) if isinstance(word, str) else None
    return f"{shown(word)} is not a statement", f"{f'did you mean {close}? ' if close else ''}statements are: {words}"


def _choice(path: Path, value: object, expected: str) -> tuple[str, str, str]:
    options = [option.strip("' ") for option in expected.replace(" or ", ", ").split(", ")]
    if path == ("version",):
        return "E010", f"this is version 1 of the format, not {shown(value)}", 'write: "version": 1'
    close = nearest(value, options) if isinstance(value, str) else None
    help = f"did you mean {close}? " if close else ""
    return "E012", f"{shown(value)} is not allowed here", f"{help}one of: {', '.join(options)}"


def _plain(text: str) -> str:
    text = text if len(text) <= 80 else "…" + text[-79:]
    return "".join(char if char.isprintable() else "�" for char in text)
