"""The margin of a choice with a goal."""

from itertools import combinations

import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import Selection, choose, frontier, rank
from thermicon.perception.selection.appraise import Appraisal, appraise
from thermicon.perception.selection.goal import Goal
from thermicon.perception.selection.goal_result import judge_goal

POOL = "cue 1; set s { site thenar; control display; baseline 32 °C }; " + "; ".join(
    f"icon {name} {{ {what}; return at 3 °C/s }}"
    for name, what in {
        "sip": "cool by 1.2 °C at 2 °C/s",
        "dip": "cool by 4 °C at 3 °C/s",
        "slow": "cool by 4 °C at 0.8 °C/s",
        "twice": "repeat 2 { cool by 2 °C at 2 °C/s; return at 3 °C/s }; cool by 1 °C at 2 °C/s",
        "glow": "warm by 2 °C at 2 °C/s",
        "warm": "warm by 4 °C at 1 °C/s",
    }.items()
)
MANY: dict[str, int] = {"people": 12, "parameters": 0}


@pytest.fixture(scope="module")
def pool() -> IconSet:
    return parse(POOL)


@pytest.fixture(scope="module")
def every(pool: IconSet, rig: Rig) -> list[Appraisal]:
    return [
        appraise([pool[name] for name in names], rig, people=12) for names in combinations([i.name for i in pool], 3)
    ]


@pytest.mark.parametrize("objective", ["worst", "felt-and-named"])
def test_what_some_choice_meets_is_met_and_just_above_it_none(
    pool: IconSet, rig: Rig, every: list[Appraisal], objective: str
) -> None:
    """Two quantities whose best choices differ: the best of the worse margin is found, whatever else is maximised."""
    felt, apart = max(each.felt_and_named for each in every), max(each.d_prime for each in every)
    best = max(min(each.felt_and_named / felt, each.d_prime / apart) for each in every)
    assert 0.5 < best < 1.0
    for share, met in ((0.999, True), (1.004, False)):
        goal = f"felt-and-named >= {share * best * felt:.6f}, d_prime >= {share * best * apart:.6f}"
        table = frontier(pool, rig, goal=goal, most=3, objective=objective, **MANY)  # type: ignore[arg-type]
        assert table.goals[1].met is met
        assert table.points[1].optimal is met  # of those that miss it, eight were judged by people
        asked = Selection(3, objective)  # type: ignore[arg-type]
        ranking = rank(pool, rig, **MANY)
        chosen = choose(ranking, asked, goal=Goal.parse(goal), parameters=0)
        assert judge_goal(goal, ranking, chosen).met is met


def test_a_goal_of_single_icons_and_totals_leaves_the_objective(pool: IconSet, rig: Rig) -> None:
    ranking = rank(pool, rig, **MANY)
    plain = choose(ranking, Selection(3), parameters=0)
    kept = choose(ranking, Selection(3), goal=Goal.parse("time <= 60 s, detected >= 20 %"), parameters=0)
    assert (kept.icons, kept.optimal) == (plain.icons, True)


def test_how_often_a_share_of_people_must_detect_leaves_no_icon_out_that_may_do(pool: IconSet, rig: Rig) -> None:
    mean = dict(zip([i.name for i in pool], rank(pool, rig, **MANY).felt.detected.tolist(), strict=True))["sip"]
    for people, out in (("", True), (" for 60 % of people", False)):
        words = {"goal": f"detected >= {mean + 0.01:.4f}{people}", "people": 12, "parameters": 8, "most": 2}
        left = dict(frontier(pool, rig, **words).points[0].excluded)  # type: ignore[arg-type]
        assert ("sip" in left) is out


@pytest.mark.parametrize(
    ("text", "value", "margin"),
    [("bits >= 2", 2.2, 0.1), ("bits >= 2", 1.8, -0.1), ("time <= 10 s", 9.0, 0.1), ("safety green", 1.0, -1.0)],
)
def test_margins_are_shares_of_the_limit_and_differences_where_that_is_0(
    text: str, value: float, margin: float
) -> None:
    assert Goal.parse(text).parts[0].margin(value) == pytest.approx(margin)
