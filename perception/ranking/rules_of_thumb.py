"""Rules of thumb with their scores.

The thresholds are data (`data/rules.toml`). Rules from the literature and rules of this project
are distinguished by their source; none of them feeds the model. A rule whose value only the model
provides (when something is felt) is marked `from_model`, and no score by rules counts it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from thermicon.base.files.records import Record, RecordTable, load_records
from thermicon.base.words.number_text import significant, unit_text

from ..observer.observer import CHANNELS, DATA, Channel
from ..sensation import features
from ..sensation.percept import Percept

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace

DISTINGUISHABLE = "distinguishable"
OURS = ("direction", "peak", "rate ratio", "onset")
"""Rules of this project on a pair; one that passes makes it distinguishable."""
SAID = {"rate at the receptor": "rate of change (ROC) at the receptor"}
"""What a rule is called in its sentence, where the source paper has a name of its own."""
KEYS = ("rule", "passed", "value", "margin", "threshold", "threshold_low", "unit", "source", "text", "from_model")
"""Fields of a result in the order of the ranking file."""


@dataclass(frozen=True, slots=True)
class RuleResult:
    """One rule on one icon or pair; `margin` is how far the value is on the passing side (negative: fails).

    `value` and `margin` are None where there is nothing to measure, as for an icon that is not felt. A rule that asks
    for a value within a band has its lower end in `threshold_low` and its upper end in `threshold`; others have None.
    """

    rule: str
    passed: bool
    value: float | None
    margin: float | None
    threshold: float
    unit: str
    source: str
    text: str
    threshold_low: float | None = None
    from_model: bool = False

    @property
    def quantity(self) -> str:
        """Name of the rule without its channel, as in `peak (cold)`."""
        return self.rule.split(" (")[0]

    @property
    def normalised_margin(self) -> float | None:
        """Margin in shares of the threshold, or of half the band; None where there is no margin or no size."""
        size = self.threshold if self.threshold_low is None else 0.5 * (self.threshold - self.threshold_low)
        return None if self.margin is None or size == 0.0 else self.margin / size

    def to_dict(self) -> dict[str, Any]:
        """The keys of the ranking file."""
        return {"pass" if key == "passed" else key: getattr(self, key) for key in KEYS}


@lru_cache(maxsize=1)
def load_rules() -> RecordTable:
    """The rules as records; `statement`, `scope` and `basis` say what each is about."""
    return load_records(DATA / "rules.toml", extra=("statement", "scope", "basis"))


def icon_rules(trace: Trace, percept: Percept) -> tuple[RuleResult, ...]:
    """Rules on one icon: change and rate in every direction it moves, neutral zone; latency and felt peak.

    The last two compare what the model predicts with what is published, and are marked so. The window of
    latencies is for rates over 0.1 K/s; a slower change has no latency rule.
    """
    table = load_rules()
    found, slow = [], set()
    moved = features.directions(trace) or CHANNELS
    for channel in moved:
        change = abs(features.excursion_K(trace, channel))
        rate = abs(features.excursion_rate_K_per_s(trace, channel))
        found.append(_at_least(table.one("change at the receptor", channel=channel), channel, change))
        found.append(_at_least(table.one("rate at the receptor"), channel, rate))
        if not found[-1].passed:
            slow.add(channel)
    for channel in moved if percept.channel is None else (percept.channel,):
        if channel not in slow:
            found.append(_latency(table.one("latency", channel=channel), channel, percept.onset_s))
    for channel in features.directions(trace):
        lead = features.peak_lead_s(trace, percept, channel)
        if lead is not None:
            found.append(_felt_peak(table.one("felt peak", channel=channel), channel, lead))
    found.append(_inside(table.one("neutral zone"), "cold", float(features.receptor_C(trace, "cold")[0])))
    return tuple(found)


def pair_rules(a: Trace, b: Trace) -> tuple[RuleResult, ...]:
    """Rules on a pair; the last, `distinguishable`, passes when any other rule of this project does.

    All of them are read off the two traces: onsets are the times at which a receptor passes its threshold.
    """
    table = load_rules()
    moved_a, moved_b = features.directions(a), features.directions(b)
    shared = tuple(c for c in moved_a if c in moved_b)
    least = {channel: table.one("change at the receptor", channel=channel).central for channel in CHANNELS}
    both = (a, moved_a), (b, moved_b)
    felt_a, felt_b = ({c for c in moved if abs(features.excursion_K(t, c)) >= least[c]} for t, moved in both)
    differ = felt_a != felt_b
    verdict = "differ" if differ else "are the same" if moved_a == moved_b else "differ below the threshold alone"
    words = ", ".join(f"{each.icon or 'the cue'} {features.direction_words(moved)}" for each, moved in both)
    text = f"direction: {words}: directions {verdict}"
    ours = [_result(table.one("direction"), None, differ, float(differ), float(differ) - 1.0, 1.0, text)]
    theirs = []
    for channel in shared:
        gap = abs(features.excursion_K(a, channel) - features.excursion_K(b, channel))
        theirs.append(_at_least(table.one("amplitude difference", channel=channel), channel, gap))
        ours.append(_at_least(table.one("peak", channel=channel), channel, gap))
        rates = sorted(abs(features.excursion_rate_K_per_s(t, channel)) for t in (a, b))
        if rates[0] > 0.0:
            ours.append(_at_least(table.one("rate ratio"), channel, rates[1] / rates[0]))
    ours.append(_onset(table, a, b))
    passed = [r.rule for r in ours if r.passed]
    text = f"{DISTINGUISHABLE}: {'by ' + ', '.join(passed) if passed else 'no rule separates the two'}"
    count = float(len(passed))
    whole = _result(table.one(DISTINGUISHABLE), None, bool(passed), count, count - 1.0, 1.0, text)
    return (*theirs, *ours, whole)


def rig_rules(rig: Rig) -> tuple[RuleResult, ...]:
    """Rules on the rig that a whole set is played on: the depths of its receptors, and in which layer they lie."""
    table, found = load_rules(), []
    for channel in CHANNELS:
        record = table.one("depth", channel=channel)
        depth_m = rig.skin.cold_receptor_m if channel == "cold" else rig.skin.warm_receptor_m
        result = _inside(record, channel, round((depth_m - rig.skin.corneum_m) * 1e3, 9))
        bottoms = zip(accumulate(layer.thickness_m for layer in rig.skin.layers), rig.skin.layers, strict=True)
        inside = next((layer for bottom_m, layer in bottoms if depth_m <= bottom_m), rig.skin.layers[-1])
        found.append(replace(result, text=f"{result.text}; on this rig that is inside the {inside.name}"))
    return tuple(found)


def first_passing(trace: Trace) -> tuple[float, Channel] | None:
    """The time (s) when a receptor first passes its rule's threshold, and which; None where neither does."""
    table = load_rules()
    least = {channel: table.one("change at the receptor", channel=channel).central for channel in CHANNELS}
    times = [(features.passing_s(trace, channel, least[channel]), channel) for channel in CHANNELS]
    return min(((time, channel) for time, channel in times if time is not None), default=None)


def _latency(record: Record, channel: Channel, onset_s: float | None) -> RuleResult:
    if onset_s is not None:
        return _inside(record, channel, onset_s)
    low, high = record.interval
    band = f"{low:.3g} to {high:.3g}{unit_text(record.unit)}"
    text = f"latency: the nominal person does not feel the icon, so it has no onset to compare with {band}"
    return _result(record, channel, False, None, None, high, text, low)


def _felt_peak(record: Record, channel: Channel, lead: float) -> RuleResult:
    margin = -lead if channel == "cold" else lead
    asked = "before" if channel == "cold" else "after"
    size = f"{abs(lead):.2f} s {'before' if lead < 0 else 'after'}"
    said = "passes" if margin > 0 else "fails"
    text = f"felt peak ({channel}): predicted {size} that of the skin, published {asked} it: {said}"
    return _result(record, channel, margin > 0, lead, margin, record.central, text)


def _onset(table: RecordTable, a: Trace, b: Trace) -> RuleResult:
    first, second = first_passing(a), first_passing(b)
    both_warm = first is not None and second is not None and first[1] == second[1] == "warm"
    channel: Channel = "warm" if both_warm else "cold"
    record = table.one("onset", channel=channel)
    if first is None or second is None:
        differ = (first is None) != (second is None)
        text = f"onset: {'only one of the two' if differ else 'neither'} passes the threshold of a receptor"
        return _result(record, channel, differ, None, None, record.central, text)
    return _at_least(record, channel, abs(first[0] - second[0]))


def _at_least(record: Record, channel: Channel, value: float) -> RuleResult:
    limit, unit = record.central, unit_text(record.unit)
    said = "passes" if value >= limit else "fails"
    shown, least = significant(value, limit)
    name = SAID.get(record.quantity, record.quantity)
    text = f"{name} ({channel}): {shown}{unit} against at least {least}{unit}: {said}"
    return _result(record, channel, value >= limit, value, value - limit, limit, text)


def _inside(record: Record, channel: Channel, value: float) -> RuleResult:
    low, high = record.interval
    unit, margin = unit_text(record.unit), min(value - low, high - value)
    said = "passes" if margin >= 0 else "fails"
    shown, least, most = significant(value, low, high)
    text = f"{record.quantity} ({channel}): {shown}{unit} against {least} to {most}{unit}: {said}"
    return _result(record, channel, margin >= 0, value, margin, high, text, low)


def _result(
    record: Record,
    channel: Channel | None,
    passed: bool,
    value: float | None,
    margin: float | None,
    threshold: float,
    text: str,
    threshold_low: float | None = None,
) -> RuleResult:
    name = record.quantity if channel is None else f"{record.quantity} ({channel})"
    model = record.get("basis") == "model"
    return RuleResult(name, passed, value, margin, threshold, record.unit, record.source, text, threshold_low, model)
