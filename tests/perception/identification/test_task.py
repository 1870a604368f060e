"""The identification task with carry-over beside a session that plays both icons."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig, SessionPlan, simulate, simulate_current
from thermicon.circuit.safety.sessionplay import drive_of
from thermicon.icons import Icon, IconSet, parse, read_cue, rest
from thermicon.perception import Observer, Ranking, Task, cheapest_edit, choose, perceive, rank
from thermicon.perception.identification import carry_over as carryover
from thermicon.perception.identification.carry_over import carry_over
from thermicon.perception.identification.episodes import Episodes, episode_distances
from thermicon.perception.observer.channels import MEMORY_FORMS
from thermicon.perception.observer.people import People, draw_people
from thermicon.perception.selection.edit import Edit
from thermicon.perception.selection.request import Selection
from thermicon.perception.sensation.received import received as at_receptors

RIG = Rig.load("thenar")
SIX = read_cue("six-icons")
SIX_NAMES = [icon.name for icon in SIX]


def ranked(icons: IconSet = SIX, *, task: Task | None = None) -> Ranking:
    return rank(icons, RIG, people=12, parameters=0, task=task or Task())


@pytest.fixture(scope="module")
def usual() -> Ranking:
    return ranked()


def test_the_usual_task_adds_nothing(usual: Ranking) -> None:
    assert usual.to_dict()["task"] == {"gap_s": None}
    assert all(icon["carry_over"] is None for icon in usual.to_dict()["icons"])


@pytest.mark.slow
def test_a_gap_lets_the_icon_before_be_felt(usual: Ranking) -> None:
    near, far = ranked(task=Task(gap_s=2.0)), ranked(task=Task(gap_s=600.0))
    assert near.proportion_correct < usual.proportion_correct - 0.05
    assert far.proportion_correct == pytest.approx(usual.proportion_correct, abs=1e-5)
    told = near.to_dict()["icons"][0]["carry_over"]
    assert told["after"] in usual.labels and told["d_prime"] > 0.5
    left_behind = carry_over(list(SIX), RIG, 18.0, 2.0)
    assert told["d_prime"] == pytest.approx(left_behind.apart[0, :, 0].max(), rel=1e-9)


def test_what_is_left_behind_is_what_a_run_of_both_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    """The nominal person feels one icon after another, written as one icon: no superposition, no tricks."""
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
    for k, form in enumerate(MEMORY_FORMS):
        told = left_behind.apart[k, place["double-dip"], place["warming-step"]]
        apart = episode_distances(episodes, episodes, Observer.load(), form)
        assert apart[0, 0, 1] == pytest.approx(told, rel=0.02)


@pytest.mark.slow
def test_an_edit_parts_a_pair_in_the_task_asked_for() -> None:
    how: dict[str, Any] = {"people": 20, "parameters": 0, "task": Task(gap_s=60.0), "memory": "episodes"}
    wanted = 2.5
    found = cheapest_edit(rank(list(SIX), RIG, **how), "warming-step", "linear-warming", wanted=wanted)
    assert isinstance(found, Edit)
    edited = replace(SIX, entries=tuple(found.edited if icon.name == found.icon else icon for icon in SIX))
    after = rank(edited, RIG, **how)
    pair = next(p for p in after.pairs if {p.a, p.b} == {"warming-step", "linear-warming"})
    assert pair.d_prime == pytest.approx(found.d_prime, rel=1e-3) and pair.d_prime >= wanted
    before = {(p.a, p.b): p.d_prime for p in rank(SIX, RIG, **how).pairs}
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


ICONS: list[Icon] = [SIX[name] for name in ("cooling-step", "warming-step", "double-dip")]
Received = tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]


def received(monkeypatch: pytest.MonkeyPatch, gap_s: float, tracking: str | None) -> list[Received]:
    """Receptor temperatures (icons, rows) that the nominal person gets after each icon, cold and warm."""
    caught: list[Received] = []
    usual = carryover.perceive_many

    def catch(cold: Any, warm: Any, *rest: Any, **more: Any) -> Any:
        caught.append((cold, warm))
        return usual(cold, warm, *rest, **more)

    with monkeypatch.context() as patch:
        patch.setattr(carryover, "perceive_many", catch)
        patch.setattr(carryover, "PEOPLE", 1)
        carry_over(ICONS, RIG, 18.0, gap_s, tracking=tracking)
    return caught[1:]


def largest_miss_K(tracking: str, gap_s: float, got: list[Received]) -> float:
    """The largest difference at either receptor while the second of two icons plays."""
    worst, begin = 0.0, round((8.0 + gap_s) * carryover.RATE_HZ)
    for place, first in enumerate(ICONS):
        for other, second in enumerate(ICONS):
            plan = SessionPlan((first.name, second.name), gap_s)
            session = drive_of(plan, {icon.name: icon for icon in ICONS}, RIG, tracking)
            run = simulate_current(session.drive, RIG, start_C=session.start_C)
            every = round(100 / carryover.RATE_HZ)
            for values, column in zip(got[place], at_receptors(run, Observer.load()), strict=True):
                played = column[::every][begin:]
                worst = max(worst, float(np.abs(played - values[other, begin : begin + len(played)]).max()))
    return worst


@pytest.mark.parametrize("gap_s", [2.0, 10.0])
def test_a_tracked_display_leaves_behind_what_a_session_shows(monkeypatch: pytest.MonkeyPatch, gap_s: float) -> None:
    assert largest_miss_K("display", gap_s, received(monkeypatch, gap_s, None)) < 1e-5


@pytest.mark.parametrize("gap_s", [2.0, 10.0])
def test_a_replayed_drive_leaves_behind_what_a_session_shows(monkeypatch: pytest.MonkeyPatch, gap_s: float) -> None:
    """Within the nonlinearity of the module, which one drive after the other shows and their sum does not."""
    replayed = received(monkeypatch, gap_s, "replay")
    assert largest_miss_K("replay", gap_s, replayed) < 0.015
    assert largest_miss_K("display", gap_s, replayed) > 0.3


def test_a_ranking_by_replay_counts_what_replay_leaves_behind() -> None:
    task = Task(gap_s=10.0)
    found = rank(ICONS, RIG, people=2, parameters=0, tracking="replay", task=task).to_dict()["icons"]
    left, other = (carry_over(ICONS, RIG, 18.0, 10.0, tracking=way) for way in ("replay", None))
    names = [icon.name for icon in ICONS]
    for row in found:
        place = names.index(row["name"])
        assert tuple(row["carry_over"].values()) == left.worst_of(place, MEMORY_FORMS[0])
        assert tuple(row["carry_over"].values()) != other.worst_of(place, MEMORY_FORMS[0])


def test_names_are_given_after_ten_minutes_as_in_the_usual_task() -> None:
    usual, late = (
        rank(ICONS, RIG, people=4, parameters=0, memory="naming", task=Task(gap_s=gap)) for gap in (None, 600.0)
    )
    assert late.confusion == pytest.approx(usual.confusion, abs=0.005)


def test_what_is_left_behind_is_the_mean_of_people(monkeypatch: pytest.MonkeyPatch) -> None:
    crowd, found = draw_people(2), []
    for people in (crowd, crowd.part(0, 1), crowd.part(1, 2)):
        monkeypatch.setattr(carryover, "draw_people", lambda _, people=people: people)
        found.append(carry_over(ICONS, RIG, 18.0, 2.0).apart)
    assert found[0] == pytest.approx(0.5 * (found[1] + found[2]), rel=1e-9)


def test_icons_that_prescribe_current_are_replayed_too() -> None:
    text = "cue 1\nset s { control current }\nicon push { to 0.4 A over 2 s; hold for 1 s; return over 1 s }\n"
    icons = list(parse(text))
    near, far = (carry_over(icons, RIG, 14.0, gap_s, tracking="replay").apart[0].max() for gap_s in (1.0, 300.0))
    assert near > 3 * far


def largest(rig: Rig, gap_s: float, tracking: str | None) -> float:
    """The largest d′ from memory between an icon by itself and after another one."""
    return float(carry_over(ICONS, rig, 18.0, gap_s, tracking=tracking).apart[0].max())


WAYS = [("forearm", "replay", 79.0), ("thenar", None, 61.0)]
"""Rigs and gaps at which one person, who remembers an episode or does not, has a step of 1 d′ or more."""


@pytest.mark.parametrize(("name", "tracking", "gap_s"), WAYS, ids=[f"{each[0]}" for each in WAYS])
def test_where_one_person_has_a_step_people_have_none(name: str, tracking: str | None, gap_s: float) -> None:
    before, after = (largest(Rig.load(name), gap, tracking) for gap in (gap_s, gap_s + 1.0))
    assert after >= 0.75 * before - 0.05, "the skin forgets with time constants above 4 s"
