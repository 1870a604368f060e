from thermicon.notebooks.report.choices import goal_lines
from thermicon.perception import Goal
from thermicon.perception.selection.goal_result import GoalPartResult, GoalResult


def test_an_icon_that_is_not_reached_is_said_apart_from_safety() -> None:
    goal = Goal.parse("safety green")
    result = GoalResult(goal, (GoalPartResult(goal.parts[0], 0.0, met=True, binding=""),), unreached=("wave", "dip"))
    assert list(goal_lines(result.to_dict())) == [
        "Goal: met",
        "  ✓ safety green: green in this simulation; export judges the worst case",
        "  Not reached, and judged as the rig would play them: wave, dip; export refuses them",
    ]


def test_what_a_share_of_people_means_is_said_once_and_in_a_short_line() -> None:
    goal = Goal.parse("correct >= 80 % for 95 % of people, bits >= 2 for 90 % of people, time <= 9 s")
    parts = tuple(GoalPartResult(part, part.limit, met=True, binding="") for part in goal.parts)
    lines = list(goal_lines(GoalResult(goal, parts).to_dict()))
    assert lines[-1] == "  For a share of people: what at least so many reach, with the uncertainty of the model."
    assert sum("For a share" in line for line in lines) == 1
    assert max(map(len, lines)) <= 100
    mean = GoalResult(Goal((goal.parts[2],)), parts[2:])
    assert not any("share" in line for line in goal_lines(mean.to_dict()))
    assert not any("For a share" in line for line in goal_lines(GoalResult(goal, parts).to_dict(), "met by the best 4"))
