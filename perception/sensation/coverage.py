"""Warnings for icons outside the published data and outside what the evidence varied.

What the evidence varied stands in `data/spans.csv`, which ``python -m thermicon.perception.evidence observer`` writes;
limits that it does not say are records of `data/coverage.toml`.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.files.records import Record, RecordTable, load_records
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.near_words import proposals
from thermicon.base.words.number_text import significant

from ..observer.mechanisms.summation import CM2
from ..observer.observer import DATA

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace

CALIBRATED = "thenar"
REST_SLACK_K = 0.25
"""A thermode at the end of the span leaves the skin under it a little warmer or colder."""
DURATION_SLACK_S = 0.05
"""Shorter differences are those of a ramp's length."""
MIRRORS = ("left", "right")
ALIKE = 0.8
"""How alike a name must be spelt to a site's for it to be meant: hand is not meant by head."""
NEAREST = {
    "thenar": (("fingertip", "finger", "fingers", "palm", "hypothenar", "thumb"), "hairless skin of the same hand"),
    "hand-dorsum": (("hand", "knuckle"), "the same hand"),
    "wrist": (("wrist",), "the same joint"),
    "forearm": (("arm", "elbow", "shoulder"), "hairy skin of the same limb"),
    "foot": (("foot", "sole", "toe", "ankle", "leg", "calf", "shin", "thigh", "knee"), "the same limb"),
    "face": (("face", "cheek", "forehead", "lip", "chin", "neck", "temple"), "the same part of the body"),
}
"""For each recorded site, words of sites that it is the nearest to, and why."""

RESPECTS: Mapping[str, str] = {
    "rest": "°C", "area": "cm²", "size": "K", "rate": "K/s", "duration": "s", "age": "years",
}  # fmt: skip
"""What is varied, with its unit: the resting temperature, the contact, the change and its rate, a trial, the people."""


@dataclass(frozen=True, slots=True)
class EvidenceSpan:
    """What the experiments varied in one respect; `low_of` and `high_of` name those at its ends."""

    respect: str
    unit: str
    low: float
    low_of: str
    high: float
    high_of: str

    def outside(self, value: float, subject: str, slack: float = 0.0) -> str:
        """Where a value lies more than `slack` outside, `subject` with the value and the span; empty inside."""
        if self.low - slack <= value <= self.high + slack:
            return ""
        bound = self.low if value < self.low else self.high
        shown, _ = significant(value, bound)
        return f"{subject} {shown} {self.unit} (the evidence: {self.low:.3g} to {self.high:.3g} {self.unit})"


def load_spans() -> Mapping[str, EvidenceSpan]:
    """The shipped spans by respect.

    >>> load_spans()["rest"].low
    30.0
    """
    with (DATA / "spans.csv").open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {
            row["respect"]: EvidenceSpan(
                row["respect"], row["unit"], float(row["low"]), row["low_of"], float(row["high"]), row["high_of"]
            )
            for row in rows
        }


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
    spans = load_spans()
    setting = _setting(spans, float(trace.skin_C[0]), trace.area_m2, trace.site)
    return (*setting, *_course(spans, trace), *found)


def outside_setting(baseline_C: float | None, rig: Rig) -> tuple[str, ...]:
    """A sentence on rest, contact and site, where no experiment had them; None: skin rests as the rig has it."""
    rest_C = rig.skin.rest_C if baseline_C is None else baseline_C
    return _setting(load_spans(), rest_C, rig.contact.area_m2, rig.site)


def outside_age(age_years: float) -> tuple[str, ...]:
    """A sentence where people are younger or older than those of every experiment."""
    return _joined(load_spans()["age"].outside(age_years, "people are aged"))


def _setting(spans: Mapping[str, EvidenceSpan], rest_C: float, area_m2: float, site: str) -> tuple[str, ...]:
    rest = spans["rest"].outside(rest_C, "the skin rests at", REST_SLACK_K)
    return _joined(rest, spans["area"].outside(area_m2 / CM2, "the contact is"), *outside_site(site))


def _course(spans: Mapping[str, EvidenceSpan], trace: Trace) -> tuple[str, ...]:
    """A sentence on the duration, the size and the rate of what is played, where no experiment had them."""
    course = trace.current_A if trace.control == "current" else trace.target_C
    changes = np.flatnonzero(np.diff(course))
    if not changes.size:
        return ()
    lasting_s = float(trace.time_s[changes[-1] + 1] - trace.time_s[changes[0]])
    size_K = float(np.abs(trace.skin_C - trace.skin_C[0]).max())
    fastest_K_per_s = float(np.abs(np.diff(trace.skin_C) / np.diff(trace.time_s)).max())
    return _joined(
        spans["duration"].outside(lasting_s, "it changes for", DURATION_SLACK_S),
        spans["size"].outside(size_K, "the skin changes by"),
        spans["rate"].outside(fastest_K_per_s, "the skin changes at"),
    )


def _joined(*told: str) -> tuple[str, ...]:
    sentence = ", ".join(filter(None, told))
    return (sentence,) if sentence else ()


def outside_site(site: str) -> tuple[str, ...]:
    """A sentence where no detection threshold is published for a site."""
    known = {record.site for record in load_coverage().select("site")}
    words = [word for word in site.lower().split() if word not in MIRRORS]
    if "-".join(words) in known:
        return ()
    named = {site for site in known if site} | {word for others, _ in NEAREST.values() for word in others}
    near = [] if "-".join(words) in named else proposals("-".join(words), named, cutoff=ALIKE)
    meant = f" (did you mean {near[0]}?)" if near else ""
    return (f"no detection threshold is on record for the {site}{meant}: those of the {CALIBRATED} are used",)


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
