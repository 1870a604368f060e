"""How icons are asked for: what the icon before leaves behind."""

from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse, read_cue
from thermicon.perception import Observer, Ranking, Task, cheapest_edit, choose, rank
from thermicon.perception.identification.carry_over import CarryOver, carry_over
from thermicon.perception.observer.observer import NORMS
from thermicon.perception.observer.people import People
from thermicon.perception.selection.edit import Edit
from thermicon.perception.selection.request import Selection

RIG = Rig.load("thenar")
SIX = read_cue("six-icons")
SIX_NAMES = [icon.name for icon in SIX]


def ranked(icons: IconSet = SIX, *, task: Task | None = None) -> Ranking:
    return rank(icons, RIG, people=12, parameters=0, task=task or Task())


@pytest.fixture(scope="module")
def usual() -> Ranking:
    return ranked()


@pytest.fixture(scope="module")
def left_behind() -> CarryOver:
    return carry_over(list(SIX), RIG, 18.0, 2.0)


def test_the_usual_task_adds_nothing(usual: Ranking) -> None:
    assert Task().plain
    assert usual.to_dict()["task"] == {"gap_s": None}
    assert all(icon["carry_over"] is None for icon in usual.to_dict()["icons"])


@pytest.mark.slow
def test_a_gap_lets_the_icon_before_be_felt(usual: Ranking, left_behind: CarryOver) -> None:
    near, far = ranked(task=Task(gap_s=2.0)), ranked(task=Task(gap_s=600.0))
    assert near.proportion_correct < usual.proportion_correct - 0.05
    assert far.proportion_correct == pytest.approx(usual.proportion_correct, abs=1e-5)
    told = near.to_dict()["icons"][0]["carry_over"]
    assert told["after"] in usual.labels and told["d_prime"] > 0.5
    worst = max(float(left_behind.apart[0, j, 0]) for j in range(6))
    assert told["d_prime"] == pytest.approx(worst, rel=1e-9)


def test_what_is_left_behind_is_what_a_run_of_both_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    """The nominal person feels one icon after another, written as one icon: no superposition, no tricks."""
    from thermicon.circuit import simulate
    from thermicon.icons import Icon, rest
    from thermicon.perception.identification.episodes import Episodes, episode_distances
    from thermicon.perception.sensation.percept import perceive

    monkeypatch.setattr("thermicon.perception.identification.carry_over.draw_people", lambda _: People.nominal())
    left_behind = carry_over(list(SIX), RIG, 18.0, 2.0)
    first, second = SIX["double-dip"], SIX["warming-step"]
    both = Icon("both", [*first.statements, rest(2.0), *second.statements], context=second.context)
    gap = round((first.corners().duration_s + 2.0) * 25)
    after = perceive(simulate(both, RIG, rate_Hz=25.0, tail_s=18.0))
    alone = perceive(simulate(second, RIG, rate_Hz=25.0, tail_s=18.0 - second.corners().duration_s))
    rows = alone.psi_cold.size
    stacks = [np.stack([getattr(alone, psi), getattr(after, psi)[gap : gap + rows]])[np.newaxis]
              for psi in ("psi_cold", "psi_warm")]  # fmt: skip
    episodes = Episodes.of(*stacks, 0.04, Observer.load())
    place = {name: k for k, name in enumerate(left_behind.names)}
    for k, norm in enumerate(NORMS):
        told = left_behind.apart[k, place["double-dip"], place["warming-step"]]
        apart = episode_distances(episodes, episodes, Observer.load(), norm)
        assert apart[0, 0, 1] == pytest.approx(told, rel=0.02)


@pytest.mark.slow
def test_an_edit_parts_a_pair_in_the_task_asked_for() -> None:
    task, wanted = Task(gap_s=60.0), 2.0
    found = cheapest_edit(
        rank(list(SIX), RIG, people=20, parameters=0, task=task), "warming-step", "linear-warming", wanted=wanted
    )
    assert isinstance(found, Edit)
    edited = replace(SIX, entries=tuple(found.edited if icon.name == found.icon else icon for icon in SIX))
    after = rank(edited, RIG, people=20, parameters=0, task=task)
    pair = next(p for p in after.pairs if {p.a, p.b} == {"warming-step", "linear-warming"})
    assert pair.d_prime == pytest.approx(found.d_prime, rel=1e-3) and pair.d_prime >= wanted
    before = {(p.a, p.b): p.d_prime for p in rank(SIX, RIG, people=20, parameters=0, task=task).pairs}
    for other in after.pairs:
        if {other.a, other.b} != {"warming-step", "linear-warming"}:
            assert other.d_prime > min(before[other.a, other.b] - 0.101, 2 * wanted)


@pytest.mark.slow
def test_a_choice_is_judged_as_the_set_that_it_is() -> None:
    """What the icons left out would leave behind does not count any more."""
    hot = "icon hot { warm by 17 °C over 3 s; hold for 2 s; return over 3 s }\n"  # as long as the six
    pool, task = parse(str(SIX) + "\n" + hot), Task(gap_s=3.0)
    chosen = choose(rank(pool, RIG, people=20, parameters=0, task=task), Selection(3), parameters=0)
    assert "hot" not in chosen.icons
    alone = rank(replace(SIX, entries=tuple(SIX[n] for n in chosen.icons)), RIG, people=20, parameters=0, task=task)
    assert chosen.at_own_range.proportion_correct == pytest.approx(alone.proportion_correct, abs=2e-3)
    assert chosen.at_own_range.d_prime == pytest.approx(min(p.d_prime for p in alone.pairs), rel=1e-2)


def test_what_is_not_safe_leaves_nothing_behind() -> None:
    """Two icons as long as each other: a hot one and a cold one would leave different things behind."""
    found = []
    for by in ("warm by 17 °C over 8.5 s", "cool by 22 °C over 8.5 s"):
        unsafe = f"icon unsafe {{ {by}; hold for 2 s; return over 8.5 s }}\n"
        with_it = ranked(parse(str(SIX) + "\n" + unsafe), task=Task(gap_s=3.0))
        assert {icon["carry_over"]["after"] for icon in with_it.to_dict()["icons"]} <= set(SIX_NAMES)
        found.append({(p.a, p.b): p.d_prime for p in with_it.pairs if "unsafe" not in (p.a, p.b)})
    assert len(found[0]) == 15
    assert found[0] == pytest.approx(found[1], rel=1e-6)


@pytest.mark.parametrize("gap_s", [-1.0, 601.0])
def test_numbers_of_a_task_out_of_their_range(gap_s: float) -> None:
    with pytest.raises(ValueError, match=f"gap of {gap_s:g} s between icons must lie in 0 to 600 s"):
        Task(gap_s=gap_s)
