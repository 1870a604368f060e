"""A running check of simulations against every rule of safety, which may arrive in stretches of time."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits, Rule
from .checks import LEVEL, Check
from .exposure import cem43_min, henriques

WATCHED = ("skin_C", "display_C", "cold_receptor_C", "hot_plate_C")
"""Columns of a run that limits are about."""

COLDEST_C, HOTTEST_C = -273.0, 1000.0
"""A run that diverges counts as this hot, so that it fails every limit instead of being lost as NaN."""

_COLUMN_OF = {"display": "display_C", "hot plate": "hot_plate_C", "cold-receptor depth": "cold_receptor_C"}
"""Places of temperature limits other than the skin surface."""

RATE = "rate of skin temperature"
SUMMED = ("thermal dose", "Henriques integral")
"""Quantities that add up over time, as the time of the display above a limit does."""


@dataclass(slots=True)
class _Extreme:
    """Extreme of a rule's quantity in each lane: the value, its time, and since when the limit is exceeded."""

    value: Array
    at_s: Array
    since_s: Array


class Tally:
    """Runs of some lanes against every rule, added stretch by stretch.

    Parameters
    ----------
    limits
        The rules.
    scenarios
        A few words for each lane.
    plays
        Number of plays in a session, by which sums over time are multiplied.
    begun_C
        Skin temperature (lanes,) from which changes count; None: that of the first row.

    """

    def __init__(
        self, limits: Limits, scenarios: Sequence[str], *, plays: int = 1, begun_C: Array | None = None
    ) -> None:
        self.limits, self.scenarios, self.plays = limits, tuple(scenarios), plays
        self._begun = begun_C
        self._sums: dict[str, Array] = {}
        self._extremes: dict[int, _Extreme] = {}

    def add(self, time_s: Array, watched: Array, *, rates: bool = True, sums: bool = True, drift: bool = False) -> None:
        """Add WATCHED (4, lanes, rows) in °C at times in s (rows,), which continue those before.

        Without `rates` no rate is taken over these rows, and without `sums` nothing is summed over them, since they are
        states far apart. A `drift` is not a stimulus: only hard limits apply, and changes do not count.
        """
        columns = dict(zip(WATCHED, _finite(watched), strict=True))
        if self._begun is None:
            self._begun = columns["skin_C"][:, 0].copy()
        measured: dict[str, Array | None] = {}
        for place, rule in enumerate(self.limits.rules):
            if rule.quantity not in measured:
                skip = (rule.quantity == RATE and not rates) or (_adds_up(rule) and not sums)
                measured[rule.quantity] = None if skip else self._measured(rule, time_s, columns)
            values = measured[rule.quantity]
            if values is not None and not (drift and (rule.relative or rule.severity != "hard")):
                self._count(place, rule, time_s, values)

    def fork(self, what: str) -> Tally:
        """A copy of the state so far under other names: those of the scenarios followed by `what`."""
        other = deepcopy(self)
        other.scenarios = tuple(f"{scenario}, {what}" for scenario in self.scenarios)
        return other

    def limits_of(self, rule: Rule) -> Array:
        """The limit of a rule in each lane (lanes,)."""
        assert self._begun is not None
        return self._begun + rule.limit if rule.relative else np.full(len(self._begun), rule.limit)

    def checks(self) -> tuple[Check, ...]:
        """Every rule once, in its worst lane."""
        return tuple(self._check(place, rule) for place, rule in enumerate(self.limits.rules))

    def summed(self, quantity: str) -> Array:
        """Sum of a quantity over time in each lane (lanes,)."""
        return self._sums.get(quantity, np.zeros(len(self.scenarios)))

    def worst_lanes(self, severity: str = "hard") -> tuple[int, ...]:
        """Lanes that are worst by some rule of a severity, each once."""
        rules = [(place, rule) for place, rule in enumerate(self.limits.rules) if rule.severity == severity]
        return tuple(dict.fromkeys(self._worst(place, rule) for place, rule in rules if place in self._extremes))

    def passes(self, severity: str = "hard") -> bool:
        """Whether no lane exceeds a limit of a severity."""
        return all(
            np.isnan(self._extremes[place].since_s).all()
            for place, rule in enumerate(self.limits.rules)
            if rule.severity == severity and place in self._extremes
        )

    def _measured(self, rule: Rule, time_s: Array, columns: dict[str, Array]) -> Array:
        """The quantity (lanes, rows) that a rule limits."""
        skin = columns["skin_C"]
        if rule.quantity == RATE:
            rates = np.diff(skin, axis=1) / np.diff(time_s)
            return np.concatenate([rates[:, :1], rates], axis=1)
        if not _adds_up(rule):
            return columns[_COLUMN_OF.get(rule.quantity, "skin_C")]
        if rule.above_C is not None:
            warm = columns["display_C"]
            over = 0.5 * (warm[:, 1:] + warm[:, :-1]) > rule.above_C
            grown = np.concatenate([np.zeros((len(warm), 1)), np.cumsum(over * np.diff(time_s), axis=1)], axis=1)
        else:
            grown = cem43_min(time_s, skin) if rule.quantity == SUMMED[0] else henriques(time_s, skin)
        grown = self.plays * grown + self._sums.get(rule.quantity, np.zeros(len(skin)))[:, np.newaxis]
        self._sums[rule.quantity] = grown[:, -1]
        return np.asarray(grown)

    def _count(self, place: int, rule: Rule, time_s: Array, values: Array) -> None:
        side = 1.0 if rule.upper else -1.0
        most = side * (side * values).max(axis=1)
        lanes = np.arange(len(most))
        near = side * values >= (side * most)[:, np.newaxis] - LEVEL
        at = time_s[near.argmax(axis=1)]
        limits = self.limits_of(rule)
        over = side * (values - limits[:, np.newaxis]) > 0
        since = np.where(over.any(axis=1), time_s[over.argmax(axis=1)], np.nan)
        extreme = self._extremes.get(place)
        if extreme is None:
            self._extremes[place] = _Extreme(most, at, since)
            return
        later = side * most > side * extreme.value + LEVEL
        extreme.at_s[lanes[later]] = at[later]
        extreme.value = side * np.maximum(side * extreme.value, side * most)
        extreme.since_s = np.where(np.isnan(extreme.since_s), since, extreme.since_s)

    def _worst(self, place: int, rule: Rule) -> int:
        side = 1.0 if rule.upper else -1.0
        return int(np.argmax(side * (self._extremes[place].value - self.limits_of(rule))))

    def _check(self, place: int, rule: Rule) -> Check:
        if place not in self._extremes:  # nothing that this rule limits was added
            nothing = 0.0 if rule.upper or rule.quantity == RATE else HOTTEST_C
            return Check(rule.quantity, rule.severity, nothing, rule.limit, rule.unit, 0.0, None, rule.source, "",
                         rule.upper, self.scenarios[0])  # fmt: skip
        lane, extreme = self._worst(place, rule), self._extremes[place]
        since = float(extreme.since_s[lane])
        return Check(
            rule.quantity,
            rule.severity,
            float(extreme.value[lane]),
            float(self.limits_of(rule)[lane]),
            "°C" if rule.relative else rule.unit,
            float(extreme.at_s[lane]),
            None if np.isnan(since) else since,
            rule.source,
            f", {abs(rule.limit):g} K from where it began," if rule.relative else "",
            rule.upper,
            self.scenarios[lane],
        )


def _adds_up(rule: Rule) -> bool:
    return rule.above_C is not None or rule.quantity in SUMMED


def _finite(values: Array) -> Array:
    known = np.nan_to_num(values, nan=HOTTEST_C, posinf=HOTTEST_C, neginf=COLDEST_C)
    return np.clip(known, COLDEST_C, HOTTEST_C)
