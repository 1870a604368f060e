import pytest

from thermicon.circuit import Rig
from thermicon.icons import parse
from thermicon.perception import Goal
from thermicon.perception.ranking import reach
from thermicon.perception.ranking.goal_result import GoalPartResult, GoalResult

TEXT = (
    "cue 1; icon dip(depth in 1..3 step 1 K) { cool by depth at 2 K/s; return at 2 K/s };"
    "icon glow(k in 1..3 step 1 K) { warm by k at 2 K/s; return at 2 K/s }"
)


@pytest.mark.slow
def test_changes_are_tried_and_the_most_helpful_comes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reach, "EVALUATIONS", 10)
    monkeypatch.setattr(reach, "PEOPLE", 4)
    monkeypatch.setattr(reach, "DRAWS", 4)
    monkeypatch.setattr(reach, "FACTORS", reach.FACTORS[:2])
    steps: list[tuple[int, int]] = []
    goal = Goal.parse("correct >= 99.9 %, time <= 3 s")
    trials = reach.what_would_help(
        parse(TEXT), Rig.load("thenar"), goal, step=lambda done, total: steps.append((done, total))
    )
    assert steps[-1] == (3, 3)
    assert {trial.change for trial in trials} <= {"contact.area_cm2=18", "driver.current_limit_A=2.25", "time <= 4.5 s"}
    assert len(trials) >= 2
    gains = [(not trial.met, -trial.gain) for trial in trials]
    assert gains == sorted(gains)


def test_a_thermode_has_no_driver_to_change() -> None:
    assert {change.split("=")[0] for change, *_ in reach._rigs(Rig.load("tcs2"))} <= {
        "contact.area_cm2",
        "contact.resistance_m2K_per_W",
    }


def test_shortfall_is_that_of_the_part_that_misses_most() -> None:
    goal = Goal.parse("correct >= 80 %, time <= 10 s, onset <= 1 s")
    values = (0.6, 11.0, 0.5)
    parts = tuple(
        GoalPartResult(part, value, met, "")
        for part, value, met in zip(goal.parts, values, (False, False, True), strict=True)
    )
    assert reach.shortfall(GoalResult(goal, parts)) == pytest.approx(0.25)
    assert reach.shortfall(GoalResult(goal, parts[2:])) == 0.0
