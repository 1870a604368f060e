"""Rules about all elements of a layout together, on both sides of each limit."""

import re
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from thermicon.circuit import Element, Layout, Rig
from thermicon.circuit.rig.layoutfile import Supply
from thermicon.circuit.safety.whole import Load, Whole, judge_whole

RIG, ROWS = Rig.load("thenar"), 400
IDLE = Load(False, np.zeros(ROWS), np.zeros(ROWS), np.full(ROWS, -inf), np.full(ROWS, -inf), cut_C=(30.0, 34.0))
FROM = np.arange(ROWS)


def layout(surfaces: str = "one", apart_m: float = 0.03, supply: Supply | None = None, area_cm2: float = 9) -> Layout:
    rig = RIG.with_(**{"contact.area_cm2": area_cm2})
    places = (("a", 0.0), ("b", apart_m))
    elements = tuple(Element(rig, name, (at, 0.0)) for name, at in places)
    return Layout(elements, "two", surfaces=surfaces, supply=supply)  # type: ignore[arg-type]


def pulse(begin: int, end: int, high: float, low: float = 0.0) -> np.ndarray:
    return np.where((begin <= FROM) & (end > FROM), high, low)


def drawing(begin: int, end: int, amperes: float, watts: float = 0.0) -> Load:
    return replace(IDLE, plays=True, current_A=pulse(begin, end, amperes), power_W=pulse(begin, end, watts))


def warm(begin: int, end: int, level_C: float) -> Load:
    return replace(IDLE, plays=True, warm_C=pulse(begin, end, level_C, -inf))


def cold(begin: int, end: int, level_C: float) -> Load:
    return replace(IDLE, plays=True, chill_C=pulse(begin, end, -level_C, -inf))


def found(whole: Whole, severity: str = "hard") -> list[str]:
    return [check.quantity for check in whole.findings if check.severity == severity]


@pytest.mark.parametrize(("share", "colour"), [(1.01, "green"), (0.99, "red")])
def test_the_largest_of_each_element_is_added_over_icons(share: float, colour: str) -> None:
    icons = [[drawing(0, 50, 1.0, 8.0), drawing(0, 50, 0.2, 1.0)], [IDLE, drawing(100, 150, 2.0, 9.0)]]
    for supply in (
        Supply(current_limit_A=3.0 * share, power_limit_W=99),
        Supply(current_limit_A=9, power_limit_W=17 * share),
    ):
        whole = judge_whole(layout(supply=supply), icons)
        assert (whole.colour == "green" and whole.offset_s is None) == (colour == "green")
    assert judge_whole(layout(), icons).colour == "green"  # what is not described is not judged


def test_one_clock_is_demanded_only_where_the_largest_are_too_much_and_bounds_the_offset() -> None:
    icons = [[drawing(0, 100, 2.0), drawing(150, 250, 2.0)]]  # half a second between them
    supplied = layout(supply=Supply(current_limit_A=3.0, power_limit_W=99))
    whole = judge_whole(supplied, icons)
    assert (whole.colour, whole.offset_s) == ("green", 0.5)
    assert judge_whole(layout(supply=Supply(current_limit_A=4.0, power_limit_W=99)), icons).offset_s is None
    late = [[drawing(0, 100, 2.0), drawing(150 - 51, 250, 2.0)]]
    assert found(judge_whole(supplied, late)) == ["current from the supply"]
    for drawn_A in (2.0, 1.51234):
        both = [[drawing(0, 100, 2.0), drawing(99, 250, drawn_A)]]
        (enough_A,) = re.findall(r"a \[supply\] of (\S+) A or more", judge_whole(supplied, both).cure)
        obeyed = layout(supply=Supply(current_limit_A=float(enough_A), power_limit_W=99))
        assert judge_whole(obeyed, both).colour == "green"
    for gap, offset_s in ((21, 0.2), (19, 0.1), (3, 0.02), (1, 0.01)):
        near = [[drawing(0, 100, 2.0), drawing(100 + gap, 250, 2.0)]]
        assert judge_whole(supplied, near).offset_s == offset_s


@pytest.mark.parametrize(
    ("warm_C", "cold_C", "hard", "soft"),
    [
        (37.0, 25.1, [], []),
        (37.0, 24.9, [], ["opposite qualities"]),
        (37.9, 18.0, [], ["opposite qualities"]),
        (38.1, 25.1, [], ["opposite qualities"]),
        (38.1, 24.9, ["warm beside cold"], ["opposite qualities"]),
        (37.9, 17.8, ["opposite qualities"], []),
    ],
)
def test_opposite_qualities_near_each_other(warm_C: float, cold_C: float, hard: list[str], soft: list[str]) -> None:
    both = [[warm(0, 100, warm_C), cold(0, 100, cold_C)]]
    for icons in (both, [icon[::-1] for icon in both]):
        whole = judge_whole(layout(), icons)
        assert (found(whole), found(whole, "soft")) == (hard, soft)
        assert judge_whole(layout(apart_m=0.101), icons).colour == "green"
        assert judge_whole(layout("apart"), icons).colour == "green"
    assert judge_whole(layout(), [[warm(0, 100, warm_C), IDLE], [IDLE, IDLE]]).colour == "green"


def test_opposite_qualities_one_after_the_other_need_one_clock() -> None:
    icons = [[warm(0, 100, 40.0), cold(150, 250, 18.0)]]
    assert judge_whole(layout(), icons).offset_s == 0.5
    assert judge_whole(layout(apart_m=0.101), icons).offset_s is None
    whole = judge_whole(layout(), [[warm(0, 100, 40.0), cold(99, 250, 18.0)]])
    assert whole.colour == "red" and "elements farther apart" in whole.cure


@pytest.mark.parametrize(("area_cm2", "soft"), [(49, []), (51, ["area at once"])])
def test_skin_touched_at_once(area_cm2: float, soft: list[str]) -> None:
    plays = drawing(0, 100, 1.0)
    assert found(judge_whole(layout(area_cm2=area_cm2), [[plays, plays]]), "soft") == soft
    assert judge_whole(layout(area_cm2=area_cm2), [[plays, IDLE], [IDLE, plays]]).colour == "green"


@pytest.mark.parametrize(("stuck_A", "colour"), [(1.9, "green"), (2.1, "amber")])
def test_a_stuck_driver_is_added_to_what_the_others_draw_and_told(stuck_A: float, colour: str) -> None:
    icons = [[replace(drawing(0, 100, 1.0), stuck=(stuck_A, 0.0)), drawing(0, 100, 1.0)], [IDLE, IDLE]]
    for order in (icons, icons[::-1]):
        whole = judge_whole(layout(supply=Supply(current_limit_A=3.0, power_limit_W=99)), order)
        assert whole.colour == colour
    assert all("a stuck at the limit of its driver" in text for text in whole.cautions)


@pytest.mark.parametrize(("cut_C", "colour"), [(39.9, "green"), (40.1, "amber")])
def test_a_display_stuck_warm_beside_a_cold_one_is_told(cut_C: float, colour: str) -> None:
    icons = [[replace(IDLE, cut_C=(31.0, cut_C)), cold(0, 100, 20.0)]]
    assert judge_whole(layout(), icons).colour == colour
    assert judge_whole(layout("apart"), icons).colour == "green"


def test_a_channel_that_is_late_in_one_icon_meets_the_next() -> None:
    supplied = layout(supply=Supply(current_limit_A=3.0, power_limit_W=99))
    icons = [[drawing(0, 50, 0.1), drawing(ROWS - 40, ROWS - 30, 2.0)], [drawing(0, 50, 2.0), IDLE]]
    assert judge_whole(supplied, icons).offset_s == 0.2
    assert judge_whole(supplied, icons[:1]).offset_s is None
