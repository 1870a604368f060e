"""The rig file of a fit: fitted values, their intervals as uncertainty, and which logs and program they come from."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

from ..program import own_version
from ..rig.parts import Uncertainty
from ..rig.rig import Rig
from ..rig.rigfile import UncertaintyTable
from ..rig.settings import toml_text
from ..rig.uncertainty import uncertainty_of
from .identify import Parameter
from .keys import FitKey

DIGEST_DIGITS = 16
MOST_LOGS_NAMED = 5
PLATES = ("module.hot_plate_J_per_K", "module.cold_plate_J_per_K")
MISFIT = (
    "Rig and logs do not agree, so that the intervals cannot be trusted: [uncertainty] is as wide as before the fit, "
    "or wider."
)
LEAST_SHARE = 0.5
"""Share of the shipped uncertainty that is written at least: what a fit holds fixed, the heat sink above all, may bias
it by more than its interval says, and the safety gate relies on it."""

_SHIPPED = uncertainty_of({})
LARGEST = {
    name: float(schema["anyOf"][0]["maximum"])
    for name, schema in UncertaintyTable.model_json_schema()["properties"].items()
    if name != "reason"
}
"""The largest uncertainty that a rig file may state."""


def uncertainties(
    keys: Sequence[FitKey],
    parameters: Sequence[Parameter],
    *,
    before: Uncertainty,
    skin: bool = True,
    misfit: bool = False,
) -> dict[str, float]:
    """Return the keys of [uncertainty] with half widths of intervals, for what was identified.

    Both plates share one key: it is the wider of both, and nothing where only one was fitted. Contact with a load
    (`skin` is False) says nothing of contact with skin. After a `misfit`, and for what was not identified, only what
    must be wider is returned, so that what the rig held `before` still is.
    """
    stated: dict[str, float] = {}
    identified = {item.key for item in parameters if item.identified}
    for key, item in zip(keys, parameters, strict=True):
        if not key.uncertainty:
            continue
        if not skin and key.uncertainty == "contact_resistance_relative":
            continue
        held = getattr(before, key.uncertainty)
        if misfit or not item.identified:
            width = min(_rounded_up(_covering(item, held)), LARGEST[key.uncertainty])
            if width > held:
                stated[key.uncertainty] = max(width, stated.get(key.uncertainty, 0.0))
            continue
        if key.key in PLATES and not set(PLATES) <= identified:
            continue
        least = LEAST_SHARE * getattr(_SHIPPED, key.uncertainty)
        width = min(max(least, _rounded_up(item.half_width)), LARGEST[key.uncertainty])
        stated[key.uncertainty] = max(width, stated.get(key.uncertainty, 0.0))
    return stated


def _covering(item: Parameter, before: float) -> float:
    """Half width about a rig's value that holds the fitted interval and all that the rig before held, ±`before`.

    A rig keeps its value where the interval says nothing: of the fit, only the value need be held then.
    """
    if not item.identified:
        return abs(item.value - item.start) / (item.start if item.log else 1.0)
    ends = before * item.start if item.log else before
    low, high = min(item.low, item.start - ends), max(item.high, item.start + ends)
    most = max(high - item.value, item.value - low)
    return most / item.value if item.log else most


def reason_of(rig: Rig, sources: Sequence[tuple[str, str]]) -> str:
    """Return the reason why a fitted rig's uncertainty is smaller than the shipped one."""
    before = f"{rig.uncertainty.reason}; " if rig.uncertainty.reason else ""
    return f"{before}95 % intervals of a fit by thermicon {own_version()} to {named(sources)}"


def named(sources: Sequence[tuple[str, str]]) -> str:
    """Logs with the beginning of their digests."""
    few = [f"{name} (sha256 {digest[:DIGEST_DIGITS] or 'not from a file'})" for name, digest in sources]
    more = [f"{len(few) - MOST_LOGS_NAMED} more"] if len(few) > MOST_LOGS_NAMED else []
    return ", ".join([*few[:MOST_LOGS_NAMED], *more])


def fitted_text(
    rig: Rig,
    parameters: Sequence[Parameter],
    sources: Sequence[tuple[str, str]],
    name: str | None = None,
    *,
    layers: Sequence[str] = (),
    misfit: bool = False,
) -> str:
    """Return the TOML of a fitted rig, by a `name` of its own; every fitted value has interval and logs in [source].

    A parameter that was not identified has the value that it had before. `layers` were fitted along; `misfit`:
    residuals exceed the noise.
    """
    document: dict[str, Any] = json.loads(rig.document)
    if name:
        document["name"] = name
    origin = document.setdefault("source", {})
    for item in parameters:
        if not item.identified:
            earlier = f"{origin[item.key]}; " if item.key in origin else ""
            origin[item.key] = (
                f"{earlier}kept at {item.start:.6g} {item.unit}: not identified by these logs, thermicon "
                f"{own_version()}; log {named(sources)}"
            )
            continue
        origin[item.key] = (
            f"fitted by thermicon {own_version()}: {item.value:.6g} {item.unit}, 95 % {item.low:.6g} to "
            f"{item.high:.6g}, before {item.start:.6g}; log {named(sources)}"
        )
    for layer in layers:
        place = f"skin.layer.{layer}"
        origin[place] = (
            f"{origin.get(place, '')}; fitted along at this thickness, within the spread between people, by thermicon "
            f"{own_version()}; log {named(sources)}"
        ).lstrip("; ")
    free = ", ".join(item.key for item in parameters if item.identified) or "nothing"
    notes = [note for note in document.get("notes", []) if not note.startswith("fitted:")]
    close = MISFIT if misfit else "The intervals hold for the person, the contact and the room of these logs."
    document["notes"] = [
        *notes,
        f"fitted: {free}; logs {'; '.join(f'{name} sha256 {digest}' for name, digest in sources)}; thermicon "
        f"{own_version()}. {close}",
    ]
    return toml_text(document)


def _rounded_up(value: float) -> float:
    """Two significant digits, never less than the value."""
    digits = 1 - math.floor(math.log10(value)) if value > 0 else 2
    scale = 10.0**digits
    return float(round(math.ceil(value * scale - 1e-9) / scale, digits))
