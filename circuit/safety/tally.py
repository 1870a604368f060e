"""A running check of simulations against every rule of safety."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from math import isnan

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rules import Limits, Rule
from .checks import AS_TOLD, LEVEL, Check, Scenario
from .corners import Corner
from .exposure import constants
from .quantities import CODE_OF, RATE, WARMER

WATCHED = ("skin_C", "display_C", "cold_receptor_C", "hot_plate_C")
"""Columns of a run that limits are about."""

COLDEST_C, HOTTEST_C = -273.0, 1000.0
"""A run that diverges counts as this hot, so that it fails every limit instead of being lost as NaN."""

SPAN_C = np.array([COLDEST_C, HOTTEST_C])


class Tally:
    """Runs of some lanes, each a corner or a name, against every rule, added stretch by stretch.

    `run` is the scenario of every lane but for its corner, `plays` the number by which sums over time are multiplied,
    `begun_C` the skin (lanes,) from which changes count; None: that of the first row.
    """

    def __init__(
        self,
        limits: Limits,
        lanes: Sequence[Corner | str],
        run: Scenario = AS_TOLD,
        *,
        plays: int = 1,
        begun_C: Array | None = None,
    ) -> None:
        self.limits, self.lanes, self.run, self.plays, self._begun = limits, lanes, run, plays, begun_C
        # As the kernel expects them: codes of quantities (q,), and what each rule is about (rules,).
        rules, first = limits.rules, {rule.quantity: rule for rule in reversed(limits.rules)}
        self._code = np.array([_code_of(rule) for rule in first.values()], dtype=np.int64)
        self._above_C = np.array([rule.above_C or 0.0 for rule in first.values()])
        self._rule_of = np.array([list(first).index(rule.quantity) for rule in rules], dtype=np.int64)
        self._limit = np.array([float(rule.limit) for rule in rules])
        self._relative = np.array([rule.relative for rule in rules], dtype=np.bool_)
        self._upper = np.array([rule.upper for rule in rules], dtype=np.bool_)
        self._hard = np.array([rule.severity == "hard" for rule in rules], dtype=np.bool_)
        shape = len(rules), len(lanes)
        self._sums = np.zeros((len(first), len(lanes)))
        self._present = np.zeros(len(limits.rules), dtype=np.bool_)
        self._value, self._at_s, self._since_s = np.zeros(shape), np.zeros(shape), np.full(shape, np.nan)

    def add(self, time_s: Array, watched: Array, *, rates: bool = True, sums: bool = True, drift: bool = False) -> None:
        """Add WATCHED (4, lanes, rows) in °C at times in s (rows,), which continue those before.

        Without `rates` or `sums`, rows are too far apart for them; in a `drift`, no stimulus, only hard limits apply.
        """
        from .tally_kernel import count

        if self._begun is None:
            begun = np.nan_to_num(watched[0, :, 0], nan=HOTTEST_C, posinf=HOTTEST_C, neginf=COLDEST_C)
            self._begun = np.clip(begun, COLDEST_C, HOTTEST_C)
        times = np.require(time_s, requirements="W")  # numba compiles everything again for times that are read-only
        count(
            times, np.ascontiguousarray(watched), self._code, self._above_C, constants(), SPAN_C, LEVEL,
            float(self.plays), self._rule_of, self._limit, self._relative, self._upper, self._hard, rates, sums, drift,
            self._begun, self._sums, self._present, self._value, self._at_s, self._since_s,
        )  # fmt: skip

    def fork(self, ending: str) -> Tally:
        """A copy of the state so far, which goes on in an ending."""
        other = copy(self)
        other.run = replace(self.run, ending=ending)
        for name in ("_sums", "_present", "_value", "_at_s", "_since_s"):
            setattr(other, name, getattr(self, name).copy())
        return other

    def checks(self, lanes: Index | None = None) -> tuple[Check, ...]:
        """Every rule once, in its worst lane, or in the lane given for each rule (rules,)."""
        lanes = self._worst() if lanes is None else lanes
        every = np.arange(len(lanes))
        value, at_s = self._value[every, lanes].tolist(), self._at_s[every, lanes].tolist()
        since_s, limit = self._since_s[every, lanes].tolist(), self._limits()[every, lanes].tolist()
        rows = zip(self.limits.rules, lanes.tolist(), value, at_s, since_s, limit, strict=True)
        return tuple(
            self._check(*row) if present else self._nothing(row[0])
            for row, present in zip(rows, self._present.tolist(), strict=True)
        )

    def summed(self, quantity: str) -> Array:
        """Sum of a quantity over time in each lane (lanes,)."""
        place = next(k for k, rule in enumerate(self.limits.rules) if rule.quantity == quantity)
        return np.asarray(self._sums[self._rule_of[place]])

    def worst_lanes(self) -> tuple[int, ...]:
        """Lanes that are worst by some hard rule that is exceeded, each once."""
        exceeded = ~np.isnan(self._since_s).all(axis=1)
        return tuple(dict.fromkeys(self._worst()[self._hard & exceeded].tolist()))

    def beyond(self) -> Array:
        """Excess over each rule in each lane (rules, lanes), as `checks.beyond` of its check."""
        nothing = np.array([check.value for check in map(self._nothing, self.limits.rules)])
        limit = np.where(self._present[:, np.newaxis], self._limits(), self._limit[:, np.newaxis])
        value = np.where(self._present[:, np.newaxis], self._value, nothing[:, np.newaxis])
        return np.where(self._upper[:, np.newaxis], value - limit, limit - value)

    def passes(self) -> bool:
        """Whether no lane exceeds a hard limit."""
        return bool(np.isnan(self._since_s[self._hard]).all())

    def _limits(self) -> Array:
        limit, begun = self._limit[:, np.newaxis], 0.0 if self._begun is None else self._begun
        return np.where(self._relative[:, np.newaxis], begun + limit, limit + np.zeros(len(self.lanes)))

    def _worst(self) -> Index:
        """The lane that is worst by each rule (rules,), the first of equals."""
        side = np.where(self._upper, 1.0, -1.0)[:, np.newaxis]
        return np.asarray(np.argmax(side * (self._value - self._limits()), axis=1))

    def _check(self, rule: Rule, lane: int, value: float, at_s: float, since_s: float, limit: float) -> Check:
        unit = "°C" if rule.relative else rule.unit
        since = None if isnan(since_s) else since_s
        change = abs(rule.limit) if rule.relative else None
        run = self._run(lane)
        return Check(
            rule.quantity, rule.severity, value, limit, unit, at_s, since, rule.source, change, rule.upper, run
        )

    def _nothing(self, rule: Rule) -> Check:
        """The check of a rule of which nothing that it limits was added."""
        value = 0.0 if rule.upper or _code_of(rule) == RATE else HOTTEST_C
        limit, unit, run = rule.limit, rule.unit, self._run(0)
        return Check(rule.quantity, rule.severity, value, limit, unit, 0.0, None, rule.source, None, rule.upper, run)

    def _run(self, lane: int) -> Scenario:
        corner = self.lanes[lane]
        return replace(self.run, corner=corner if isinstance(corner, str) else corner.deviations)


def worst_of_lanes(tallies: Sequence[Tally]) -> tuple[Check, ...]:
    """Every rule in its worst tally and lane: `checks.worst_of` in each lane, and then of all lanes."""
    every = np.array([tally.beyond() for tally in tallies])
    which = np.argmax(every >= every.max(axis=0) - LEVEL, axis=0)
    in_lane = np.take_along_axis(every, which[np.newaxis], axis=0)[0]
    lanes = np.argmax(in_lane >= in_lane.max(axis=1, keepdims=True) - LEVEL, axis=1)
    checks = [tally.checks(lanes) for tally in tallies]
    return tuple(checks[which[rule, lane]][rule] for rule, lane in enumerate(lanes.tolist()))


def _code_of(rule: Rule) -> int:
    """The code of the quantity that a rule limits, as the kernel expects it; none is judged as another."""
    if rule.above_C is not None:
        return WARMER
    if rule.quantity not in CODE_OF:
        raise ValueError(f"{rule.quantity}: a limit that nothing computes; give it a code in safety/quantities.py")
    return CODE_OF[rule.quantity]
