from dataclasses import replace
from typing import Any

import pytest

from thermicon.circuit import Rig
from thermicon.icons import parse
from thermicon.perception import rank
from thermicon.perception.observer.observer import load_thresholds
from thermicon.perception.sensation.coverage import load_coverage, outside_data, outside_site


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (-18.0, "the skin falls to 14 °C (6.0 s); data begin at 15 °C"),
        (14.0, "the skin rises to 46 °C (4.7 s); data end at 45 °C"),
        (-17.00001, "the skin falls to 14.99999 °C (5.7 s); data begin at 15 °C"),
    ],
)
def test_cold_and_hot(cue: Any, change: float, said: str) -> None:
    assert outside_data(cue(change=change)) == (said,)


def test_the_place_that_goes_furthest_is_named(cue: Any) -> None:
    trace = cue(change=-18.0)
    deeper = replace(trace, cold_receptor_C=trace.cold_receptor_C - 2.0)
    assert outside_data(deeper) == ("the cold receptor falls to 12 °C (6.0 s); data begin at 15 °C",)


def test_fast_changes(cue: Any) -> None:
    (said,) = outside_data(cue(change=-6.0, rate=12.0))
    assert said.startswith("the skin changes at 12 K/s (")
    assert said.endswith("; data end at 10 K/s")
    assert outside_data(cue(change=-6.0, rate=9.9)) == outside_data(cue(change=-6.0)) == ()


@pytest.mark.parametrize("site", ["thenar", "left thenar", "hand-dorsum", "Hand dorsum", "forearm", "wrist"])
def test_sites_with_data(site: str) -> None:
    assert outside_site(site) == ()


def test_counts_of_records_are_those_of_the_table() -> None:
    table = [r for r in load_thresholds() if r.quantity in ("detection threshold", "limits threshold")]
    sites = load_coverage().select("site")
    for record in sites:
        held = [r for r in table if r.site == record.get("recorded")]
        assert len(held) == record.value, record
        assert {r.source for r in held} == {record.source}
    assert {r.site for r in table} == {record.get("recorded") for record in sites}


def test_a_ranking_carries_it() -> None:
    text = "cue 1\nset s { control skin }\nicon a { cool by 2 °C at 1 °C/s; hold for 1 s }"
    ranking = rank(parse(text), Rig.load("fingertip"), people=1, parameters=0)
    said = ["no detection threshold is on record for the fingertip: those of the thenar are used"]
    assert list(ranking.icons[0].outside_data) == said
    assert ranking.to_dict()["icons"][0]["outside_data"] == said
