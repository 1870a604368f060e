import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import Goal, search
from thermicon.perception.selection import reach
from thermicon.perception.selection.goal_result import GoalPartResult, GoalResult

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
    goal, rig = Goal.parse("correct >= 99.9 %, time <= 3 s"), Rig.load("thenar")
    given = search(parse(TEXT), rig, evaluations=10, people=4, goal=goal).found
    advice = reach.what_would_help(parse(TEXT), rig, goal, given, step=lambda done, total: steps.append((done, total)))
    assert steps[0] == (1, 5)
    assert steps[-1] == (5, 5)
    changes = {trial.change for trial in advice.trials}
    assert changes <= {"contact.area_cm2=18", "driver.current_limit_A=2.25", "time <= 4.5 s"}
    assert len(advice.trials) >= 2
    gains = [(not trial.met, -trial.gain) for trial in advice.trials]
    assert gains == sorted(gains)
    assert {*advice.helpful, *advice.idle} == {*advice.trials}
    assert advice.again >= 0.0


@pytest.mark.slow
def test_what_changes_nothing_gains_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reach, "EVALUATIONS", 10)
    monkeypatch.setattr(reach, "PEOPLE", 4)
    monkeypatch.setattr(reach, "DRAWS", 4)
    monkeypatch.setattr(reach, "FACTORS", (reach.FACTORS[2],))
    rig = Rig.load("thenar")
    worst = IconSet("few", "", parse(TEXT).context, parse(TEXT).metadata, tuple(parse(TEXT))[:2])
    advice = reach.what_would_help(parse(TEXT), rig, Goal.parse("correct >= 99.9 %"), worst)
    # The voltage is no limit here, so that all that is gained is that of a second search.
    assert advice.trials[0].gain == pytest.approx(0.0, abs=1e-9)
    assert advice.again > 0.04
    assert advice.helpful == ()


def test_changes_are_those_of_the_rig_and_of_totals(rig: Rig) -> None:
    goal = Goal.parse("time <= 3 s, energy <= 2 J, count 2")
    changes = dict(change.split("=") for change, *_ in reach._rigs(rig, goal))
    keys = ("driver.current_limit_A", "driver.voltage_limit_V", "heat_sink.resistance_K_per_W")
    own = (rig.driver.current_max_A, rig.driver.voltage_limit_V, rig.heat_sink.resistance_K_per_W)
    assert [float(changes[key]) for key in keys] == pytest.approx(np.multiply(own, (1.5, 1.5, 0.5)), rel=1e-5)
    assert float(changes["contact.area_cm2"]) == pytest.approx(2e4 * rig.contact.area_m2)
    assert [change for change, *_ in reach._relaxed(rig, goal)] == ["time <= 4.5 s", "energy <= 3 J"]
    thermode = {change.split("=")[0] for change, *_ in reach._rigs(Rig.load("tcs2"), goal)}
    assert thermode == {"contact.area_cm2", "contact.resistance_m2K_per_W"}


def test_a_change_helps_from_one_percent_on() -> None:
    result = GoalResult(Goal.parse("count 2"), ())
    little, more = (reach.Trial("key", "words", met=False, gain=gain, result=result) for gain in (0.0099, 0.0101))
    advice = reach.Advice(result, 0.0, (more, little))
    assert (advice.helpful, advice.idle) == ((more,), (little,))


def test_shortfall_is_that_of_the_part_that_misses_most() -> None:
    goal = Goal.parse("correct >= 80 %, time <= 10 s, onset <= 1 s")
    values = (0.6, 11.0, 0.5)
    parts = tuple(
        GoalPartResult(part, value, met, "")
        for part, value, met in zip(goal.parts, values, (False, False, True), strict=True)
    )
    assert reach.shortfall(GoalResult(goal, parts)) == pytest.approx(0.25)
    assert reach.shortfall(GoalResult(goal, parts[2:])) == 0.0
