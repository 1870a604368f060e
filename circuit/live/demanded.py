"""The demands of the gate beside what meets them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from thermicon.base.files.inputs import InputError
from thermicon.base.words.near_words import did_you_mean

from ..play.watch import Refused
from ..safety.demands import CutOff, Demands, HeldCutOff, How, Loop

WORDS = {
    "watchdog_s": ("watchdog", "{:g} s"),
    "cut_off_display_C": ("cut-off", "{0.low:g} … {0.high:g} °C within {0.react_within_s:g} s"),
    "held_cut_off_display_C": ("second cut-off", "{0.low:g} … {0.high:g} °C for {0.longer_than_s:g} s with current"),
    "polarity_check": ("polarity", "{0.test_current_A:g} A cools by {0.display_change_at_least_K:g} K"),
    "rest_before_first_play_s": ("rest", "{:g} s"),
    "pause_at_least_s": ("pause", "{:g} s"),
    "zero_current_at_most_s": ("zero current", "{:g} s"),
    "current_limit_A": ("current limit", "{0[0]:g} … {0[1]:g} A"),
    "loop": (
        "loop",
        "{0.kp_A_per_K[0]:g} … {0.kp_A_per_K[1]:g} A/K, {0.ki_A_per_Ks[0]:g} … {0.ki_A_per_Ks[1]:g} A/(K·s), sensor "
        "late by {0.sensor_lag_at_most_s:g} s",
    ),
}
"""Demands by name: their label, and how a demand and what a device holds are written."""
BY_PLAYER: dict[str, tuple[How, str]] = {
    "polarity_check": ("proven", "both sensors must fall"),
    "rest_before_first_play_s": ("held", "by this program"),
    "pause_at_least_s": ("held", "by this program"),
}
"""What meets demands whatever the device is."""


@dataclass(frozen=True, slots=True)
class MetDemand:
    """A demand by its label, in words, how it is met, and by what."""

    label: str
    demand: str
    how: How
    by: str


def statements_of(texts: Sequence[str]) -> dict[str, str]:
    """Statements of people by the name of a demand; InputError for one without a demand or a name."""
    names = {label: name for name, (label, _) in WORDS.items()}
    statements = {}
    for text in texts:
        label, _, rest = (part.strip() for part in text.partition(":"))
        what, _, who = (part.strip() for part in rest.rpartition(","))
        if not what or not who:
            raise InputError(f"{text!r} is no statement; write DEMAND: WHAT, WHO, as in 'current limit: fuse, A. Name'")
        if label not in names:
            raise InputError(f"{label!r} is no demand; {did_you_mean(label, names)}")
        statements[names[label]] = f"{what}, {who}"
    return statements


def met_demands(demands: Demands, status: Mapping[str, Any], stated: Mapping[str, str]) -> tuple[MetDemand, ...]:
    """How each demand is met by a device that says what it holds; a watchdog is proven before the first play."""
    rows = []
    for name in demands.demanded:
        label, text = WORDS[name]
        asked, held = demands.rest_s if "rest" in name else getattr(demands, name), status.get(name)
        how, by = BY_PLAYER.get(name, ("missing", "the device does not hold it; state who does"))
        if how == "missing" and held is not None and _is_inside(held, asked):
            how, by = "proven" if name == "watchdog_s" else "held", text.format(held).replace("-", "−")
        elif how == "missing" and name in stated:
            how, by = "stated", stated[name]
        rows.append(MetDemand(label, text.format(asked).replace("-", "−"), how, by))
    return tuple(rows)


def refuse_missing(rows: Sequence[MetDemand]) -> None:
    """Refuse to play where a demand is missing."""
    missing = [f"{row.label} ({row.demand})" for row in rows if row.how == "missing"]
    if missing:
        raise Refused(f"nothing was put out, since nobody provides: {'; '.join(missing)}; set the device, or state who")


def _is_inside(held: Any, asked: Any) -> bool:
    spans = zip(_spans(held), _spans(asked), strict=True)
    return all(within[0] <= span[0] and span[1] <= within[1] for span, within in spans)


def _spans(demand: Any) -> list[tuple[float, float]]:
    """What a demand allows, as the least and the most of each number."""
    match demand:
        case CutOff():
            return [(demand.low, demand.high), (-math.inf, demand.react_within_s)]
        case HeldCutOff():
            return [(demand.low, demand.high), (-math.inf, demand.longer_than_s)]
        case Loop():
            most = (demand.delay_at_most_s, demand.sensor_lag_at_most_s, demand.sensor_offset_at_most_K)
            gains = [demand.kp_A_per_K, demand.ki_A_per_Ks, (demand.kd_As_per_K, demand.kd_As_per_K)]
            return [*gains, *((-math.inf, each) for each in most)]
        case (low, high):
            return [(low, high)]
    return [(-math.inf, float(demand))]
