from thermicon.notebooks.text.choices import goal_lines
from thermicon.perception import Goal
from thermicon.perception.ranking.goal_result import GoalPartResult, GoalResult


def test_an_icon_that_is_not_reached_is_said_apart_from_safety() -> None:
    goal = Goal.parse("safety green")
    result = GoalResult(goal, (GoalPartResult(goal.parts[0], 0.0, met=True, binding=""),), unreached=("wave", "dip"))
    assert list(goal_lines(result.to_dict())) == [
        "Goal: met",
        "  ✓ safety green: green in this simulation; export judges the worst case",
        "  Not reached, and judged as the rig would play them: wave, dip; export refuses them",
    ]
