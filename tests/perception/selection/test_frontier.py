import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import choose, frontier, rank
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


def test_every_size_has_its_best_choice(found: Frontier) -> None:
    assert [len(point.icons) for point in found.points] == [2, 3, 4, 5]
    correct = [point.proportion_correct for point in found.points]
    assert correct == sorted(correct, reverse=True)
    worst = [point.d_prime for point in found.points]
    assert worst == sorted(worst, reverse=True)
    for point in found.points:
        assert point.low <= point.proportion_correct <= 1.0
        assert 0.0 < point.information_bits <= np.log2(len(point.icons))
        assert point.total_s > 0.0


def test_a_choice_is_that_of_choose(found: Frontier, six: IconSet, rig: Rig) -> None:
    chosen = choose(rank(six, rig, people=12, seed=3, parameters=0), Selection(3, "worst"), parameters=0)
    point, own = found.points[1], chosen.at_own_range
    assert (point.icons, point.total_s, point.total_J) == (chosen.icons, chosen.total_s, chosen.total_J)
    assert point.optimal is chosen.optimal
    assert (point.d_prime, point.proportion_correct, point.low) == (own.d_prime, own.proportion_correct, own.reached)


def test_direct_naming_of_all_icons_is_that_of_rank(rig: Rig) -> None:
    icons = parse(THREE)
    whole = rank(icons, rig, people=8, parameters=0, norm="naming")
    own = choose(whole, Selection(3), parameters=0).at_own_range
    assert own.proportion_correct == pytest.approx(whole.proportion_correct, abs=1e-12)
    assert own.information_bits == pytest.approx(whole.information_bits, abs=1e-12)


def test_as_a_table_and_a_picture(found: Frontier) -> None:
    frame = found.to_frame()
    assert list(frame["icons"]) == [2, 3, 4, 5]
    assert frame["names"][0].split() == list(found.points[0].icons)
    axes = found.plot()
    assert axes.get_ylabel() == "correct (%)"
    assert len(axes.lines) == 3
    assert repr(found).startswith("Frontier(2 to 5 of 6 icons by worst on thenar")


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
    goal = "correct >= 85 % for 95 % of people, time <= 30 s"
    seen = frontier(six, rig, people=8, parameters=8, objective="worst", goal=goal)
    assert [len(point.icons) for point in seen.points] == [2, 3]
    assert all(point.total_s <= 30.0 for point in seen.points)
    ranking = rank(six, rig, people=8, parameters=0)
    chosen = choose(ranking, Selection(3, "worst", most_s=30.0), parameters=8)
    point = seen.points[1]
    assert point.icons == chosen.icons
    assert point.goal is not None
    value = judge_goal(goal, ranking, chosen).parts[0].value
    assert value == point.goal.parts[0].value == point.low_with_model == point.reached
    row = seen.rows()[1]
    assert row["proportion_correct_95_percent_of_people_and_model"] == point.low_with_model
    assert row["meets_goal"] is point.goal.met


def test_a_goal_leaves_icons_out_and_says_why(rig: Rig) -> None:
    icons = parse(
        "cue 1; icon faint { cool by 0.1 K at 1 K/s }; icon dip { cool by 3 K at 2 K/s };"
        "icon glow { warm by 3 K at 2 K/s }"
    )
    seen = frontier(icons, rig, people=4, parameters=0, goal="detected >= 90 %")
    assert [name for name, _ in seen.excluded] == ["faint"]
    assert "of trials only" in seen.excluded[0][1]
    with pytest.raises(ChoiceError, match=r"^2 icons cannot be chosen: none is left \(faint is "):
        frontier(icons, rig, people=4, parameters=0, goal="onset <= 0.01 s")
    with pytest.raises(GoalError, match="needs draws"):
        frontier(icons, rig, people=4, parameters=0, goal="correct >= 9 % for 95 % of people")
    with pytest.raises(ValueError, match="at least two draws"):
        frontier(icons, rig, people=4, parameters=1)


def test_amber_icons_are_named_or_left_out(rig: Rig) -> None:
    icons = parse(
        "cue 1; icon deep { cool by 10.5 K at 3 K/s; return at 3 K/s }; icon dip { cool by 3 K at 2 K/s };"
        "icon glow { warm by 3 K at 2 K/s }"
    )
    rig = rig.with_(**{"driver.current_limit_A": 4.0})
    named = frontier(icons, rig, people=2, parameters=0)
    assert named.points[-1].amber == ("deep",)
    assert named.rows()[-1]["amber"] == "deep"
    green = frontier(icons, rig, people=2, parameters=0, goal="safety green")
    assert green.excluded[0][0] == "deep"
    assert green.excluded[0][1].startswith("is amber: ")
    assert green.points[-1].amber == ()


def test_a_thermode_has_no_energy_to_limit() -> None:
    with pytest.raises(ChoiceError, match=r"a thermode, which states no energy: leave out .*energy of the goal"):
        frontier(parse(THREE), Rig.load("tcs2"), people=2, parameters=0, goal="energy <= 3 J")
