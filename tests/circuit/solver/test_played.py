"""An icon on several elements is each element's track on its rig, on one clock."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from thermicon.circuit import InputError, Layout, LayoutTrace, Rig, simulate
from thermicon.circuit.solver import simulate as module
from thermicon.icons import Icon, SpatialIcon, parse

DIP = "cool by 4 °C at 2 °C/s; return at 2 °C/s"
GLOW = "warm by 3 °C at 3 °C/s; hold for 2 s; return at 3 °C/s"


def spatial(body: str, elements: str = "left, right") -> SpatialIcon:
    (icon,) = parse(f"cue 1\nset {{ elements {elements}; baseline 32 °C }}\nicon x {{ {body} }}").spatial
    return icon


def test_each_hand_has_the_trace_of_its_rig_byte_for_byte() -> None:
    icon = spatial(f"together {{ on left {{ {DIP}; {GLOW} }}; on right {{ rest for 2 s; {GLOW}; {DIP} }} }}")
    run = simulate(icon, "wheel", rate_Hz=20.0, tail_s=1.0)
    for name in ("left", "right"):
        track = icon.tracks[name]
        alone = simulate(track, "thenar", rate_Hz=20.0, tail_s=icon.duration_s + 1 - track.corners().duration_s)
        pd.testing.assert_frame_equal(run.traces[name].to_frame(), alone.to_frame(), check_exact=True)


@pytest.mark.parametrize("away", ["cool by 10 K at 3 K/s; return at 7 K/s", "warm by 1 K at 3 K/s; return over 300 ms"])
def test_all_elements_have_one_clock_and_who_does_not_play_rests(away: str) -> None:
    run = simulate(spatial(f"on s2 {{ {away} }}; on s4 {{ {away} }}", "s2, s4"), "tcs2-strips")
    assert list(run.traces) == ["s1", "s2", "s3", "s4", "s5"]
    assert all(np.array_equal(trace.time_s, run.traces["s1"].time_s) for trace in run.traces.values())
    assert np.ptp(run.traces["s3"].display_C) == pytest.approx(0, abs=1e-9)
    assert np.ptp(run.traces["s2"].display_C) > 0.5


def test_elements_that_are_and_play_alike_are_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Icon] = []
    original = module._run
    monkeypatch.setattr(module, "_run", lambda *given: asked.append(given[4]) or original(*given))
    run = simulate(spatial(f"on all {{ {DIP} }}"), "wheel")
    assert len(asked) == 1
    assert run.traces["left"] is run.traces["right"]
    simulate(spatial(f"along all every 100 ms {{ {DIP} }}"), "wheel")
    assert len(asked) == 3


def test_other_names_and_another_order_play_the_same(tmp_path: Path) -> None:
    text = 'format = 1\nname = "w"\nsurfaces = "apart"\n[[element]]\nname = "b"\nrig = "thenar"\nplace_mm = [1, 0]\n'
    text += '[[element]]\nname = "a"\nlike = "b"\nplace_mm = [2, 0]\n'
    (tmp_path / "w.toml").write_text(text)
    body = f"on left {{ {DIP} }}; on right {{ {GLOW} }}"
    first = simulate(spatial(body), "wheel")
    second = simulate(spatial(body.replace("left", "a").replace("right", "b"), "a, b"), tmp_path / "w.toml")
    assert list(second.traces) == ["b", "a"]
    for one, other in (("left", "a"), ("right", "b")):
        assert np.array_equal(first.traces[one].skin_C, second.traces[other].skin_C)


def test_a_table_tells_the_elements_from_each_other(tmp_path: Path) -> None:
    run = simulate(spatial(f"on left {{ {DIP} }}"), "wheel", rate_Hz=10.0)
    run.to_csv(tmp_path / "run.csv")
    table = pd.read_csv(tmp_path / "run.csv")
    assert list(table.icon.unique()) == ["x on left", "x on right"]
    assert len(table) == len(run.to_frame()) == 2 * 41


def test_what_one_element_misses_the_whole_misses() -> None:
    fast = "cool by 12 °C at 20 °C/s; hold for 1 s; return at 20 °C/s"
    run = simulate(spatial(f"on left {{ {fast} }}; on right {{ {DIP} }}"), "wheel", rate_Hz=20.0)
    assert [trace.reachable for trace in run.traces.values()] == [False, True]
    assert not run.reachable
    assert repr(run).endswith("NOT reached)")


@pytest.mark.parametrize(
    ("on", "told"),
    [
        ("thenar", "and the rig thenar is one element: give a layout that has them, such as wheel"),
        (None, "play on left, right, and the rig thenar is one element"),
        (
            "ring-four",
            "ring-four has top, .*: give elements these names, or give a layout that has them, such as wheel",
        ),
        (Rig.load("forearm"), "the rig forearm is one element"),
    ],
)
def test_a_layout_without_the_elements_of_a_set_is_refused(on: str | Rig | None, told: str) -> None:
    with pytest.raises(InputError, match=told):
        simulate(spatial(f"on left {{ {DIP} }}"), on)  # type: ignore[arg-type]
    assert isinstance(simulate(spatial(f"on left {{ {DIP} }}"), Layout.load("wheel"), rate_Hz=5.0), LayoutTrace)
