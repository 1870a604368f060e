"""Stimuli on a bench with warnings outside the data."""

from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import parse
from thermicon.perception import Observer, perceive, rank
from thermicon.perception.observer.observer import load_thresholds
from thermicon.perception.sensation.bench import Bench, raised_cosine, ramp
from thermicon.perception.sensation.coverage import load_coverage, outside_data, outside_site


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


def test_counts_of_records_are_those_of_the_table() -> None:
    table = [r for r in load_thresholds() if r.quantity in ("detection threshold", "limits threshold")]
    sites = load_coverage().select("site")
    for record in sites:
        held = [r for r in table if r.site == record.get("recorded")]
        assert (len(held), {r.source for r in held}) == (record.value, {record.source})
    assert {r.site for r in table} == {record.get("recorded") for record in sites}
    for site in ("thenar", "left thenar", "hand-dorsum", "Hand dorsum", "forearm", "wrist"):
        assert outside_site(site) == ()


def test_a_ranking_carries_it() -> None:
    text = "cue 1\nset s { control skin }\nicon a { cool by 2 °C at 1 °C/s; hold for 1 s }"
    ranking = rank(parse(text), Rig.load("fingertip"), people=1, parameters=0)
    said = ["no detection threshold is on record for the fingertip: those of the thenar are used"]
    assert list(ranking.icons[0].outside_data) == said
    assert ranking.to_dict()["icons"][0]["outside_data"] == said
