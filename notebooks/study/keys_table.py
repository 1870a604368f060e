"""The reference of study keys as a table, from the schema itself."""

from __future__ import annotations

from collections.abc import Iterator

from ..report.schema_table import default_of, values_of
from .keys import TABLES, Study, Table


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
        default = "needed" if field.is_required() else default_of(field.default)
        yield prefix + name, values_of(properties[name]), default, str(field.description)
