"""The document of a rig with changes by dotted keys."""

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from .faults import PARAMETERS, sentence
from .modules import build_of, module_names
from .rigfile import RigError, parse_toml, rig_keys, unknown_key

_OPTIONAL = ("controller", "uncertainty", "safety")
"""Tables that a rig need not have; setting a key creates one."""


def read_settings(settings: Iterable[str]) -> dict[str, object]:
    """Return dotted keys with values from texts such as `contact.area_cm2=4`; a value is TOML, or else plain text.

    >>> read_settings(["contact.area_cm2=4", "skin.site=forearm"])
    {'contact.area_cm2': 4, 'skin.site': 'forearm'}
    """
    changes: dict[str, object] = {}
    for setting in settings:
        key, equals, value = setting.partition("=")
        if not equals or not key.strip() or not value.strip():
            raise RigError(f"{setting!r}: a setting has the form KEY=VALUE, such as contact.area_cm2=4")
        try:
            changes[key.strip()] = parse_toml(f"value = {value.strip()}", key)["value"]
        except RigError:
            changes[key.strip()] = value.strip()
    return changes


def changed(changes: Iterable[str]) -> dict[str, str]:
    """Keys and values of changes of the form `key=value`."""
    return dict(text.split("=", 1) for text in changes)


def flattened(changes: Mapping[str, object], prefix: str = "") -> dict[str, object]:
    """Return changes with dotted keys in the place of nested dictionaries."""
    flat: dict[str, object] = {}
    for key, value in changes.items():
        if isinstance(value, dict):
            flat.update(flattened(value, f"{prefix}{key}."))
        else:
            flat[prefix + key] = value
    return flat


def put_all(document: dict[str, Any], changes: Mapping[str, object]) -> None:
    """Set dotted keys; a changed module loses its source and former form, one given by name gets its plates."""
    for key, value in changes.items():
        if key in ("module.datasheet", "module.name") and value is not None:
            for way in (*PARAMETERS, "datasheet", "name"):
                document["module"].pop(way, None)
        if key == "module.name" and value in module_names() and (plate := build_of(str(value)).plate_J_per_K):
            document["module"].update(hot_plate_J_per_K=plate, cold_plate_J_per_K=plate)
    for key, value in changes.items():
        put(document, key, value)


def put(document: dict[str, Any], key: str, value: object) -> None:
    """Set a dotted key in the document, or remove it for None; an unknown key or layer is an error with the nearest."""
    parts, place, plain = key.split("."), document, []
    for position, part in enumerate(parts[:-1]):
        if isinstance(place, list):
            index = _item(place, part, key)
            place, part_of_key = place[index], "0"
        else:
            if position == 0:
                _check_display(document, part, key)
            if part in _OPTIONAL and position == 0 and key in rig_keys():
                place.setdefault(part, {})
            if part == "datasheet" and part not in place:
                raise RigError(f"{key}: this rig's module has no data sheet; set module.datasheet, a list of them")
            if not isinstance(place.get(part), (dict, list)):
                if part == "probe":
                    raise RigError(f"{key}: this rig has no probe; add a [[probe]] with name and place to its file")
                raise RigError(unknown_key(key))
            place, part_of_key = place[part], part
        plain.append(part_of_key)
        if position == 0 and part == "source":
            raise RigError(f"{key}: a source cannot be changed here")
    generic = ".".join([*plain, parts[-1]])
    if generic not in rig_keys() or isinstance(place, list):
        raise RigError(unknown_key(generic).replace(".0.", f".{parts[2] if len(parts) > 3 else 0}."))
    if parts[0] == "module" and not key.endswith("plate_J_per_K") and place.get(parts[-1]) != value:
        document.get("source", {}).pop("module", None)
    if value is None:
        place.pop(parts[-1], None)
    else:
        place[parts[-1]] = value


def restate(document: dict[str, Any], keys: Iterable[str]) -> None:
    """Say in title and [source] which keys were set, beside what stands there of other keys of their table."""
    said = document.setdefault("source", {})
    for key in keys:
        table, dot, name = key.rpartition(".")
        if (place := table.removeprefix("skin.layer.")).isdecimal():
            table = f"skin.layer.{document['skin']['layer'][int(place)]['name']}"
        if table in said:
            said[table] += f"; {name} is changed"
        said[table + dot + name] = f"changed, not as in rig {document['name']}"
    if keys and "title" not in keys:
        document["title"] = f"{document['name']} with other {', '.join(keys)}"


def _check_display(document: Mapping[str, Any], part: str, key: str) -> None:
    """Refuse a key of a module on a thermode rig, and a key of a thermode on a rig with a module."""
    if "thermode" in document and part in ("module", "heat_sink", "driver", "controller"):
        name = str(document.get("name", ""))
        raise RigError(sentence("parts.no_module", key=key, name=name, part=part.replace("_", " ")))
    if "thermode" not in document and part == "thermode":
        raise RigError(f"{key}: this rig has a module and no thermode; use a rig with [thermode], such as tcs2")


def _item(items: list[dict[str, Any]], part: str, key: str) -> int:
    names = [str(item.get("name", f"hot side at {item.get('t_hot_C')} °C")) for item in items]
    if part.isascii() and part.isdigit() and len(part) < 5 and int(part) < len(items):
        return int(part)
    if part in names:
        return names.index(part)
    kind = "probe" if key.startswith("probe.") else "data sheet" if key.startswith("module.") else "layer"
    raise RigError(f"{key}: no such {kind}; there are {', '.join(f'{i} ({name})' for i, name in enumerate(names))}")


def toml_text(document: Mapping[str, Any]) -> str:
    """Return a document of numbers, texts, lists and tables as TOML."""
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
