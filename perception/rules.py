"""Rules of thumb, scored on an icon or a pair, each with its margin and its source.

The thresholds are data (`data/rules.toml`). Rules from the literature and rules of this project
are told apart by their source; none of them feeds the model.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from thermicon.circuit.records import Record, Table, load_records
from thermicon.perception.digits import significant
from thermicon.perception.features import direction_words, directions, excursion_K, excursion_rate_K_per_s, receptor_C
from thermicon.perception.observer import DATA, Channel
from thermicon.perception.percept import Percept

if TYPE_CHECKING:
    from thermicon.circuit import Trace

TOLD_APART = "told apart"
Plain = str | float | bool | None


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

    def to_dict(self) -> dict[str, Plain]:
        """The keys of the ranking file."""
        return {
            "rule": self.rule,
            "pass": self.passed,
            "value": self.value,
            "margin": self.margin,
            "threshold": self.threshold,
            "threshold_low": self.threshold_low,
            "unit": self.unit,
            "source": self.source,
            "text": self.text,
        }


@lru_cache(maxsize=1)
def load_rules() -> Table:
    """The rules as records; `get("statement")` and `get("scope")` say what each is about."""
    return load_records(DATA / "rules.toml", extra=("statement", "scope"))


def icon_rules(trace: Trace, percept: Percept) -> tuple[RuleResult, ...]:
    """Rules on one icon: change and rate in every direction it moves, latency, neutral zone."""
    table = load_rules()
    found = []
    moved = directions(trace) or ("cold", "warm")
    for channel in moved:
        change = abs(excursion_K(trace, channel))
        rate = abs(excursion_rate_K_per_s(trace, channel))
        found.append(_at_least(table.one("change at the receptor", channel=channel), channel, change))
        found.append(_at_least(table.one("rate at the receptor"), channel, rate))
    if percept.channel is None:
        for channel in moved:
            record = table.one("latency", channel=channel)
            low, high = record.interval
            band = f"{low:.3g} to {high:.3g}{_unit(record)}"
            text = f"latency: the icon is not felt, so it has no onset to hold against {band}"
            found.append(_result(record, channel, False, None, None, high, text, low))
    else:
        found.append(_inside(table.one("latency", channel=percept.channel), percept.channel, percept.onset_s or 0.0))
    found.append(_inside(table.one("neutral zone"), "cold", float(receptor_C(trace, "cold")[0])))
    return tuple(found)


def pair_rules(a: Trace, b: Trace, felt_a: Percept, felt_b: Percept) -> tuple[RuleResult, ...]:
    """Rules on a pair; the last, `told apart`, passes when any of this project's others does."""
    table = load_rules()
    moved_a, moved_b = directions(a), directions(b)
    shared = tuple(c for c in moved_a if c in moved_b)
    record = table.one("direction")
    differ = moved_a != moved_b
    verdict = "differ" if differ else "are the same"
    text = f"direction: {_label(a)} {direction_words(a)}, {_label(b)} {direction_words(b)}: directions {verdict}"
    ours = [_result(record, None, differ, float(differ), float(differ) - 1.0, 1.0, text)]
    theirs = []
    for channel in shared:
        gap = abs(excursion_K(a, channel) - excursion_K(b, channel))
        theirs.append(_at_least(table.one("amplitude difference", channel=channel), channel, gap))
        ours.append(_at_least(table.one("peak", channel=channel), channel, gap))
        rates = sorted(abs(excursion_rate_K_per_s(t, channel)) for t in (a, b))
        if rates[0] > 0.0:
            ours.append(_at_least(table.one("rate ratio"), channel, rates[1] / rates[0]))
    ours.append(_onset(table, felt_a, felt_b))
    return (*theirs, *ours, _any(table.one(TOLD_APART), ours))


def passes(results: Iterable[RuleResult], *rules: str) -> bool:
    """Whether every result passes (of the rules named, or of all)."""
    return all(r.passed for r in results if not rules or r.rule.split(" (")[0] in rules)


def _onset(table: Table, a: Percept, b: Percept) -> RuleResult:
    channel: Channel = "warm" if a.channel == b.channel == "warm" else "cold"
    record = table.one("onset", channel=channel)
    if a.onset_s is None or b.onset_s is None:
        differ = (a.onset_s is None) != (b.onset_s is None)
        text = "onset: only one of the two is felt" if differ else "onset: neither is felt"
        return _result(record, channel, differ, None, None, record.central, text)
    return _at_least(record, channel, abs(a.onset_s - b.onset_s))


def _any(record: Record, ours: list[RuleResult]) -> RuleResult:
    passed = [r.rule for r in ours if r.passed]
    text = f"{TOLD_APART}: {'by ' + ', '.join(passed) if passed else 'no rule separates the two'}"
    count = float(len(passed))
    return _result(record, None, bool(passed), count, count - 1.0, 1.0, text)


def _at_least(record: Record, channel: Channel, value: float) -> RuleResult:
    limit, unit = record.central, _unit(record)
    said = "passes" if value >= limit else "fails"
    shown, least = significant(value, limit)
    text = f"{record.quantity} ({channel}): {shown}{unit} against at least {least}{unit}: {said}"
    return _result(record, channel, value >= limit, value, value - limit, limit, text)


def _inside(record: Record, channel: Channel, value: float) -> RuleResult:
    low, high = record.interval
    unit, margin = _unit(record), min(value - low, high - value)
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
    return RuleResult(name, passed, value, margin, threshold, record.unit, record.source, text, threshold_low)


def _unit(record: Record) -> str:
    return "" if record.unit == "1" else f" {record.unit}"


def _label(trace: Trace) -> str:
    return trace.icon or "the cue"
