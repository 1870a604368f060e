"""What the hardware must prevent while an icon plays, for players: the strictest demands of the gate over a set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class MustPrevent:
    """The numbers of a player: s, °C, A and K. Cut-offs are on the measured display temperature.

    Of a loop they are its gains, kp A/K, ki A/(K·s) and kd A·s/K, and its current limits.

    The defaults are assumed where a gate states nothing: a display within the shipped soft limits; a watchdog
    and a reaction in which a display of 10 K/s moves by 5 K and 1 K; a test current that moves a plate of a few J/K by
    some tenths of a kelvin; a minute of rest and of pause, as is usual in thermal studies; a loop so slow that no
    module makes it swing; and the current of most shipped rigs.
    """

    watchdog_s: float = 0.5
    low_C: float = 10.0
    high_C: float = 43.0
    react_within_s: float = 0.1
    test_polarity: bool = True
    test_current_A: float = 0.1
    test_s: float = 1.0
    test_fall_K: float = 0.1
    rest_s: float = 60.0
    pause_s: float = 60.0
    gains: tuple[float, float, float] = (0.1, 0.02, 0.0)
    limits_A: tuple[float, float] = (-1.5, 1.5)


def must_prevent(verdicts: Sequence[Mapping[str, Any]]) -> MustPrevent:
    """Return the strictest of the demands that verdicts state under `hardware_must_prevent`, or the defaults.

    >>> low = {"hardware_must_prevent": {"watchdog_s": 0.2, "cut_off_display_C": {"low": 20.0, "high": 41.0}}}
    >>> found = must_prevent([low, {"hardware_must_prevent": {"watchdog_s": 0.3}}])
    >>> found.watchdog_s, found.low_C, found.high_C, found.pause_s
    (0.2, 20.0, 41.0, 60.0)
    """
    stated = [each for verdict in verdicts if (each := verdict.get("hardware_must_prevent"))]
    cut_offs = [each["cut_off_display_C"] for each in stated if each.get("cut_off_display_C")]
    checks = [each["polarity_check"] for each in stated if each.get("polarity_check")]
    needed = [check for check in checks if check.get("needed")]
    limits = [each["current_limit_A"] for each in stated if each.get("current_limit_A")]  # alike in all icons of a set
    loop = next((each["loop"] for each in stated if each.get("loop")), None)
    plain = MustPrevent()
    return MustPrevent(
        watchdog_s=_least(stated, "watchdog_s", plain.watchdog_s),
        low_C=_most(cut_offs, "low", plain.low_C),
        high_C=_least(cut_offs, "high", plain.high_C),
        react_within_s=_least(cut_offs, "react_within_s", plain.react_within_s),
        test_polarity=bool(needed) if checks else plain.test_polarity,
        test_current_A=_least(needed, "test_current_A", plain.test_current_A),
        test_s=_least(needed, "test_s", plain.test_s),
        test_fall_K=_least(needed, "display_change_at_least_K", plain.test_fall_K),
        rest_s=_rest_s(stated, plain.rest_s),
        pause_s=_most(stated, "pause_at_least_s", plain.pause_s),
        gains=(loop["kp_A_per_K"][1], loop["ki_A_per_Ks"][1], loop["kd_As_per_K"]) if loop else plain.gains,
        limits_A=limits[0] if limits else plain.limits_A,
    )


LONGEST_REST_S = 1800.0
"""Held before the first play where the gate finds that 10 min of rest do not suffice."""


def _rest_s(tables: Sequence[Mapping[str, Any]], otherwise: float) -> float:
    """The longest rest; a stated null means that 10 min of rest do not suffice."""
    key = "rest_before_first_play_s"
    stated = [table[key] for table in tables if key in table]
    return max((LONGEST_REST_S if value is None else float(value) for value in stated), default=otherwise)


def _values(tables: Sequence[Mapping[str, Any]], key: str) -> list[float]:
    return [float(table[key]) for table in tables if table.get(key) is not None]


def _least(tables: Sequence[Mapping[str, Any]], key: str, otherwise: float) -> float:
    return min(_values(tables, key), default=otherwise)


def _most(tables: Sequence[Mapping[str, Any]], key: str, otherwise: float) -> float:
    return max(_values(tables, key), default=otherwise)
