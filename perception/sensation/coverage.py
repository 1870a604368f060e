"""Warnings for icons outside the published data (`data/coverage.toml`)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.files.records import Record, RecordTable, load_records
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import significant

from ..observer.observer import DATA

if TYPE_CHECKING:
    from thermicon.circuit import Trace

CALIBRATED = "thenar"
MIRRORS = ("left", "right")
NEAREST = {
    "thenar": (("fingertip", "finger", "fingers", "palm", "hypothenar", "thumb"), "hairless skin of the same hand"),
    "hand-dorsum": (("hand", "knuckle"), "the same hand"),
    "wrist": (("wrist",), "the same joint"),
    "forearm": (("arm", "elbow", "shoulder"), "hairy skin of the same limb"),
    "foot": (("foot", "sole", "toe", "ankle", "leg", "calf", "shin", "thigh", "knee"), "the same limb"),
    "face": (("face", "cheek", "forehead", "lip", "chin", "neck", "temple"), "the same part of the body"),
}
"""For each recorded site, words of sites that it is the nearest to, and why."""


@lru_cache(maxsize=1)
def load_coverage() -> RecordTable:
    """The limits as records: `temperature`, `rate` and, one a site, `site`."""
    return load_records(DATA / "coverage.toml", extra=("recorded",))


def outside_data(trace: Trace) -> tuple[str, ...]:
    """Sentences, one for each way in which a simulated icon is outside the data; empty where it is inside."""
    table = load_coverage()
    places = (
        ("the skin", trace.skin_C),
        ("the cold receptor", trace.cold_receptor_C),
        ("the warm receptor", trace.warm_receptor_C),
    )
    found = [*_temperatures(table.one("temperature"), places, trace.time_s), *_rates(table.one("rate"), places, trace)]
    return (*found, *outside_site(trace.site))


def outside_site(site: str) -> tuple[str, ...]:
    """A sentence where no detection threshold is published for a site."""
    known = {record.site for record in load_coverage().select("site")}
    words = [word for word in site.lower().split() if word not in MIRRORS]
    if "-".join(words) in known:
        return ()
    return (f"no detection threshold is on record for the {site}: those of the {CALIBRATED} are used",)


def nearest_site(site: str) -> tuple[str | None, str]:
    """The recorded site that is nearest to one without records, and why; None where none is near."""
    words = set(site.lower().replace("-", " ").split())
    for recorded, (near, why) in NEAREST.items():
        if words & set(near):
            return recorded, why
    return None, "no recorded site is near it"


def _temperatures(record: Record, places: tuple[tuple[str, Array], ...], time_s: Array) -> list[str]:
    """The place that goes furthest below and above, one sentence each: the others follow from it."""
    said, (low, high) = [], record.interval
    for sign, bound, moves, data in ((-1.0, low, "falls", "begin"), (1.0, high, "rises", "end")):
        name, course = max(places, key=lambda place: float((sign * place[1]).max()))
        k = int((sign * course).argmax())
        if sign * (course[k] - bound) > 0.0:
            shown, limit = significant(float(course[k]), bound)
            said.append(f"{name} {moves} to {shown} °C ({time_s[k]:.1f} s); data {data} at {limit} °C")
    return said


def _rates(record: Record, places: tuple[tuple[str, Array], ...], trace: Trace) -> list[str]:
    """The place that changes fastest, in one sentence."""
    rates = {name: np.abs(np.diff(course) / np.diff(trace.time_s)) for name, course in places}
    name, rate = max(rates.items(), key=lambda place: float(place[1].max()))
    k = int(rate.argmax())
    if rate[k] <= record.interval[1]:
        return []
    shown, limit = significant(float(rate[k]), record.interval[1])
    return [f"{name} changes at {shown} K/s ({trace.time_s[k]:.1f} s); data end at {limit} K/s"]
