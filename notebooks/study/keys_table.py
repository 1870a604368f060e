"""The reference of study keys as a table, from the schema itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic.fields import FieldInfo

from .keys import TABLES, Study, Table

BOUNDS = {"minimum": "≥ {:g}", "exclusiveMinimum": "> {:g}", "maximum": "≤ {:g}", "exclusiveMaximum": "< {:g}"}


def keys_table() -> str:
    """Return every key of a study file with its values, its default and its meaning, as a table of Markdown.

    >>> "`timing.gap_s`" in keys_table()
    True
    """
    rows = [f"| `{key}` | {values} | {default} | {meaning} |" for key, values, default, meaning in _rows()]
    return "\n".join(["| key | values | default | meaning |", "|---|---|---|---|", *rows])


def _rows() -> Iterator[tuple[str, str, str, str]]:
    yield from _of(Study, "", [name for name in Study.model_fields if name not in TABLES])
    for name, table in TABLES.items():
        yield from _of(table, f"{name}.", list(table.model_fields))


def _of(table: type[Table], prefix: str, names: list[str]) -> Iterator[tuple[str, str, str, str]]:
    properties = table.model_json_schema()["properties"]
    for name in names:
        field = table.model_fields[name]
        yield prefix + name, _values(properties[name]), _default(field), str(field.description)


def _values(about: dict[str, Any]) -> str:
    """Kind and bounds of a value, as the JSON schema has them."""
    options = [option for option in about.get("anyOf", [about]) if option.get("type") != "null"]
    known = options[0]
    if "enum" in known:
        return ", ".join(f"`{value}`" for value in known["enum"])
    if "const" in known:
        return f"`{known['const']}`"
    kinds = {"integer": "whole number", "number": "number", "string": "text", "boolean": "true or false"}
    kind = "list of text" if known.get("type") == "array" else kinds[known["type"]]
    bounds = [words.format(known[bound]) for bound, words in BOUNDS.items() if bound in known]
    return " ".join([kind, ", ".join(bounds)]).strip()


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "needed"
    if field.default in (None, [], ""):
        return "none"
    value = field.default
    return (
        f"`{str(value).lower()}`"
        if isinstance(value, bool)
        else f"`{value:g}`"
        if isinstance(value, float)
        else (f"`{value}`")
    )
