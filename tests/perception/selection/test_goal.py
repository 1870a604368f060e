import pytest

from thermicon.perception import Goal
from thermicon.perception.selection.goal import QUANTITIES, GoalError


def test_a_goal_is_read_and_written_in_one_form() -> None:
    goal = Goal.parse("correct>=90% for 95 % of people,detected ≥ 0.95, safety green, time <= 0.5 min, onset < 800 ms")
    assert goal.text == (
        "correct >= 90 % for 95 % of people, detected >= 95 %, safety green, time <= 30 s, onset <= 0.8 s"
    )
    assert Goal.parse(goal.text) == goal
    assert [part.quantity for part in goal.parts] == ["correct", "detected", "safety", "time", "onset"]
    assert goal.of("time") == 30.0
    assert goal.of("energy") is None
    assert repr(Goal.parse("count 6")) == "Goal(count >= 6)"


def test_the_strictest_of_several_counts() -> None:
    goal = Goal.parse("correct >= 80 % for 95 % of people, correct >= 90 %")
    assert goal.of("correct") == 0.9


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("corect >= 90 %", "there is no quantity 'corect': did you mean correct"),
        ("correct <= 5 %", "is wanted >= a number, not <="),
        ("time = 5 s", "is wanted <= a number, not ="),
        ("correct >= 90", "lies in 0 to 100 %: write it as 90 %"),
        ("correct >= 90 s", "correct is given in % or no unit, not s"),
        ("time <= 5", "time is given in s or ms or min, not without a unit"),
        ("time <= 0 s", "time must be above 0 s"),
        ("time <= -3 s", "time must be above 0 s"),
        ("correct >= −5 %", "correct lies in 0 to 100 %"),
        ("count six", "count needs a comparison and a number, such as 'count 6'"),
        ("safety blue", "safety is green or amber"),
        ("safety >= 5", "safety is green or amber"),
        ("time 5", "time needs a comparison and a number, such as 'time <= 10 s'"),
        ("correct >= 90 % for", "it ends too early"),
        ("correct >= 90 % for 95 % of people,", "it ends with a comma: leave it out"),
        ("correct >=", "it ends too early"),
        ("correct >= 2,5 %", "'5 %' at character 14 cannot be read"),
        ("", "it ends too early"),
        ("count 1", "count lies in 2 to 10000"),
        ("count 6.5", "count is a whole number of icons"),
        ("time <= 9 s for 95 % of people", "time is the same for all people"),
        ("correct >= 9 % for 20 % of people", "for 50 % of people or more"),
        (
            "count 4, count >= 5",
            "'count >= 4' and 'count >= 5' limit the same quantity: keep the stricter, 'count >= 5'",
        ),
        ("time <= 9 s, time <= 8 s", "keep the stricter, 'time <= 8 s'"),
        ("safety amber, safety green", "keep the stricter, 'safety green'"),
        ("bits >= 2, bits >= 2 bits", "'bits >= 2 bits' stands twice: leave one out"),
        ("correct >= 90 %, correct >= 80 %", "limit the same quantity: keep the stricter, 'correct >= 90 %'"),
    ],
)
def test_what_cannot_be_read_is_said_with_its_place_and_cure(text: str, words: str) -> None:
    with pytest.raises(GoalError) as raised:
        Goal.parse(text)
    assert words in str(raised.value)


def test_every_quantity_can_be_asked_for() -> None:
    for name, known in QUANTITIES.items():
        unit = next(iter(known.units))
        goal = Goal.parse(f"{name} {known.comparison} 5 {unit}".rstrip())
        assert goal.parts[0].limit == pytest.approx(5 * known.units[unit])
