"""A rig document as TOML text, which reads back as exactly the same document."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any


def toml_text(document: Mapping[str, Any]) -> str:
    """Return a document of numbers, texts, lists and tables as TOML.

    >>> print(toml_text({"name": "a", "skin": {"rest_C": 32.0, "layer": [{"name": "dermis"}]}}), end="")
    name = "a"
    <BLANKLINE>
    [skin]
    rest_C = 32.0
    <BLANKLINE>
    [[skin.layer]]
    name = "dermis"
    """
    return "\n".join(_table(document, ())).lstrip("\n") + "\n"


def _table(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    """Lines of a table: its own values first, since whatever follows a header belongs to that header."""
    for key, value in table.items():
        if not isinstance(value, dict) and not _is_tables(value):
            yield f"{_key(key)} = {_value(value)}"
    for key, value in table.items():
        inner = (*path, key)
        header = ".".join(_key(part) for part in inner)
        if isinstance(value, dict):
            yield from ("", f"[{header}]", *_table(value, inner))
        elif _is_tables(value):
            for entry in value:
                yield from ("", f"[[{header}]]", *_table(entry, inner))


def _is_tables(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(entry, dict) for entry in value)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _text(key)


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return _text(value) if isinstance(value, str) else json.dumps(value)


def _text(text: str) -> str:
    """A TOML string: JSON escapes what TOML must have escaped, except DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
