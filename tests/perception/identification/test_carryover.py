"""What `rank --gap` takes an icon to leave behind, beside the session that really plays both icons."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig, SessionPlan, simulate_current
from thermicon.circuit.safety.sessionplay import drive_of
from thermicon.icons import Icon, parse, read_cue
from thermicon.perception import Task, rank
from thermicon.perception.identification import carry_over as carryover
from thermicon.perception.identification.carry_over import carry_over
from thermicon.perception.observer.channels import NORMS, USUAL_NORM

RIG = Rig.load("thenar")
SIX = read_cue("six-icons")
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
            for values, column in zip(got[place], ("cold_receptor_C", "warm_receptor_C"), strict=True):
                played = getattr(run, column)[::every][begin:]
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
        assert row["carry_over"] == left.worst_of(place, USUAL_NORM)
        assert row["carry_over"] != other.worst_of(place, USUAL_NORM)


def test_icons_that_prescribe_current_are_replayed_too() -> None:
    text = "cue 1\nset s { control current }\nicon push { to 0.4 A over 2 s; hold for 1 s; return over 1 s }\n"
    icons = list(parse(text))
    near, far = (carry_over(icons, RIG, 14.0, gap_s, tracking="replay").apart[0].max() for gap_s in (1.0, 300.0))
    assert near > 3 * far


def largest(rig: Rig, gap_s: float, tracking: str | None) -> float:
    """The largest d′ from memory between an icon by itself and after another one."""
    return float(carry_over(ICONS, rig, 18.0, gap_s, tracking=tracking).apart[NORMS.index(USUAL_NORM)].max())


WAYS = [("forearm", "replay", 79.0), ("thenar", None, 61.0)]
"""Rigs and gaps at which one person, who remembers an episode or does not, has a step of 1 d′ or more."""


@pytest.mark.parametrize(("name", "tracking", "gap_s"), WAYS, ids=[f"{each[0]}" for each in WAYS])
def test_where_one_person_has_a_step_people_have_none(name: str, tracking: str | None, gap_s: float) -> None:
    before, after = (largest(Rig.load(name), gap, tracking) for gap in (gap_s, gap_s + 1.0))
    assert after >= 0.75 * before - 0.05, "the skin forgets with time constants above 4 s"
