"""Breaks of a session: a block after one lies between the run without breaks and the block from rest."""

from typing import cast

import numpy as np
import pytest

from tests.circuit.surerig import sure_rig
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Drive, Export, Rig, SessionPlan, simulate_current
from thermicon.circuit.safety.sessionplay import SessionDrive, drive_of, worst_case_of
from thermicon.icons import load_library
from thermicon.notebooks.study.judging import JudgedStudy, StudyRefused, _extreme, _farthest, judge_sessions
from thermicon.notebooks.study.schedule import Schedule, Trial
from thermicon.notebooks.study.timing import Gap

GAP_S = 10.0
COLD, WARM = ("cooling-step", "linear-cooling") * 2, ("warming-step", "linear-warming") * 2


def course(label: str, *blocks: tuple[str, ...]) -> Schedule:
    rows: list[Trial] = []
    for number, block in enumerate(blocks, 1):
        rows += [Trial(number, len(rows) + k, icon) for k, icon in enumerate(block, 1)]
    return Schedule(label, tuple(rows))


def drive(order: tuple[str, ...], rig: Rig) -> SessionDrive:
    return drive_of(SessionPlan(order, GAP_S), {icon.name: icon for icon in load_library("six-icons")}, rig)


def second_block(break_s: float, rig: Rig, orders: tuple[tuple[str, ...], ...] = (COLD, WARM)) -> Array:
    """Skin in °C of the second block after the first one and a break, in which the resting current flows."""
    first, second = (drive(order, rig) for order in orders)
    begins = float(first.drive.time_s[-1]) + break_s
    times = np.concatenate([first.drive.time_s, begins + second.drive.time_s])
    # The last row of a drive holds nothing; in the break the resting current does.
    currents = np.concatenate([first.drive.current_A[:-1], [first.rest_A], second.drive.current_A])
    trace = simulate_current(Drive(times, currents, held=True), rig, rate_Hz=100.0, start_C=first.start_C)
    return np.asarray(trace.skin_C[round(100 * begins) :])


def from_rest(rig: Rig, order: tuple[str, ...] = WARM) -> Array:
    """Skin in °C of a block by itself."""
    played = drive(order, rig)
    return np.asarray(simulate_current(played.drive, rig, rate_Hz=100.0, start_C=played.start_C).skin_C)


def test_a_block_after_a_break_lies_between_the_whole_run_and_the_block_from_rest() -> None:
    rig = Rig.load("thenar")
    run, rest = second_block(GAP_S, rig), from_rest(rig)
    assert rest.max() - run.max() > 0.5  # the run without breaks alone would miss this
    low, high = np.minimum(run, rest), np.maximum(run, rest)
    slow, fast = (f(100.0 * np.diff(run), 100.0 * np.diff(rest)) for f in (np.minimum, np.maximum))
    for break_s in (20.0, 60.0, 300.0, 1200.0):
        skin = second_block(break_s, rig)
        assert (low - 0.02 < skin).all() and (skin < high + 0.02).all(), break_s
        rate = 100.0 * np.diff(skin)
        assert (slow - 0.02 < rate).all() and (rate < fast + 0.02).all(), break_s
        share = (skin[0] - run[0]) / (rest[0] - run[0])  # a state between gives a course that is as far between
        assert np.abs(skin - (1.0 - share) * run - share * rest).max() < 0.1, break_s


def test_blocks_from_rest_are_one_run_for_one_block_and_add_up_for_more() -> None:
    rig = sure_rig()
    cold, warm = drive(COLD, rig), drive(WARM, rig)
    alone = worst_case_of([warm], rig, rig.limits)
    both = worst_case_of([cold, warm, warm], rig, rig.limits)
    once, twice = (
        next(check.value for check in worst.checks if check.quantity == "Henriques integral") for worst in (alone, both)
    )
    assert once < twice < 2.2 * once
    highest = [
        next(c.value for c in worst.checks if (c.quantity, c.severity, c.upper) == ("skin surface", "soft", True))
        for worst in (both, worst_case_of([drive((*COLD, *WARM), rig)], rig, rig.limits))
    ]
    assert highest[0] > highest[1] + 0.2


def judged(course: Schedule, rig: Rig) -> JudgedStudy:
    judgement = judge_sessions([course], list(load_library("six-icons")), rig, False, GAP_S)
    return JudgedStudy(cast("Export", None), cast("Gap", None), *judgement)


@pytest.fixture(scope="module")
def between_C() -> float:
    """A temperature that the cold block goes below from rest, and not after the warm block without a break."""
    rig = sure_rig()
    run, rest = second_block(GAP_S, rig, (WARM, COLD)).min(), from_rest(rig, COLD).min()
    assert rest < run - 0.3
    return float(0.5 * (run + rest))


def test_what_only_a_block_from_rest_exceeds_is_a_caution(between_C: float) -> None:
    rig = sure_rig().with_(**{"safety.skin_lowest_soft_C": between_C})
    session = judged(course("A", WARM, COLD), rig)
    assert (session.sessions["A"].verdict, session.after_breaks["A"].colour) == ("green", "amber")
    (caution,) = session.cautions
    assert caution.startswith("blocks of participant A, each from rest: skin surface reaches ")
    assert judged(course("A", (*WARM, *COLD)), rig).after_breaks == {}
    known = judged(course("A", COLD, WARM), rig).cautions
    assert [text.partition(":")[0] for text in known] == ["session of participant A"]  # not said twice


def test_a_block_from_rest_that_is_not_safe_refuses_the_study(between_C: float) -> None:
    rig = sure_rig().with_(**{"safety.skin_lowest_C": between_C, "safety.skin_lowest_soft_C": between_C})
    with pytest.raises(StudyRefused, match="blocks of participant A, each from rest: NOT SAFE: skin surface reaches"):
        judged(course("A", WARM, COLD), rig)
    with pytest.raises(StudyRefused, match=r"^session of participant A: NOT SAFE: skin surface reaches [^\n]*$"):
        judged(course("A", COLD, WARM), rig)


def test_a_run_counts_with_its_blocks_and_the_outermost_of_many_are_judged() -> None:
    blocks = [(29.0, 33.0, 0.75, 0.0), (31.0, 35.0, 0.5, 0.0)]
    assert _farthest((30.0, 34.0, 1.0, 0.2), blocks) == (29.0, 35.0, 1.25, 0.2)
    runs = {str(k): (30.0 - k, 33.0 + k, 0.0, 0.1 * k) for k in range(9)}
    assert _extreme(runs) == {"0", "8"}
    assert _extreme(dict(list(runs.items())[:4])) == set("0123")
    assert _extreme(dict(list(runs.items())[:5])) == {"0", "4"}


def test_the_participants_judged_in_all_corners_are_chosen_by_blocks_from_rest_too() -> None:
    mild, rig = ("double-dip", "warming-step"), sure_rig()
    courses = [course(str(k), mild, mild) for k in range(5)]
    courses[3] = course("3", (*COLD, *COLD, "linear-warming", "warming-step"))
    courses[4] = course("4", (*COLD, *COLD), ("linear-warming", "warming-step"))
    sessions, drift_K, after_breaks = judge_sessions(courses, list(load_library("six-icons")), rig, False, GAP_S)
    assert drift_K["3"] == drift_K["4"]  # the runs without breaks are the same, and the first of equals is taken
    assert {"3", "4"} <= set(sessions)
    assert set(after_breaks) == set(sessions) - {"3"}
