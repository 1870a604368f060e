"""The demands of the gate beside what meets them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from thermicon.base.files.inputs import InputError
from thermicon.base.words.near_words import did_you_mean

from ..play.watch import Refused
from ..safety.demands import Demands, How

LABELS = {
    "watchdog_s": "watchdog",
    "cut_off_display_C": "cut-off",
    "held_cut_off_display_C": "second cut-off",
    "polarity_check": "polarity",
    "rest_before_first_play_s": "rest",
    "pause_at_least_s": "pause",
    "zero_current_at_most_s": "zero current",
    "current_limit_A": "current limit",
    "loop": "loop",
}
"""What people call the demands of a sidecar."""
READ_BACK = {
    "watchdog_s": "off after {:g} s of silence",
    "cut_off_display_C": "set to {:g} … {:g} °C, within {:g} s",
    "held_cut_off_display_C": "set to {:g} … {:g} °C, for {:g} s",
    "zero_current_at_most_s": "no hand for longer than {:g} s",
    "current_limit_A": "set to {:g} … {:g} A",
    "loop": "set to {:g} A/K, {:g} A/(K·s), {:g} A·s/K; sensor late by {:g} s, output by {:g} s",
}
"""What a device says that it holds."""
BY_PLAYER = {"rest_before_first_play_s": "held by this program", "pause_at_least_s": "held by this program"}
BY_PROOF = {"polarity_check": "the display must fall under the test's current"}


@dataclass(frozen=True, slots=True)
class MetDemand:
    """A demand by its label, in words, how it is met, and by what."""

    label: str
    demand: str
    how: How
    by: str


def statements_of(texts: Sequence[str]) -> dict[str, str]:
    """Statements of people by the name of a demand; InputError for one without a demand or a name."""
    names = {label: name for name, label in LABELS.items()}
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
        how: How = "missing"
        by = "the device does not hold it; state who does"
        if name in BY_PLAYER:
            how, by = "held", BY_PLAYER[name]
        elif name in BY_PROOF:
            how, by = "proven", BY_PROOF[name]
        elif _holds(name, demands, status):
            how, by = ("proven" if name == "watchdog_s" else "held"), READ_BACK[name].format(*_numbers(status[name]))
        elif name in stated:
            how, by = "stated", stated[name]
        rows.append(MetDemand(LABELS[name], _words(name, demands), how, by))
    return tuple(rows)


def refuse_missing(rows: Sequence[MetDemand]) -> None:
    """Refuse to play where a demand is missing."""
    if missing := [row for row in rows if row.how == "missing"]:
        needs = "; ".join(f"{row.label} ({row.demand})" for row in missing)
        raise Refused(f"nothing was put out, since nobody provides: {needs}; set the device, or state who does")


def _holds(name: str, demands: Demands, status: Mapping[str, Any]) -> bool:
    """Whether a device is set as strictly as is demanded."""
    held, asked = status.get(name), getattr(demands, name)
    if held is None:
        return False
    numbers = _numbers(held)
    if name == "watchdog_s":
        return bool(0.0 < numbers[0] <= asked)
    if name == "zero_current_at_most_s":
        return bool(numbers[0] <= asked)
    if name == "current_limit_A":
        return bool(asked[0] <= numbers[0] and numbers[1] <= asked[1])
    if name == "loop":
        kp, ki, kd, lag_s, delay_s = numbers
        inside = asked.kp_A_per_K[0] <= kp <= asked.kp_A_per_K[1] and asked.ki_A_per_Ks[0] <= ki <= asked.ki_A_per_Ks[1]
        late = lag_s <= asked.sensor_lag_at_most_s and delay_s <= asked.delay_at_most_s
        return bool(inside and late and kd == asked.kd_As_per_K and status.get("second_sensor"))
    within_s = asked.act_within_s if name == "cut_off_display_C" else asked.longer_than_s
    return bool(asked.low <= numbers[0] and numbers[1] <= asked.high and numbers[2] <= within_s)


def _numbers(held: Any) -> list[float]:
    return [float(each) for each in held] if isinstance(held, list | tuple) else [float(held)]


def _words(name: str, demands: Demands) -> str:
    """A demand in a few words."""
    asked = getattr(demands, name)
    if name == "cut_off_display_C":
        return f"{asked.low:g} … {asked.high:g} °C within {asked.act_within_s:g} s"
    if name == "held_cut_off_display_C":
        return f"{asked.low:g} … {asked.high:g} °C, no longer than {asked.longer_than_s:g} s with current"
    if name == "polarity_check":
        return f"{asked.test_current_A:g} A cools by {asked.display_change_at_least_K:g} K in {asked.test_s:g} s"
    if name == "current_limit_A":
        return f"{asked[0]:g} … {asked[1]:g} A".replace("-", "−")
    if name == "loop":
        kp, ki, _ = asked.played
        return f"{kp:.3g} A/K, {ki:.3g} A/(K·s), and a second sensor for the cut-off"
    if name == "rest_before_first_play_s":
        return f"{demands.rest_s:g} s before the first play"
    return f"{asked:g} s"
