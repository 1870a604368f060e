"""A tally of rules over stretches of rows."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from thermicon.circuit import Limits
from thermicon.circuit.safety.checks import Check, Scenario, worst_of
from thermicon.circuit.safety.exposure import cem43_min, henriques
from thermicon.circuit.safety.tally import HOTTEST_C, WATCHED, Tally, worst_of_lanes

LIMITS = Limits.shipped()
TIME = np.linspace(0.0, 20.0, 2001)


def runs() -> np.ndarray:
    """Four columns of two lanes: one warms and cools, the other stays."""
    warm = 32.0 + 11.0 * np.sin(TIME / 20.0 * np.pi) ** 2
    return np.stack([np.stack([warm + k, np.full_like(TIME, 32.0)]) for k in range(len(WATCHED))])


def check_of(tally: Tally, quantity: str, *, upper: bool = True, severity: str = "hard") -> Check:
    return next(
        check
        for check in tally.checks()
        if (check.quantity, check.upper, check.severity) == (quantity, upper, severity) and not check.note
    )


@pytest.mark.parametrize("cuts", [(1000,), (1, 700, 1999)])
def test_stretches_come_to_the_same_as_the_whole(cuts: tuple[int, ...]) -> None:
    values, whole, pieces = runs(), Tally(LIMITS, ["a", "b"]), Tally(LIMITS, ["a", "b"])
    whole.add(TIME, values)
    edges = [0, *cuts, len(TIME) - 1]
    for first, last in pairwise(edges):
        pieces.add(TIME[first : last + 1], values[:, :, first : last + 1])
    for one, other in zip(whole.checks(), pieces.checks(), strict=True):
        assert (one.quantity, one.scenario, one.since_s) == (other.quantity, other.scenario, other.since_s)
        assert (one.value, one.time_s) == (pytest.approx(other.value, rel=1e-12), other.time_s)
    assert not whole.passes()
    assert whole.worst_lanes() == (0,), "the other lane is worst by rules that it keeps"


def test_what_adds_up_counts_once_for_every_play() -> None:
    once, often = Tally(LIMITS, ["a", "b"]), Tally(LIMITS, ["a", "b"], plays=7)
    for tally in (once, often):
        tally.add(TIME, runs())
    for quantity in ("thermal dose", "Henriques integral", "time of the display above 43 °C"):
        single, seven = check_of(once, quantity), check_of(often, quantity)
        assert single.value > 0.0
        assert seven.value == pytest.approx(7 * single.value)
    assert check_of(often, "skin surface").value == check_of(once, "skin surface").value


def test_a_sum_is_reached_at_the_row_after_the_last_warm_one() -> None:
    for last in range(4):
        values, tally = np.full((4, 1, 5), 30.0), Tally(LIMITS, ["a"])
        values[..., last] = 46.0
        tally.add(np.arange(5.0), values)
        assert check_of(tally, "thermal dose").time_s == last + 1.0


def test_rates_and_sums_can_be_left_out() -> None:
    tally = Tally(LIMITS, ["a", "b"])
    tally.add(TIME, runs(), rates=False, sums=False)
    assert check_of(tally, "rate of skin temperature").value == 0.0
    assert check_of(tally, "thermal dose").value == 0.0
    assert check_of(tally, "skin surface").value == pytest.approx(43.0)


def test_a_limit_of_a_quantity_without_a_code_is_refused_and_not_judged_as_skin_temperature() -> None:
    for quantity in ("display rate", "Skin surface"):
        with pytest.raises(ValueError, match=f"{quantity}: a limit that nothing computes"):
            Tally(replace(LIMITS, rules=(*LIMITS.rules, replace(LIMITS.rules[0], quantity=quantity))), ["a"])


def test_a_drift_is_held_against_hard_limits_only() -> None:
    values = np.full((4, 1, 2), 41.0)
    tally = Tally(LIMITS, ["a"], begun_C=np.array([32.0]))
    tally.add(np.array([0.0, 1.0]), values, rates=False, sums=False, drift=True)
    assert all(check.passed for check in tally.checks()), "41 °C is above 40 °C, and 9 K from where it began"
    tally.add(np.array([2.0, 3.0]), values, rates=False, sums=False)
    assert tally.passes() and not all(check.passed for check in tally.checks())
    tally.add(np.array([4.0, 5.0]), values + 1.5, rates=False, sums=False, drift=True)
    assert check_of(tally, "skin surface").since_s == 4.0


def test_a_fork_goes_on_by_itself_under_another_name() -> None:
    tally = Tally(LIMITS, ["a"])
    tally.add(np.array([0.0, 1.0]), np.full((4, 1, 2), 33.0))
    fork = tally.fork("zero current")
    before = check_of(fork, "skin surface")
    assert (before.value, before.scenario) == (33.0, "a, then zero current"), "it has the state so far"
    fork.add(np.array([2.0, 3.0]), np.full((4, 1, 2), 44.0))
    assert tally.passes()
    assert not fork.passes()


def test_changes_count_from_where_it_began() -> None:
    tally = Tally(LIMITS, ["a"], begun_C=np.array([25.0]))
    tally.add(np.array([0.0, 1.0]), np.full((4, 1, 2), 34.0), rates=False)
    relative = [check for check in tally.checks() if check.note and check.upper]
    assert [check.limit for check in relative] == [33.0]
    assert not relative[0].passed


def test_of_equals_the_first_is_named_and_rounding_is_no_difference() -> None:
    def one(value: float, scenario: str) -> Check:
        return Check("skin surface", "hard", value, 42.0, "°C", 0.0, None, "source", run=Scenario(scenario))

    assert worst_of([[one(41.0, "once")], [one(41.0 + 1e-9, "again")]])[0].scenario == "once"
    assert worst_of([[one(41.0, "once")], [one(41.01, "again")]])[0].scenario == "again"


def test_the_worst_of_lanes_is_the_worst_of_each_lane_by_itself() -> None:
    rng = np.random.default_rng(5)
    names = ["a", "b", "c", "d"]
    courses = 32.0 + np.cumsum(rng.normal(0.0, 0.2, (2, len(WATCHED), len(names), len(TIME))), axis=-1)
    courses[:, :, 2] = courses[:, :, 1]  # of equals the first is named

    def tallies(lanes: list[int]) -> list[Tally]:
        both = []
        for way, values in zip(("once", "again"), courses, strict=True):
            tally = Tally(LIMITS, [names[lane] for lane in lanes], Scenario(way=way))
            tally.add(TIME, values[:, lanes], rates=way == "once")
            both.append(tally)
        return both

    each = [worst_of(tally.checks() for tally in tallies([lane])) for lane in range(len(names))]
    found = worst_of_lanes(tallies([0, 1, 2, 3]))
    assert found == worst_of(each)
    assert {check.run.corner for check in found} <= {"a", "b", "d"}


def test_a_run_that_diverges_fails_as_the_hottest() -> None:
    values = np.full((4, 1, 3), 32.0)
    values[:, 0, 1:] = np.nan, np.inf
    tally = Tally(LIMITS, ["a"])
    tally.add(np.array([0.0, 1.0, 2.0]), values)
    assert not tally.passes()
    broken = {check.quantity for check in tally.checks() if not check.passed}
    assert {"skin surface", "display", "cold-receptor depth", "hot plate", "thermal dose"} <= broken
    assert check_of(tally, "skin surface").value == HOTTEST_C
    assert check_of(tally, "skin surface").since_s == 1.0
    assert check_of(tally, "Henriques integral").value > 1.0


A, EA, GAS = 3.1e98, 6.28e5, 8.31446261815324


def burn_rate(celsius: float) -> float:
    return math.exp(math.log(A) - EA / (GAS * (celsius + 273.15)))


@pytest.mark.parametrize(
    ("celsius", "minutes"), [(36.999, 0.0), (37, 0.25**6), (40, 1 / 64), (42, 0.25), (43, 1.0), (44, 2.0), (46, 8.0)]
)
def test_a_minute_of_constant_temperature(celsius: float, minutes: float) -> None:
    assert cem43_min([0.0, 20.0, 60.0], [celsius] * 3)[-1] == pytest.approx(minutes, rel=1e-12)


@pytest.mark.parametrize(("low", "high"), [(30, 36), (36, 38), (38, 42), (42, 44), (43, 47), (30, 47), (47, 35)])
def test_a_ramp_of_two_rows_has_the_exact_dose(low: float, high: float) -> None:
    def rate(celsius: float) -> float:
        return 0.0 if celsius < 37 else (0.5 if celsius >= 43 else 0.25) ** (43 - celsius)

    ends = sorted((low, high))
    kinks = [kink for kink in (37.0, 43.0) if ends[0] < kink < ends[1]]
    mean = quad(rate, ends[0], ends[1], points=kinks or None, epsabs=1e-14)[0] / (ends[1] - ends[0])
    assert cem43_min([0.0, 90.0], [low, high])[-1] == pytest.approx(1.5 * mean, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("celsius", [20.0, 32.0, 43.0, 44.0, 50.0, 70.0])
def test_the_burn_integral_of_a_constant_temperature(celsius: float) -> None:
    assert henriques([0.0, 5.0, 600.0], [celsius] * 3)[-1] == pytest.approx(600 * burn_rate(celsius), rel=1e-12)


@pytest.mark.parametrize(("low", "high"), [(32, 32.01), (32, 32.04), (40, 40.06), (40, 42), (30, 55), (55, 30)])
def test_the_burn_integral_of_a_ramp_of_two_rows(low: float, high: float) -> None:
    known = quad(lambda share: burn_rate(low + share * (high - low)), 0, 1, epsrel=1e-12)[0]
    assert henriques([0.0, 3.0], [low, high])[-1] == pytest.approx(3 * known, rel=1e-8)


def test_both_take_many_traces_and_count_up_from_0() -> None:
    time = np.array([0.0, 1.0, 3.0])
    warm = np.array([[[30.0, 40.0, 44.0], [44.0, 44.0, 44.0]]])
    for measure in (cem43_min, henriques):
        found = measure(time, warm)
        assert found.shape == (1, 2, 3)
        assert (found[..., 0] == 0).all()
        assert (np.diff(found, axis=-1) >= 0).all()
        assert found[0, 0] == pytest.approx(measure(time, warm[0, 0]), rel=1e-14)
