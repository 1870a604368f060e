"""Planning: sizes against closed forms, and lists that find the icon that matters."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import read_cue
from thermicon.perception.pilot.plan import plan
from thermicon.perception.pilot.playing import Confusions
from thermicon.perception.pilot.trial_list import best_list, steps_of


def one_doubtful(laboratories: int = 120, people: int = 4) -> Confusions:
    """Laboratories that differ in the first of four icons alone."""
    right = np.linspace(0.3, 0.95, laboratories)[:, None] * np.ones((1, people))
    chance = np.tile(np.eye(4) * 0.88 + 0.03, (laboratories, people, 1, 1))
    chance[:, :, 0] = ((1.0 - right) / 3)[:, :, None]
    chance[:, :, 0, 0] = right
    return Confusions(("doubtful", "b", "c", "d"), chance.astype(np.float32))


def test_a_list_presents_the_icon_in_doubt() -> None:
    played = one_doubtful()
    found = best_list(played, played.correct, 10, seed=1)
    assert found.presented == {"doubtful": 10}
    assert found.sd < found.sd_random[0] - 3 * found.sd_random[1] / np.sqrt(8)
    assert found.sd < found.sd_even < found.sd_before
    assert found.sd_before == pytest.approx(played.correct.std(), rel=0.05)
    assert sorted(found.order(3)) == ["doubtful"] * 10
    assert found.to_dict()["length"] == 10


def test_expected_sd_is_that_of_a_beta_posterior() -> None:
    # A uniform proportion p, known from n trials: E Var = 1/(6(n + 2)).
    played = one_doubtful(240, 1)
    right = np.linspace(0.002, 0.998, 240)
    chance = np.array(played.probability)
    chance[:, 0, 0] = ((1.0 - right) / 3)[:, None]
    chance[:, 0, 0, 0] = right
    found = best_list(Confusions(played.icons, chance), right, 8, seed=0)
    assert found.sd == pytest.approx(np.sqrt(1.0 / (6.0 * 10.0)), rel=0.08)


def test_long_lists_are_built_of_several_at_a_time() -> None:
    assert [steps_of(each) for each in (1, 30, 31, 100)] == [1, 30, 16, 25]
    calls: list[int] = []
    played = one_doubtful(40, 2)
    found = best_list(played, played.correct, 50, step=lambda: calls.append(1))
    assert (found.length, len(calls)) == (50, steps_of(50))
    with pytest.raises(ValueError, match="a list needs at least one presentation, not 0"):
        best_list(played, played.correct, 0)


@pytest.mark.slow
def test_a_plan_of_one_and_of_two_sets() -> None:
    icons, rig = read_cue("six-icons"), Rig.load("thenar")
    steps: list[tuple[int, int]] = []
    one = plan(
        icons, rig, participants=[4, 30], trials=[12, 48], draws=20, length=2, wanted=0.12,
        progress=lambda done, total: steps.append((done, total)),
    )  # fmt: skip
    widths = {(each.participants, each.trials): each.width for each in one.designs}
    assert widths[4, 12] > widths[4, 48] > widths[30, 48]
    best = one.cheapest
    assert best is not None and best.participants == 30 and best.width <= 0.12
    assert steps[-1][0] == steps[-1][1]
    assert one.to_dict()["wanted"] == {"interval_width": 0.12}
    two = plan(icons, rig, read_cue("pulse-sequences"), participants=[8], trials=[24], draws=20, length=1)
    design = two.designs[0]
    assert design.found is not None and design.wrong is not None
    assert design.found > 0.95 and design.wrong == 0.0  # six icons against twelve pulses: 85 % and 28 %
    assert two.difference is not None and two.difference[0] > 0.3
    assert two.cheapest == design


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"participants": [1]}, "participants must be 2 to 500, since one alone shows no spread"),
        ({"trials": [0]}, "trials of a participant must be 1 to 5000"),
        ({"participants": []}, "at least one number of participants"),
        ({"wanted": 1.0}, "must lie between 0 and 1"),
        ({"draws": 3}, "at least 20 draws are needed, not 3"),
    ],
)
def test_sizes_that_cannot_be_are_refused(options: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        plan(read_cue("six-icons"), Rig.load("thenar"), **options)  # type: ignore[arg-type]
