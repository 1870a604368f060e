from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer, perceive
from thermicon.perception.sensation.bench import Bench, curve, raised_cosine, ramp


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Bench(Rig.load("thenar"))


def test_a_ramp_is_played_held_and_returned(bench: Bench) -> None:
    played = bench.play([ramp("cold", 0.5, 1.0, 1.0, back=True), ramp("warm", 0.5, 0.5)], 3.0)
    skin = played.surface_C("skin")
    assert skin.shape == (2, 301)
    assert skin[0, [0, 50, 149, 250]] == pytest.approx([32.0, 31.5, 31.5, 32.0], abs=2e-3)
    assert skin[1, -1] == pytest.approx(32.5, abs=1e-3)
    assert (played.site, played.area_m2) == ("thenar", pytest.approx(9e-4))
    assert played.time_s[-1] == pytest.approx(3.0)
    assert played.received("heat flow", "cold").shape == (2, 301)


def test_what_is_felt_is_what_perceive_says(bench: Bench) -> None:
    person, played = Observer.load(), bench.play([ramp("cold", 0.5, 1.0, 1.0)], 2.0)
    cold, warm = played.felt(person)
    percept = perceive(played.traces[0], person)
    assert cold[0, 0] == pytest.approx(percept.psi_cold)
    assert warm[0, 0] == pytest.approx(percept.psi_warm)
    dull = played.felt(person, [1.0, 2.0], [1.0, 1.0])[0]
    assert dull.shape == (2, 1, 201)
    assert dull[1].max() < dull[0].max()


def test_a_smooth_pulse_lies_on_its_curve() -> None:
    bench = Bench(Rig.load("thenar"), surface="display")
    played = bench.play([raised_cosine("warm", 3.0, 6.0)], 7.0)
    wanted = 32.0 + 1.5 * (1.0 - np.cos(2 * np.pi * np.minimum(played.time_s, 6.0) / 6.0))
    assert played.surface_C("display")[0] == pytest.approx(wanted, abs=5e-3)
    assert played.time_s[played.surface_C("display")[0].argmax()] == pytest.approx(3.0, abs=0.02)


def test_messages(bench: Bench) -> None:
    with pytest.raises(ValueError, match=r"a course of 3 s does not end by 2 s"):
        bench.play([ramp("cold", 1.0, 1.0, 2.0)], 2.0)
    assert curve(np.array([1.0, 1.0, 0.0]), 0.5) == "warm by 1 K over 0.5 s\nhold for 0.5 s\ncool by 1 K over 0.5 s"
    said = repr(bench.play([ramp("cold", 20.0, 20.0)], 2.0))
    assert said == "Stimulus(1 on thenar, 2 s, 1 not reached)"
    wrong: Any = "deep"
    with pytest.raises(ValueError, match=r"prescribed at skin or display, not at 'deep'"):
        Bench(bench.rig, surface=wrong)
