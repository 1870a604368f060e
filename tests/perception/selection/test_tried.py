"""Goals drawn at random: what is said to meet them does, what is said to fail does, and advice leads there."""

from itertools import combinations

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import Goal, frontier, rank
from thermicon.perception.criteria import FELT_FROM
from thermicon.perception.selection.advice import LARGER, until_met, ways_to
from thermicon.perception.selection.candidates import Candidate, set_of_run
from thermicon.perception.selection.edit import Edit, cheapest_edits
from thermicon.perception.selection.goal_result import GoalResult, judge_goal
from thermicon.perception.selection.request import ChoiceError

HEAD = "cue 1\nset pool { site thenar; control display; baseline 32 °C }\n"
SPACES = {
    "faint and loud": "icon dip(k in [0.2, 0.5, 1, 3, 6] °C, r in [1, 3] °C/s) { cool by k at r; return at 3 °C/s }\n"
    "icon rise(k in [0.3, 1, 4] °C, r in [1, 2] °C/s) { warm by k at r; hold for 1 s; return at 2 °C/s }",
    "one way": "icon dip(k in 1..6 step 1 °C, h in [0.5, 2] s) { cool by k at 3 °C/s; hold for h; return at 3 °C/s }",
    "rhythms": "icon dip(k in [1, 4] °C, n in 1..3 step 1) { repeat n { cool by k at 3 °C/s; return at 3 °C/s } }\n"
    "icon rise(k in [1, 3] °C, n in 1..3 step 1) { repeat n { warm by k at 2 °C/s; return at 2 °C/s } }",
}
RIGS = {name: Rig.load(name) for name in ("thenar", "forearm", "fingertip")}
RIGS["small"] = RIGS["thenar"].with_(**{"contact.area_cm2": 2.0})
CROWD = {"people": 12, "parameters": 8}
GOALS, CHOICES, NEAR = 5, 50, 0.03
"""Goals of each space on each rig, random choices that may contradict, and the error of so few people and draws."""


def goal_of(rng: np.random.Generator) -> Goal:
    """A goal of one to three parts, at limits that some choices reach and others do not."""
    of = rng.choice(["felt-and-named", "felt-and-named", "named", "bits", "d_prime"])
    whose = f" for {rng.choice([60, 80, 90])} % of people" * bool(rng.random() < 0.5 and of != "d_prime")
    least = {"bits": f"{rng.uniform(0.8, 1.9):.2f}", "d_prime": f"{rng.uniform(1.0, 9.0):.1f}"}
    parts = [f"{of} >= {least.get(of, f'{rng.uniform(65, 98.5):.1f} %')}{whose}"]
    more = [f"detected >= {rng.uniform(30, 99):.0f} %", f"time <= {rng.uniform(6, 25):.0f} s"]
    return Goal.parse(", ".join([*parts, *(part for part in more if rng.random() < 0.4)]))


def judged(icons: IconSet, rig: Rig, goal: Goal) -> GoalResult:
    return judge_goal(goal, rank(icons, rig, **CROWD))  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("where", RIGS)
@pytest.mark.parametrize("space", SPACES)
def test_met_and_no_choice_are_true(space: str, where: str) -> None:
    rng = np.random.default_rng([[*SPACES].index(space), [*RIGS].index(where)])
    rig, icons = RIGS[where], parse(HEAD + SPACES[space])
    for _ in range(GOALS):
        goal, sizes = goal_of(rng), [2]
        usable, said = [*icons], ""
        try:
            found = frontier(icons, rig, goal=goal, most=4, **CROWD)  # type: ignore[arg-type]
        except ChoiceError as refused:
            said = str(refused)
        else:
            for point, result in zip(found.points, found.goals, strict=True):
                if result.met:
                    chosen = [Candidate(found.icons[name]) for name in point.icons]
                    again = judged(parse(str(set_of_run(found.icons, chosen, rig, "best"))), rig, goal)
                    assert again.margin > -NEAR, (goal.text, point.icons, again.parts)
            missed = [point for point, result in zip(found.points, found.goals, strict=True) if not result.met]
            sizes = [len(point.icons) for point in missed]
            usable = [icon for icon in found.icons if icon.name not in dict(found.points[0].excluded)]
        for size in rng.choice(sizes, CHOICES) if sizes else ():
            some = [usable[k] for k in sorted(rng.choice(len(usable), size, replace=False))]
            other = rank(some, rig, **CROWD)  # type: ignore[arg-type]
            fine = all(icon.playable for icon in other.icons) and min(other.felt.detected) >= FELT_FROM
            met = judge_goal(goal, other).margin >= NEAR
            assert not (met and fine), (goal.text, [icon.name for icon in some], said)


@pytest.mark.slow
@pytest.mark.parametrize("where", RIGS)
def test_what_comes_next_reaches_the_goal_where_any_of_its_ways_does(where: str) -> None:
    """By brute force: each choice of the icons, the edit of each pair, each area."""
    rng, rig = np.random.default_rng([7, [*RIGS].index(where)]), RIGS[where]
    reached, possible = 0, 0
    for _ in range(8):
        icons = parse(HEAD + "\n".join(
            f"icon i{k} {{ {rng.choice(['cool', 'warm'])} by {rng.uniform(0.3, 5):.1f} °C at {rng.uniform(1, 3):.1f} "
            f"°C/s; hold for {rng.choice([1, 2])} s; return at 2 °C/s }}" for k in range(4)
        ))  # fmt: skip
        goal = Goal.parse(f"felt-and-named >= {rng.uniform(50, 97):.1f} % for {rng.choice([60, 90])} % of people")
        ranking = rank(icons, rig, **CROWD)  # type: ignore[arg-type]
        before = judge_goal(goal, ranking)
        if before.met:
            continue
        tried = until_met(ways_to(ranking, before, CROWD["parameters"], cheapest_edits(ranking)))
        edits = [each for each in cheapest_edits(ranking, "all").values() if isinstance(each, Edit)]
        names = ranking.labels
        sets = [[icons[k] for k in some] for n in (3, 2) for some in combinations(names, n)]
        sets += [[edit.edited if icon.name == edit.icon else icon for icon in icons] for edit in edits]
        larger = [rig.with_(**{"contact.area_cm2": 1e4 * times * rig.contact.area_m2}) for times in LARGER]
        others = [(IconSet.of(each), rig) for each in sets] + [(icons, each) for each in larger]
        best = any(judged(each, on, goal).met for each, on in others)
        possible += best
        reached += best and any(way.result.met for way in tried)
    assert reached >= 0.9 * possible > 0
