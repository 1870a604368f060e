"""The demands of the gate beside what meets them."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from itertools import chain
from typing import Any, NamedTuple, cast

from thermicon.base.files.inputs import InputError
from thermicon.base.words.near_words import did_you_mean

from ..play.watch import Refused
from ..safety.demands import Demands, How

Numbers = Sequence[float]


class Asked(NamedTuple):
    """A kind of demand: what people call it, how it and what a device holds are written, when that is strict enough."""

    label: str
    demand: str
    held: str
    is_met: Callable[[Numbers, Numbers], bool]


def _inside(asked: Numbers, held: Numbers) -> bool:
    return asked[0] <= held[0] and held[1] <= asked[1] and all(map(operator.le, held[2:], asked[2:]))


def _is_loop_met(asked: Numbers, held: Numbers) -> bool:
    least_kp, most_kp, least_ki, most_ki, asked_kd, most_delay_s, most_lag_s, *_ = asked
    kp, ki, kd, lag_s, delay_s = held
    gains = least_kp <= kp <= most_kp and least_ki <= ki <= most_ki and kd == asked_kd
    return gains and lag_s <= most_lag_s and delay_s <= most_delay_s


def _never(asked: Numbers, held: Numbers) -> bool:
    return False


ASKED = {
    "watchdog_s": Asked("watchdog", "{:g} s", "off after {:g} s of silence", lambda a, h: 0.0 < h[0] <= a[0]),
    "cut_off_display_C": Asked(
        "cut-off", "{:g} … {:g} °C within {:g} s", "set to {:g} … {:g} °C, within {:g} s", _inside
    ),
    "held_cut_off_display_C": Asked(
        "second cut-off", "{:g} … {:g} °C for {:g} s with current", "set to {:g} … {:g} °C, for {:g} s", _inside
    ),
    "polarity_check": Asked("polarity", "after {1:g} s off, {2:g} A cools by {4:g} K in {3:g} s", "", _never),
    "rest_before_first_play_s": Asked("rest", "{:g} s before the first play", "", _never),
    "pause_at_least_s": Asked("pause", "{:g} s", "", _never),
    "zero_current_at_most_s": Asked("zero current", "{:g} s", "no hand for longer", lambda a, h: h[0] <= a[0]),
    "current_limit_A": Asked("current limit", "{:g} … {:g} A", "set to {:g} … {:g} A", _inside),
    "loop": Asked(
        "loop",
        "{:g} to {:g} A/K, {:g} to {:g} A/(K·s), second sensor",
        "set to {:g} A/K, {:g} A/(K·s), {:g} A·s/K; sensor late by {:g} s, output by {:g} s",
        _is_loop_met,
    ),
}
"""The demands of a sidecar, by name."""
BY_PLAYER = {
    "polarity_check": ("proven", "both sensors must fall"),
    "rest_before_first_play_s": ("held", "kept by this program"),
    "pause_at_least_s": ("held", "kept by this program"),
}
"""How demands are met whatever the device is."""


@dataclass(frozen=True, slots=True)
class MetDemand:
    """A demand by its label, in words, how it is met, and by what."""

    label: str
    demand: str
    how: How
    by: str


def statements_of(texts: Sequence[str]) -> dict[str, str]:
    """Statements of people by the name of a demand; InputError for one without a demand or a name."""
    names = {kind.label: name for name, kind in ASKED.items()}
    said = {}
    for text in texts:
        label, colon, rest = (part.strip() for part in text.partition(":"))
        what, comma, who = (part.strip() for part in rest.rpartition(","))
        if not (colon and comma and what and who):
            raise InputError(f"{text!r} is no statement; write DEMAND: WHAT, WHO, as in 'current limit: fuse, A. Name'")
        if label not in names:
            raise InputError(f"{label!r} is no demand; {did_you_mean(label, names)}")
        said[names[label]] = f"{what}, {who}"
    return said


def met_demands(demands: Demands, status: Mapping[str, Any], stated: Mapping[str, str]) -> tuple[MetDemand, ...]:
    """How each demand is met by a device that says what it holds; what is proven is so once the proofs were made."""
    rows = []
    for name in demands.demanded:
        kind, asked = ASKED[name], _numbers(demands.rest_s if "rest" in name else getattr(demands, name))
        held = None if status.get(name) is None else _numbers(status[name])
        has_sensor = name != "loop" or bool(status.get("second_sensor"))
        how, by = ("missing", "the device does not hold it; state who does")
        if name in BY_PLAYER:
            how, by = BY_PLAYER[name]
        elif held is not None and has_sensor and kind.is_met(asked, held):
            how, by = "proven" if name == "watchdog_s" else "held", kind.held.format(*held)
        elif name in stated:
            how, by = "stated", stated[name]
        demand = kind.demand.format(*asked).replace("-", "−")
        rows.append(MetDemand(kind.label, demand, cast(How, how), by.replace(" -", " −")))
    return tuple(rows)


def refuse_missing(rows: Sequence[MetDemand]) -> None:
    """Refuse to play where a demand is missing."""
    missing = [row for row in rows if row.how == "missing"]
    if missing:
        needs = "; ".join(f"{row.label} ({row.demand})" for row in missing)
        raise Refused(f"nothing was put out, since nobody provides: {needs}; set the device, or state who does")


def _numbers(held: Any) -> list[float]:
    """All numbers of a demand, or of what a device holds, in order."""
    if is_dataclass(held):
        held = [getattr(held, each.name) for each in fields(held)]
    return list(chain.from_iterable(map(_numbers, held))) if isinstance(held, list | tuple) else [float(held)]
