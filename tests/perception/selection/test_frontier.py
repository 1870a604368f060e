from dataclasses import replace
from typing import Any

import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import choose, frontier, rank
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.ranking import batches
from thermicon.perception.selection.frontier import Frontier
from thermicon.perception.selection.goal import GoalError
from thermicon.perception.selection.goal_result import judge_goal
from thermicon.perception.selection.request import ChoiceError, Selection

THREE = (
    "cue 1; icon dip { cool by 3 K at 2 K/s }; icon sip { cool by 1 K at 2 K/s }; icon glow { warm by 2 K at 2 K/s }"
)


@pytest.fixture(scope="module")
def found(six: IconSet, rig: Rig) -> Frontier:
    return frontier(six, rig, people=12, seed=3, objective="worst", most=5, parameters=0)


def test_every_size_has_its_best_choice(found: Frontier, six: IconSet, rig: Rig) -> None:
    assert [len(point.icons) for point in found.points] == [2, 3, 4, 5]
    for key in ("proportion_correct", "d_prime"):
        values = [getattr(point.at_own_range, key) for point in found.points]
        assert values == sorted(values, reverse=True)
    assert all(point.reached <= point.at_own_range.felt_and_named <= 1.0 for point in found.points)
    chosen = choose(rank(six, rig, people=12, seed=3, parameters=0), Selection(3, "worst"), parameters=0)
    assert found.points[1] == chosen


def test_direct_naming_of_all_icons_is_that_of_rank(rig: Rig) -> None:
    icons = parse(THREE)
    whole = rank(icons, rig, people=8, parameters=0, memory="naming")
    own = choose(whole, Selection(3), parameters=0).at_own_range
    assert own.proportion_correct == pytest.approx(whole.proportion_correct, abs=1e-12)
    assert own.information_bits == pytest.approx(whole.information_bits, abs=1e-12)


def test_as_a_table_and_a_picture(found: Frontier) -> None:
    frame = found.to_frame()
    assert list(frame["icons"]) == [2, 3, 4, 5]
    assert frame["felt_and_named_95_percent_of_people_and_model"].isna().all()
    assert frame["names"][0].split() == list(found.points[0].icons)
    axes = found.plot()
    assert axes.get_ylabel() == "felt and named (%)"
    assert len(axes.lines) == 3


def test_total_time_ends_the_curve(six: IconSet, rig: Rig) -> None:
    short = frontier(six, rig, people=4, goal="time <= 17 s", parameters=0)
    assert [len(point.icons) for point in short.points] == [2]
    assert short.points[0].total_s <= 17.0
    with pytest.raises(
        ChoiceError, match=r"no 2 of the 6 icons stay within a total of 9 s \(the 2 shortest last 16 s\)"
    ):
        frontier(six, rig, people=2, goal="time <= 9 s", parameters=0)
    with pytest.raises(ChoiceError, match="a choice of 1 has no pair"):
        frontier(six, rig, most=1)


def test_what_95_percent_reach_is_the_number_of_a_goal(six: IconSet, rig: Rig) -> None:
    goal = "felt-and-named >= 85 % for 95 % of people, time <= 30 s"
    seen = frontier(six, rig, people=8, parameters=8, objective="worst", goal=goal)
    assert [len(point.icons) for point in seen.points] == [2, 3]
    assert all(point.total_s <= 30.0 for point in seen.points)
    ranking = rank(six, rig, people=8, parameters=0)
    point = seen.points[1]
    value, row = judge_goal(goal, ranking, point).parts[0].value, seen.rows()[1]
    assert value == seen.goals[1].parts[0].value == point.reached
    assert row["felt_and_named_95_percent_of_people_and_model"] == value
    assert row["meets_goal"] is seen.goals[1].met


@pytest.mark.slow
def test_a_rough_table_of_few_people_comes_first_and_is_near(
    six: IconSet, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[Frontier] = []
    asked: Any = {"people": 60, "most": 4, "parameters": 80}
    whole = frontier(six, rig, **asked, rough=told.append)
    assert not told, "people of one batch are waited for"
    monkeypatch.setattr(batches, "SAMPLES_AT_ONCE", 1)
    assert frontier(six, rig, **asked, rough=told.append).rows() == whole.rows()
    (rough,) = told
    assert (rough.rough, rough.job.people, rough.draws, whole.rough, whole.draws) == (True, 24, 64, False, 80)
    for key in ("felt_and_named", "felt_and_named_95_percent_of_people_and_model"):
        ours, theirs = ([row[key] for row in each.rows()] for each in (rough, whole))
        assert ours == pytest.approx(theirs, abs=0.05)


def test_the_pool_of_a_frontier_is_ranked_when_it_is_asked_for(found: Frontier, six: IconSet, rig: Rig) -> None:
    assert found.ranking.to_json() == rank(six, rig, people=12, seed=3, parameters=0).to_json()


def test_a_goal_leaves_icons_out_and_says_why(rig: Rig) -> None:
    icons = parse(
        "cue 1; icon faint { cool by 0.1 K at 1 K/s }; icon dip { cool by 3 K at 2 K/s };"
        "icon glow { warm by 3 K at 2 K/s }"
    )
    seen = frontier(icons, rig, people=4, parameters=0, goal="detected >= 90 %")
    ((name, why),) = seen.points[0].excluded
    assert (name, "of trials only" in why) == ("faint", True)
    with pytest.raises(ChoiceError, match=r"^2 icons cannot be chosen: none is left \(faint is "):
        frontier(icons, rig, people=4, parameters=0, goal="onset <= 0.01 s")
    with pytest.raises(GoalError, match="needs draws"):
        frontier(icons, rig, people=4, parameters=0, goal="named >= 9 % for 95 % of people")


def test_amber_icons_are_named_or_left_out(rig: Rig) -> None:
    icons = parse(
        "cue 1; icon deep { cool by 10.5 K at 3 K/s; return at 3 K/s }; icon dip { cool by 3 K at 2 K/s };"
        "icon glow { warm by 3 K at 2 K/s }"
    )
    rig = rig.with_(**{"driver.current_limit_A": 4.0})
    named = frontier(icons, rig, people=2, parameters=0)
    assert named.rows()[-1]["amber"] == "deep"
    green = frontier(icons, rig, people=2, parameters=0, goal="safety green")
    ((name, why),) = green.points[-1].excluded
    assert (name, why.startswith("is amber: ")) == ("deep", True)
    assert green.rows()[-1]["amber"] == ""


def test_a_thermode_has_no_energy_to_limit() -> None:
    with pytest.raises(ChoiceError, match=r"a thermode, which states no energy: leave out .*energy of the goal"):
        frontier(parse(THREE), Rig.load("tcs2"), people=2, parameters=0, goal="energy <= 3 J")


def test_draws_are_counted_and_refused_in_the_same_words(rig: Rig, six: IconSet) -> None:
    model = ObserverModel.load()
    posterior = model.posterior
    assert posterior is not None
    lab = replace(model, name="lab.csv", posterior=replace(posterior, draws=posterior.draws[:6]))
    seen = frontier(six, rig, people=4, most=2, observer=lab)
    assert seen.draws == 6  # without a number all draws of a small observer are used
    assert seen.points[0].new_laboratory is not None
    for judge in (rank, frontier):
        with pytest.raises(ValueError, match=r"^\w+: 9 draws of the parameters were asked for; lab.csv has 6$"):
            judge(six, rig, people=4, parameters=9, observer=lab)  # type: ignore[operator]
        with pytest.raises(ValueError, match=r"needs at least two draws of the parameters, or 0 for none, not 1$"):
            judge(six, rig, people=4, parameters=1)  # type: ignore[operator]
    plain = replace(model, posterior=None)
    assert [plain.draw_count(asked, 128) for asked in (None, 0, 64)] == [0, 0, 0]
