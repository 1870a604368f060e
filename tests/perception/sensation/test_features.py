"""Numbers of a trace are computed once, and forgotten with it."""

import gc
from weakref import ref

import pytest

from thermicon.perception.sensation.features import excursion_K, of_each_trace

from ..conftest import Cue, FakeTrace


def test_a_number_is_kept_as_long_as_its_trace(cue: Cue) -> None:
    asked: list[tuple[str | None, str]] = []

    @of_each_trace
    def number(trace: FakeTrace, channel: str) -> float:
        asked.append((trace.icon, channel))
        return 1.0

    one, two = cue(change=-4.0, name="one"), cue(change=-2.0, name="two")
    for trace in (one, two, one, two):
        for channel in ("cold", "warm"):
            number(trace, channel)
    assert asked == [("one", "cold"), ("one", "warm"), ("two", "cold"), ("two", "warm")]
    gone = ref(one)
    del one, trace
    gc.collect()
    assert gone() is None


def test_traces_alike_in_name_are_different_traces(cue: Cue) -> None:
    assert excursion_K(cue(change=-4.0, name="a"), "cold") == pytest.approx(-4.0, abs=0.1)
    assert excursion_K(cue(change=-2.0, name="a"), "cold") == pytest.approx(-2.0, abs=0.1)
