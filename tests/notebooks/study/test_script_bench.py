"""The display of a study's script on simulated hardware: play without blocking, guards, stops."""

import importlib
import sys
import time
import types
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.daq import Daq

from .conftest import rows_of


def bench_of(quick: Path, monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    """The module of the study's folder that plays and waits."""
    monkeypatch.syspath_prepend(str(quick))
    monkeypatch.delitem(sys.modules, "study_bench", raising=False)
    return importlib.import_module("study_bench")


@pytest.fixture
def display(quick: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    device = Daq(time.monotonic)
    monkeypatch.setitem(sys.modules, "nidaqmx", device)
    monkeypatch.setitem(sys.modules, "nidaqmx.constants", device)
    made = bench_of(quick, monkeypatch).Display("ni", channel="Dev7/ao1")
    made.player.REST_S = made.player.PAUSE_S = 0.0
    made.device = device
    return made


def test_a_play_does_not_block_and_abort_switches_off(display: Any, quick: Path) -> None:
    """In real time, with threads."""
    assert display.player.CHANNEL == "Dev7/ao1"
    begun = time.monotonic()
    display.play(str(quick / "dip.csv"))
    assert time.monotonic() - begun < 0.5, "the call returned while the icon plays"
    while not any(isinstance(each, list) for each in display.device.out):
        assert time.monotonic() - begun < 2.0
        time.sleep(0.01)
    assert display.busy
    display.abort()
    assert time.monotonic() - begun < 2.0
    assert display.device.out[-1] == 0.0
    with pytest.raises(RuntimeError, match=r"abort\(\) was called"):
        _ = display.busy


def test_the_guard_stops_a_display_that_is_too_warm(display: Any, quick: Path) -> None:
    """The cut-off of the exported player acts in a study too."""
    readings = iter([32.0 + 0.001 * k for k in range(10)] + [60.0 + 0.001 * k for k in range(1000)])
    display.measured_C = lambda: next(readings)
    display.player.TEST_POLARITY = False
    display.play(str(quick / "dip.csv"))
    begun = time.monotonic()
    with pytest.raises(RuntimeError, match=r"the display is at 60\.\d\d degrees C, outside"):
        while time.monotonic() < begun + 3.0 and display.busy:
            time.sleep(0.01)
    assert display.device.out[-1] == 0.0


def test_a_pause_that_is_too_short_is_refused_by_the_player(display: Any, quick: Path) -> None:
    display.play(str(quick / "dip.csv"))
    display._thread.join()
    display.player.PAUSE_S = 5.0
    display.play(str(quick / "dip.csv"))
    display._thread.join()
    with pytest.raises(RuntimeError, match=r"the pause of 5 s between plays is not over"):
        _ = display.busy


def test_the_rest_is_held_before_the_first_play(display: Any, quick: Path) -> None:
    first = float(rows_of(quick / "dip.csv")[0]["command_V"])
    display.player.REST_S, begun = 0.05, time.monotonic()
    display.rest(str(quick / "dip.csv"))
    display._thread.join()
    assert display.device.out == [first]
    display.play(str(quick / "dip.csv"))
    assert time.monotonic() - begun > 0.05


def test_other_devices_have_their_functions(quick: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bench = bench_of(quick, monkeypatch)
    with pytest.raises(SystemExit, match=r"needs --bench FILE\.py with the functions send\(display_C\) and off\(\)"):
        bench.Display("send")
    done: list[object] = []
    own = types.SimpleNamespace(send=lambda _: None, off=lambda: done.append("off"))
    bench.Display("send", own).abort()
    thermode = bench.Display.__new__(bench.Display)
    thermode.player, thermode.plays, thermode._thread = types.SimpleNamespace(abort=lambda: None), "tcs2", None
    thermode.port = types.SimpleNamespace(write=done.append)
    thermode.abort()
    assert done == ["off", b"A"]
