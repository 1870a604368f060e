"""Times of a study that simulation determines."""

import numpy as np
import pytest

from thermicon.circuit import Device, Rig
from thermicon.circuit.solver.settling import settling
from thermicon.icons import load_library, parse
from thermicon.notebooks.study.schedule import Pace, Schedule, Trial, planned_plays
from thermicon.notebooks.study.study_file import StudyError, Timing
from thermicon.notebooks.study.timing import (
    GAPS_S,
    carried_over,
    find_gap,
    find_landing,
    shortest_gap_s,
)

ICONS = [load_library("six-icons")[name] for name in ("cooling-step", "linear-warming")]
THENAR = Rig.load("thenar")


@pytest.mark.slow
def test_a_derived_gap_is_the_shortest_in_whole_seconds() -> None:
    gap = find_gap(ICONS, THENAR, Timing(carry_over_d_prime=1.0), held=True)
    assert gap.reason == "carry-over falls below d′ = 1"
    assert gap.carry_over_d_prime <= 1.0 < carried_over(ICONS, THENAR, gap.gap_s - 1.0, True)[0]
    assert gap.carry_over_d_prime == carried_over(ICONS, THENAR, gap.gap_s, True)[0]
    longer = find_gap(ICONS, THENAR, Timing(carry_over_d_prime=0.3), held=True)
    assert longer.gap_s > gap.gap_s


def test_planned_times_have_landings_gaps_and_breaks() -> None:
    """Practice goes over into the first block; the second begins with a break and a landing."""
    trials = (Trial(0, 0, "glow"), Trial(1, 1, "dip"), Trial(1, 2, "glow"), Trial(2, 3, "dip"))
    plays = planned_plays(Schedule("A", trials), {"dip": 3.0, "glow": 3.0}, Pace(30.0, 10.0, 40.0))
    assert [play.onset_s for play in plays] == [30.0, 43.0, 56.0, 59.0 + 40.0 + 30.0]


def test_a_given_gap_stays_and_its_carry_over_is_stated() -> None:
    gap = find_gap(ICONS, THENAR, Timing(gap_s=12.0), held=True)
    assert (gap.gap_s, gap.reason) == (12.0, "given")
    assert gap.carry_over_d_prime > 1.0


def test_what_is_felt_after_an_icon_counts_as_if_a_rest_were_written_there() -> None:
    """They end as the skin begins to feel it: 5 s more of rest, and 5 s less of gap, are the same to people."""

    def carried(end: str, gap_s: float) -> float:
        body = f"by 4 °C at 8 °C/s; return at 8 °C/s{end} }}"
        icons = parse(f"cue 1\nset x {{ control display }}\nicon a {{ cool {body}\nicon b {{ warm {body}")
        return carried_over(list(icons), THENAR, gap_s, True)[0]

    assert carried("", 35.0) == pytest.approx(carried("; rest for 5 s", 30.0), rel=1e-3)


def test_the_search_begins_at_the_longest_gap() -> None:
    """What comes back after it had gone counts."""
    assert shortest_gap_s(lambda gap_s: gap_s > 44.5 or 5 <= gap_s <= 20) == 45.0
    assert shortest_gap_s(lambda gap_s: False) is None
    assert shortest_gap_s(lambda gap_s: True) == GAPS_S[0]


@pytest.mark.parametrize("held", [True, False], ids=["held", "open loop"])
def test_a_landing_ends_where_the_skin_has_settled(held: bool) -> None:
    landing = find_landing(ICONS[0], THENAR, Timing(), held)
    times, away = settling(ICONS[0], THENAR, 2.5, held)
    after = times >= landing.landing_s
    assert away[after].max() <= 0.1 < away[times == landing.landing_s - 1.0][0]
    assert landing.left_K == pytest.approx(away[times == landing.landing_s][0])
    assert landing.left_at_10_s_K == pytest.approx(away[times == 10.0][0])


def test_nothing_that_corrects_makes_a_landing_longer() -> None:
    held, alone = (
        find_landing(ICONS[0], THENAR, Timing(), Device.load(name).kind.regulated) for name in ("qst-tcs2", "dac-16")
    )
    assert 60.0 < held.landing_s < 180.0 < alone.landing_s
    assert 0.5 < held.left_at_10_s_K < 1.2 < alone.left_at_10_s_K


def test_settling_is_linear_in_how_far_the_skin_arrives() -> None:
    """Under a held display the skin is linear; it rests a little warmer there than bare, which is the same for all."""
    near, middle, far = (settling(ICONS[0], THENAR, from_K, True)[1] for from_K in (1.0, 2.0, 3.0))
    assert np.allclose(far - middle, middle - near, rtol=1e-6, atol=1e-9)


def test_what_never_ends_is_an_error() -> None:
    with pytest.raises(
        StudyError, match=r"carry_over_d_prime = 1e-09: after 600 s .* allow more, or give timing\.gap_s"
    ):
        find_gap(ICONS, THENAR, Timing(carry_over_d_prime=1e-9), held=True)
    wanted = Timing(landing_from_K=10.0).model_copy(update={"landing_within_K": 1e-6})
    with pytest.raises(StudyError, match=r"landing_within_K = 1e-06 K: skin that arrives 10 K .* K off after 1800 s"):
        find_landing(ICONS[0], THENAR, wanted, held=False)
