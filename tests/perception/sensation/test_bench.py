"""Stimuli on a bench with warnings outside the data."""

from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import parse
from thermicon.perception import Observer, perceive, rank
from thermicon.perception.observer.observer import load_thresholds
from thermicon.perception.sensation.bench import Bench, raised_cosine, ramp
from thermicon.perception.sensation.coverage import load_coverage, outside_age, outside_data, outside_site


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Bench(Rig.load("thenar"))


def test_a_ramp_is_played_held_and_returned(bench: Bench) -> None:
    played = bench.play([ramp("cold", 0.5, 1.0, 1.0, back=True), ramp("warm", 0.5, 0.5)], 3.0)
    skin = played.surface_C("skin")
    assert skin.shape == (2, 301)
    assert skin[0, [0, 50, 149, 250]] == pytest.approx([32.0, 31.5, 31.5, 32.0], abs=2e-3)
    assert skin[1, -1] == pytest.approx(32.5, abs=1e-3)
    assert played.time_s[-1] == pytest.approx(3.0)
    assert played.received(Observer.load(variable="heat flow")).cold.shape == (2, 301)


def test_what_is_felt_is_what_perceive_says(bench: Bench) -> None:
    person, played = Observer.load(), bench.play([ramp("cold", 0.5, 1.0, 1.0)], 2.0)
    cold, warm = played.felt(person)
    percept = perceive(played.traces[0], person)
    assert cold[0] == pytest.approx(percept.psi_cold)
    assert warm[0] == pytest.approx(percept.psi_warm)


def test_a_smooth_pulse_lies_on_its_curve() -> None:
    bench = Bench(Rig.load("thenar"), surface="display")
    played = bench.play([raised_cosine("warm", 3.0, 6.0)], 7.0)
    wanted = 32.0 + 1.5 * (1.0 - np.cos(2 * np.pi * np.minimum(played.time_s, 6.0) / 6.0))
    assert played.surface_C("display")[0] == pytest.approx(wanted, abs=5e-3)
    assert played.time_s[played.surface_C("display")[0].argmax()] == pytest.approx(3.0, abs=0.02)


@pytest.mark.parametrize(
    ("change", "rate", "said"),
    [
        (-18.0, 3.0, "the skin falls to 14 °C (6.0 s); data begin at 15 °C"),
        (14.0, 3.0, "the skin rises to 46 °C (4.7 s); data end at 45 °C"),
        (-17.00001, 3.0, "the skin falls to 14.99999 °C (5.7 s); data begin at 15 °C"),
        (-6.0, 12.0, "the skin changes at 12 K/s (0.4 s); data end at 10 K/s"),
    ],
)
def test_cold_and_hot_and_fast(cue: Any, change: float, rate: float, said: str) -> None:
    trace = cue(change=change, rate=rate)
    assert outside_data(trace) == (said,)
    assert outside_data(cue(change=-6.0, rate=9.9)) == outside_data(cue(change=-6.0)) == ()
    deeper = trace.but(cold_receptor_C=np.full_like(trace.skin_C, 12.0))
    assert outside_data(deeper)[0] == "the cold receptor falls to 12 °C (0.0 s); data begin at 15 °C", "the furthest"


@pytest.mark.parametrize(
    ("inside", "outside", "said"),
    [
        ({"rest_C": 29.8}, {"rest_C": 29.7}, "the skin rests at 29.7 °C (the evidence: 30 to 34 °C)"),
        ({"rest_C": 34.2}, {"rest_C": 34.3}, "the skin rests at 34.3 °C (the evidence: 30 to 34 °C)"),
        ({"area_m2": 1.97e-4}, {"area_m2": 1.95e-4}, "the contact is 1.95 cm² (the evidence: 1.96 to 9.8 cm²)"),
        ({"area_m2": 9.7e-4}, {"area_m2": 9.9e-4}, "the contact is 9.9 cm² (the evidence: 1.96 to 9.8 cm²)"),
        ({"hold": 1.1}, {"hold": 0.9}, "it changes for 1.4 s (the evidence: 1.52 to 27.1 s)"),
        ({"hold": 26.6}, {"hold": 26.8}, "it changes for 27.3 s (the evidence: 1.52 to 27.1 s)"),
        ({"rate": 0.6}, {"rate": 0.4}, "the skin changes at 0.4 K/s (the evidence: 0.5 to 40 K/s)"),
    ],
)
def test_from_either_side_of_what_the_evidence_varied(
    cue: Any, inside: dict[str, float], outside: dict[str, float], said: str
) -> None:
    def told(rest_C: float = 32.0, area_m2: float = 9e-4, hold: float = 4.0, rate: float = 4.0) -> tuple[str, ...]:
        trace = cue(change=-1.0, rate=rate, hold=hold, end_s=40.0)
        return outside_data(trace.but(skin_C=trace.skin_C + rest_C - 32.0, area_m2=area_m2))

    assert told(**inside) == ()
    assert told(**outside) == (said,)


def test_respects_that_all_icons_share_are_one_sentence(cue: Any) -> None:
    trace = cue(change=-1.0, hold=0.5)
    both, course = outside_data(trace.but(skin_C=trace.skin_C - 6.0, area_m2=1e-4))
    assert (
        both
        == "the skin rests at 26 °C (the evidence: 30 to 34 °C), the contact is 1 cm² (the evidence: 1.96 to 9.8 cm²)"
    )
    assert course.startswith("it changes for 1.17 s")


def test_ages_beyond_those_of_every_experiment() -> None:
    assert outside_age(21.0) == outside_age(80.0) == ()
    assert outside_age(20.0) == ("people are aged 20 years (the evidence: 21 to 80 years)",)
    assert outside_age(81.0) == ("people are aged 81 years (the evidence: 21 to 80 years)",)


def test_counts_of_records_are_those_of_the_table() -> None:
    table = [r for r in load_thresholds() if r.quantity in ("detection threshold", "limits threshold")]
    sites = load_coverage().select("site")
    for record in sites:
        held = [r for r in table if r.site == record.get("recorded")]
        assert (len(held), {r.source for r in held}) == (record.value, {record.source})
    assert {r.site for r in table} == {record.get("recorded") for record in sites}
    for site in ("thenar", "left thenar", "hand-dorsum", "Hand dorsum", "forearm", "wrist"):
        assert outside_site(site) == ()
    for site, meant in (("finger tip", "fingertip"), ("forhead", "forehead"), ("wrst", "wrist")):
        assert f"the {site} (did you mean {meant}?)" in outside_site(site)[0]
    assert not any("did you mean" in outside_site(site)[0] for site in ("head", "back", "hand", "toe"))


def test_a_ranking_carries_it() -> None:
    text = "cue 1\nset s { control skin }\nicon a { cool by 2 °C at 1 °C/s; hold for 1 s }"
    ranking = rank(parse(text), Rig.load("fingertip"), people=1, parameters=0)
    said = [
        "the contact is 1.5 cm² (the evidence: 1.96 to 9.8 cm²), "
        "no detection threshold is on record for the fingertip: those of the thenar are used"
    ]
    assert list(ranking.icons[0].outside_data) == said
    assert ranking.to_dict()["icons"][0]["outside_data"] == said
