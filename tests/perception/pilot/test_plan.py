"""Plans of experiments: the precision of each size."""

import json
import math

import numpy as np
import pytest

from tests.builders import messages
from thermicon.circuit import Rig
from thermicon.icons import IconSet, read_cue
from thermicon.perception.pilot.plan import _simulated, plan
from thermicon.perception.pilot.playing import Confusions


@pytest.mark.parametrize("trials", [5, 5000])
def test_a_width_is_that_of_students_interval(trials: int) -> None:
    right = np.clip(0.5 + 0.05 * np.random.default_rng(0).standard_normal((1, 4000)), 0.0, 1.0)
    chance = np.stack([np.stack([right, 1 - right], -1), np.stack([1 - right, right], -1)], -2)
    played = Confusions(("a", "b"), chance, np.ones(chance.shape[:3]))
    design = _simulated([played], 10, trials, np.random.SeedSequence(1))
    # 2 t(0.975, 9) c4(10) SD / sqrt(10), of people and of what so many trials leave.
    left = math.hypot(0.05, 0.5 / trials**0.5)
    assert design.width == pytest.approx(2 * 2.262 * 0.9727 * left / 10**0.5, rel=0.04)


@pytest.mark.slow
def test_a_plan_of_one_and_of_two_sets(icons: IconSet, rig: Rig) -> None:
    steps: list[tuple[int, int]] = []
    one = plan(
        icons, rig, participants=[4, 30], trials=[12, 48], draws=20, wanted=0.12,
        progress=lambda done, total: steps.append((done, total)),
    )  # fmt: skip
    widths = {(each.participants, each.trials): each.width for each in one.designs}
    assert widths[4, 12] > widths[4, 48] > widths[30, 48]
    best = one.cheapest
    assert best is not None and best.participants == 30 and best.width <= 0.12
    assert steps[-1][0] == steps[-1][1]
    assert one.to_dict()["wanted"] == {"interval_width": 0.12}
    two = plan(icons, rig, read_cue("pulse-sequences"), participants=[8], trials=[24], draws=20)
    design = two.designs[0]
    assert design.found is not None and design.wrong is not None
    assert design.found > 0.85 and design.wrong == 0.0  # six icons against twelve pulses
    assert two.difference is not None and two.difference[1] > 0.05  # with all doubt
    assert two.cheapest == design


@pytest.mark.parametrize(("options", "words"), messages(__file__)["plan"].items())
def test_sizes_that_cannot_be_are_refused(icons: IconSet, rig: Rig, options: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        plan(icons, rig, **json.loads(options))
