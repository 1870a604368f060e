"""A cue set as JSON with the schema ``data/cue.schema.json``."""

import json
from dataclasses import fields
from typing import Any

from thermicon.base.checks.arguments import checked

from ..model.context import Metadata
from ..model.family import Family
from ..model.format import Holes
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.parameter import Path
from ..model.spatial import Part, SpatialIcon, Together
from ..model.statements import Play, Repeat, Return, Statement

_SAME_AS_LEFT_OUT = {"direction": "change", "cut": False}


@checked
def to_json(icons: IconSet) -> str:
    """Return a set as JSON text, with everything but comments.

    Parameters
    ----------
    icons
        The set.

    Returns
    -------
    str
        JSON whose keys contain their units, as in ``rate_K_per_s``.

    Examples
    --------
    >>> from thermicon.icons import parse
    >>> made = json.loads(to_json(parse("cue 1; icon dip { cool by 6 °C at 3 °C/s; return over 2 s }")))
    >>> made["icons"][0]["statements"]
    [{'do': 'cool', 'by_K': 6.0, 'rate_K_per_s': 3.0}, {'do': 'return', 'duration_s': 2.0}]
    """
    context = icons.context
    head = {"name": icons.name or None, "title": icons.title or None, "site": context.site, "control": context.control}
    level = {"elements": list(context.elements) or None, "baseline_C": context.baseline_C}
    document = {
        "format": "thermicon cue",
        "version": 1,
        "set": _given({**head, **level, **_metadata(icons.metadata)}),
        "icons": [*map(_icon, icons.entries), *map(_spatial, icons.spatial)],
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def _icon(entry: Icon | Family) -> dict[str, Any]:
    head = {"name": entry.name, **_metadata(entry.metadata)}
    if isinstance(entry, Icon):
        return _given({**head, "statements": [_statement(part, {}, entry) for part in entry.statements]})
    holes = {(slot.path, slot.field): slot.parameter for slot in entry.slots}
    body = [_statement(part, holes, entry, (n,)) for n, part in enumerate(entry.template)]
    parameters = []
    for own in entry.parameters:
        values: dict[str, Any] = dict(zip(("low", "high", "step"), own.span or (), strict=False))
        values = values or {"values": list(own.listed)}
        parameters.append(_given({"name": own.name, "unit": own.unit or None, **values}))
    return _given({**head, "parameters": parameters, "statements": body})


def _spatial(icon: SpatialIcon) -> dict[str, Any]:
    parts = [_part(part, icon) for part in icon.parts]
    return _given({"name": icon.name, **_metadata(icon.metadata), "statements": parts})


def _part(part: Part, owner: SpatialIcon) -> dict[str, Any]:
    if isinstance(part, Together):
        return {"do": "together", "statements": [_part(each, owner) for each in part.parts]}
    every = {"every_s": every_s} if (every_s := getattr(part, "every_s", None)) is not None else {}
    body = [_statement(each, {}, owner) for each in part.body]
    return {"do": type(part).__name__.lower(), "elements": list(part.names), **every, "statements": body}


def _statement(part: Statement, holes: Holes, owner: Icon | Family | SpatialIcon, path: Path = ()) -> dict[str, Any]:
    values = {field.name: getattr(part, field.name) for field in fields(part) if field.name != "span"}
    values = {name: value for name, value in values.items() if value is not None}
    values.update({name: {"parameter": holes[path, name]} for name in values if (path, name) in holes})
    kind = type(part).__name__.lower()
    if isinstance(part, Repeat):
        inner = [_statement(each, holes, owner, (*path, n)) for n, each in enumerate(part.body)]  # type: ignore[arg-type]
        return {"do": kind, "count": values["count"], "statements": inner}
    if isinstance(part, Play):
        return {"do": kind, "icon": part.icon.name}
    if isinstance(part, Return) and "rate_per_s" in values:
        rate = "rate_A_per_s" if owner.context.control == "current" else "rate_K_per_s"
        return {"do": kind, rate: values["rate_per_s"]}
    if kind == "ramp":
        return {"do": values.pop("direction"), **values}
    if kind == "wave":
        kind = values.pop("shape")
    kind = {"current": "drive"}.get(kind, kind)
    return {"do": kind, **{name: value for name, value in values.items() if _SAME_AS_LEFT_OUT.get(name) != value}}


def _metadata(metadata: Metadata) -> dict[str, Any]:
    found = {field.name: getattr(metadata, field.name) for field in fields(metadata)}
    return {**found, "tags": list(metadata.tags) or None}


def _given(values: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}
