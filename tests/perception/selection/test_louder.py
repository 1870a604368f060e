"""Icons that are hardly felt and the one number that makes them louder."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import parse
from thermicon.perception import Goal, rank
from thermicon.perception.ranking.ranking import Ranking
from thermicon.perception.selection.louder import LARGEST, STEPS, louder
from thermicon.perception.selection.pool import Pool

FAINT = (
    "cue 1; set s { site thenar; control display; baseline 32 °C }; "
    "icon faint { cool by 0.2 °C at 1 °C/s; hold for 1 s; return at 3 °C/s }; "
    "icon loud { warm by 4 °C at 2 °C/s; return at 2 °C/s }; icon twice { repeat 2 { play loud; rest for 1 s } }"
)


@pytest.fixture(scope="module")
def ranking(rig: Rig) -> Ranking:
    return rank(parse(FAINT), rig, people=12, parameters=0)


@pytest.mark.parametrize("wanted", [0.5, 0.9, 0.99])
def test_one_line_is_changed_just_so_far_that_the_icon_is_felt(ranking: Ranking, rig: Rig, wanted: float) -> None:
    (edit,), nominal = next(louder(ranking, ["faint"], [wanted])), ranking.model.nominal
    before, after = (str(icon).splitlines() for icon in (parse(FAINT)["faint"], edit.edited))
    changed = [(a.strip(), b.strip()) for a, b in zip(before, after, strict=True) if a != b]
    assert changed == [(edit.old, edit.new)] and edit.old.startswith("cool by 0.2 °C")
    # A step less, in the same number, would not be enough.
    step = LARGEST ** (1.0 / STEPS)
    by = float(edit.new.split()[2])
    less = parse(str(edit.edited).replace(edit.new, edit.new.replace(f"{by:g} °C", f"{by / step / 1.05:.4f} °C", 1)))
    shares = Pool.of([edit.edited, less["faint"]], rig, nominal).felt_by(nominal)[0]
    assert shares[1] < wanted <= shares[0]


def test_what_is_played_by_another_icon_or_cannot_be_felt_so_often_stays(ranking: Ranking) -> None:
    assert [*louder(ranking, ["loud"], [0.9])] == [()]
    assert [*louder(ranking, ["faint"], [1.0])] == [()]


def test_what_is_left_out_is_said_with_the_digits_that_its_limit_takes(rig: Rig) -> None:
    pool = Pool.of([*parse(FAINT)][:2], rig, rank(parse(FAINT), rig, people=2, parameters=0).model.nominal)
    said = pool.objections(Goal.parse("detected >= 99 %"), np.array([0.986, 0.3]), np.array([1.0, 1.0]))
    assert said == ("is detected in 98.6 % of trials only", "is detected in 30 % of trials only")
