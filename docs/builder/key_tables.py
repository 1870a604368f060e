"""Tables of the keys of files from the schemas."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from table_text import markdown

from thermicon.circuit.delivery.devicefile import DeviceTable, quantities, units_of
from thermicon.circuit.rig.modules import FIGURES, module_rows
from thermicon.circuit.rig.rigfile import RigTable
from thermicon.circuit.rig.usual import usual_values
from thermicon.notebooks.study.study_file import TABLES as STUDY_TABLES
from thermicon.notebooks.study.study_file import Study

BOUNDS = {"minimum": "≥ {:g}", "exclusiveMinimum": "> {:g}", "maximum": "≤ {:g}", "exclusiveMaximum": "< {:g}"}
KINDS = {"integer": "whole number", "number": "number", "string": "text", "boolean": "true or false"}


def modules_table() -> str:
    """The modules on record, a line for each data sheet."""
    rows = [(f"`{name}`", *figures) for name, *figures in module_rows()]
    return markdown(("name", "face cm²", "plates, J/K each", "hot side °C", *FIGURES[3:]), rows)


def device_quantities_table() -> str:
    """Return the quantities that a device may state, with the limits of their values, as a table of Markdown."""
    rows = []
    for quantity, about in quantities()[0].items():
        units, (low, high) = sorted(set(units_of(quantity).values())), about["limits"]
        rows.append((f"`{quantity}`", " or ".join(units), f"{low:g} to {high:g}"))
    return markdown(("quantity", "unit", "from, to"), rows)


def study_keys_table() -> str:
    """Every key of a study file with its values, its default and its meaning."""
    rows, meanings = [], tomllib.loads(Path(__file__).with_name("study-keys.toml").read_text(encoding="utf-8"))
    tables = {"": (Study, [name for name in Study.model_fields if name not in STUDY_TABLES])}
    tables |= {f"{name}.": (table, list(table.model_fields)) for name, table in STUDY_TABLES.items()}
    for prefix, (table, names) in tables.items():
        properties = table.model_json_schema()["properties"]
        for name in names:
            field, meaning = table.model_fields[name], (meanings[prefix[:-1]] if prefix else meanings)[name]
            default = "needed" if field.is_required() else default_of(field.default)
            rows.append((f"`{prefix}{name}`", values_of(properties[name]), default, meaning))
    return markdown(("key", "values", "default", "meaning"), rows)


def _table(model: type[BaseModel]) -> str:
    """Every key of a file with its values and its default."""
    schema = model.model_json_schema()
    return markdown(("key", "values", "default"), _rows(schema, schema, ""))


def rig_keys_table() -> str:
    """Every key of a rig file with its values, its default, and what is usual and why."""
    schema, usual = RigTable.model_json_schema(), usual_values()
    rows = []
    for key, values, default in _rows(schema, schema, ""):
        low, high, source = usual.get(key.strip("`"), (None, None, ""))
        rows.append((key, values, default, "" if low is None else f"{low:g} to {high:g} ({source})"))
    return markdown(("key", "values", "default", "usual"), rows)


def _rows(table: dict[str, Any], schema: dict[str, Any], prefix: str) -> Iterator[tuple[str, str, str]]:
    """Yield the keys of a table, those of the tables in it included; a list of tables has 0 as its place."""
    for name, about in table["properties"].items():
        known = known_of(about)
        inner = known.get("items", known) if known.get("type") == "array" else known
        if "$ref" in inner:
            place = f"{prefix}{name}.0." if inner is not known else f"{prefix}{name}."
            yield from _rows(schema["$defs"][inner["$ref"].rpartition("/")[2]], schema, place)
        else:
            default = "needed" if name in table.get("required", ()) else default_of(about.get("default"))
            yield f"`{prefix}{name}`", values_of(about), default


def known_of(about: dict[str, Any]) -> dict[str, Any]:
    """Return what a key holds where it is given."""
    options = [option for option in about.get("anyOf", [about]) if option.get("type") != "null"]
    return dict(options[0])


def values_of(about: dict[str, Any]) -> str:
    """Return kind and bounds of a value, as the JSON schema has them."""
    known = known_of(about)
    if "enum" in known:
        return ", ".join(f"`{value}`" for value in known["enum"] if value != "")
    if "const" in known:
        return f"`{known['const']}`"
    if known["type"] == "object":
        return "text for each key"
    if known["type"] == "array":
        return f"list of {values_of(known['items'])}"
    bounds = [words.format(known[bound]) for bound, words in BOUNDS.items() if bound in known]
    return " ".join([KINDS[known["type"]], ", ".join(bounds)]).strip()


def default_of(value: object) -> str:
    """Return a default as it is written in a file; a key without one may be left out."""
    if value in (None, [], ""):
        return "none"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


KEY_TABLES = {
    "study keys": study_keys_table,
    "rig keys": rig_keys_table,
    "modules": modules_table,
    "device keys": partial(_table, DeviceTable),
    "device quantities": device_quantities_table,
}
"""The tables by the names that mark their places in the pages."""
