"""The rules of safety with their sourced limits."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache

from thermicon.base.files.records import Record, RecordTable, shipped_records
from thermicon.base.words.number_text import unit_text

from .faults import sentence

SHORTEST_REASON, FEWEST_WORDS = 20, 4
"""Fewest characters and different words of a reason for a loosened limit: a sentence, not a word."""

SESSION_KEY, LONGEST_SESSION_MIN = "session_min", 480.0
"""The key of a rig file's [safety] table for how long a session lasts, over which doses add up; 8 h at most."""

_EXTRA = (
    *("severity", "above_C", "low_key", "high_key"),
    *("low_bound", "high_bound", "low_bound_source", "high_bound_source"),
)


@dataclass(frozen=True, slots=True)
class Rule:
    """One side of one limit: what may not go above (`upper`) or below `limit`, in `unit`.

    `severity` is hard or soft. `key` names it in a rig file's [safety] table, empty where it is fixed; `bound` is
    the published limit of loosening; None: it can only be tightened.
    With `above_C` it limits the time in s that the display is warmer. A limit in K counts from where a run began.
    `shipped` is the limit unchanged.
    """

    quantity: str
    severity: str
    upper: bool
    limit: float
    unit: str
    source: str
    key: str
    bound: float | None
    bound_source: str
    shipped: float
    above_C: float | None = None

    @property
    def relative(self) -> bool:
        """Whether the limit counts from where a run began."""
        return self.unit == "K"

    @property
    def always_hard(self) -> bool:
        """Whether it is hard at any instant: not from where a run began, nor for a time that a display is warm."""
        return self.severity == "hard" and not self.relative and self.above_C is None

    @property
    def loosened(self) -> bool:
        """Whether it lets more pass than the shipped limit."""
        return self.limit > self.shipped if self.upper else self.limit < self.shipped


@dataclass(frozen=True, slots=True)
class Limits:
    """All rules that a run is checked against, and the reason for those that are loosened.

    Parameters
    ----------
    rules
        The rules, each with quantity, limit, unit and source.
    reason
        Why rules are looser than the shipped ones; empty where none is.
    session_s
        Length in s of a session, over which doses add up.

    Examples
    --------
    >>> Limits.shipped()
    Limits(22 rules, as shipped)
    >>> Limits.of({"skin_highest_C": 39.0})
    Limits(22 rules, skin_highest_C 39 °C instead of 42 °C)
    """

    rules: tuple[Rule, ...]
    reason: str = ""
    session_s: float = 1800.0

    def __repr__(self) -> str:
        return f"Limits({len(self.rules)} rules, {'; '.join(self.changed) or 'as shipped'})"

    @staticmethod
    @cache
    def shipped() -> Limits:
        """Return the shipped limits."""
        return Limits(tuple(rule for record in limit_table() for rule in _rules(record)))

    @staticmethod
    def of(changes: Mapping[str, float], reason: str = "") -> Limits:
        """Return the shipped limits with some changed by key; raises ValueError with every fault, a line each."""
        if faults := faults_of(changes, reason):
            raise ValueError("\n".join(faults))
        limits = _changed(changes, reason.strip())
        minutes = changes.get(SESSION_KEY)
        return limits if minutes is None else replace(limits, session_s=60.0 * minutes)

    @property
    def changed(self) -> tuple[str, ...]:
        """A few words for each limit that is not the shipped one, in the order of the rules."""
        return _in_words(rule for rule in self.rules if rule.limit != rule.shipped) + self._session(True)

    @property
    def loosened(self) -> tuple[str, ...]:
        """A few words for each limit that is looser than the shipped one."""
        return _in_words(rule for rule in self.rules if rule.loosened) + self._session(False)

    def _session(self, longer: bool) -> tuple[str, ...]:
        """The session in words where it is not the shipped one; without `longer` only where it is shorter."""
        shipped = Limits.shipped().session_s
        if self.session_s == shipped or (self.session_s > shipped and not longer):
            return ()
        return (f"{SESSION_KEY} {self.session_s / 60:g} min instead of {shipped / 60:g} min",)

    def passed_at_rest(self, rest_C: float) -> Rule | None:
        """The rule that skin at its rest in °C is outside of already, a hard one first; otherwise None."""
        skin_rules = [rule for rule in self.rules if rule.quantity == "skin surface" and not rule.relative]
        passed = [rule for rule in skin_rules if (rest_C > rule.limit if rule.upper else rest_C < rule.limit)]
        return min(passed, key=lambda rule: rule.severity != "hard", default=None)

    def to_dict(self) -> dict[str, object]:
        """Changed and loosened limits with their reason, as a sidecar holds them."""
        return {"changed": list(self.changed), "loosened": list(self.loosened), "reason": self.reason or None}


def limit_table() -> RecordTable:
    """The shipped limits, each with its source."""
    return shipped_records("limits.toml", *_EXTRA)


def safety_keys() -> tuple[str, ...]:
    """Keys of a rig file's [safety] table that change a limit, in the order of the table of limits."""
    return tuple(dict.fromkeys(rule.key for rule in Limits.shipped().rules if rule.key))


def faults_of(changes: Mapping[str, float], reason: str = "") -> list[str]:
    """Return one sentence for each fault in changed limits; keys are those of [safety]."""
    if not changes:
        return []
    changes = dict(changes)
    shipped = Limits.shipped().session_s / 60.0
    minutes = changes.pop(SESSION_KEY, shipped)
    faults = []
    if not 1.0 <= minutes <= LONGEST_SESSION_MIN:
        faults.append(f"safety.{SESSION_KEY} = {minutes:g} min: must be 1 to {LONGEST_SESSION_MIN:g} min")
    elif minutes < shipped and not is_reason(reason):  # a shorter session sums fewer plays
        faults.append(sentence("faults.session", key=SESSION_KEY, minutes=minutes, shipped=shipped))
    unknown = [key for key in changes if key not in safety_keys()]
    faults += [f"safety.{key}: no such limit; there is {', '.join(safety_keys())}" for key in unknown]
    reported = {key for key in changes if key in unknown}
    rules = _changed(changes, reason).rules
    for rule in rules:
        if rule.key not in changes or rule.key in reported:
            continue
        value, unit = changes[rule.key], unit_text(rule.unit)
        subject = f"safety.{rule.key} = {value:g}{unit}"
        bound = rule.shipped if rule.bound is None else rule.bound
        if rule.limit > bound if rule.upper else rule.limit < bound:
            reported.add(rule.key)
            why = "no published figure allows more" if rule.bound is None else rule.bound_source
            end = f"{abs(bound):g}{unit}"
            side = "at most" if rule.upper or bound < 0 else "at least"
            faults.append(f"{subject}: cannot be loosened beyond {end} ({why}); use {side} {end}")
        elif rule.loosened and not is_reason(reason):
            reported.add(rule.key)
            limit, least = f"{abs(rule.shipped):g}{unit}", {"letters": SHORTEST_REASON, "words": FEWEST_WORDS}
            faults.append(sentence("faults.looser", subject=subject, limit=limit, **least))
    for low, high in itertools.product(rules, rules):
        pair = not low.upper and high.upper and low.key != high.key
        same = (low.quantity, low.severity, low.relative) == (high.quantity, high.severity, high.relative)
        if pair and same and low.limit >= high.limit:
            faults.append(sentence("faults.crossed", low=low, high=high))
    return faults


def is_reason(text: str) -> bool:
    """Whether a text can be a reason: a sentence of at least 20 characters and four different words."""
    words = {word.casefold() for word in re.findall(r"[^\W\d_]{2,}", text)}
    return len(text.strip()) >= SHORTEST_REASON and len(words) >= FEWEST_WORDS


def _in_words(rules: Iterable[Rule]) -> tuple[str, ...]:
    texts = {}
    for rule in rules:
        unit = unit_text(rule.unit)
        texts[rule.key] = f"{rule.key} {abs(rule.limit):g}{unit} instead of {abs(rule.shipped):g}{unit}"
    return tuple(texts.values())


def _changed(changes: Mapping[str, float], reason: str) -> Limits:
    rules = []
    for rule in Limits.shipped().rules:
        if rule.key in changes:
            value = changes[rule.key]
            if rule.relative or rule.unit == "K/s":  # one figure for both directions
                value = abs(value) * (1.0 if rule.upper else -1.0)
            if value != rule.limit:
                source = f"the rig's [safety]; shipped {rule.shipped:g}, {rule.source}"
                rule = replace(rule, limit=float(value), source=source)
        rules.append(rule)
    return Limits(tuple(rules), reason)


def _rules(record: Record) -> list[Rule]:
    """Both sides of a record; a single figure for either direction is used twice."""
    extra = dict(record.extra)
    ends = [(True, record.high, "high"), (False, record.low, "low")]
    if record.unit in ("K", "K/s") and record.high is not None:
        ends[1] = (False, -record.high, "high")
    rules = []
    for upper, limit, end in ends:
        if limit is None:
            continue
        bound, above = extra.get(f"{end}_bound"), extra.get("above_C")
        rules.append(
            Rule(
                record.quantity, str(extra["severity"]), upper, limit, record.unit, record.source,
                str(extra.get(f"{end}_key", "")), bound if isinstance(bound, float) else None,
                str(extra.get(f"{end}_bound_source", "")), limit, above if isinstance(above, float) else None,
            )
        )  # fmt: skip
    return rules
