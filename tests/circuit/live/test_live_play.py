"""Refusals and stops of live play."""

import json
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.live.thermostat import demands_of
from thermicon.base.files.atomic import OutputError
from thermicon.circuit import Export, Rig, export, play_live
from thermicon.circuit.live import play_live as module
from thermicon.circuit.live.controller import SimulatedController, settings_of
from thermicon.circuit.live.demanded import met_demands, refuse_missing, statements_of
from thermicon.circuit.live.play_live import SimulatedTime, play_export
from thermicon.circuit.live.ready import exported_before
from thermicon.circuit.play.watch import Refused
from thermicon.circuit.rig.rigfile import InputError
from thermicon.circuit.safety.demands import CutOff, HeldCutOff
from thermicon.icons import load_library

ICON = load_library("six-icons")["double-dip"]
Ready = Callable[[str, float], Export]


def controller(ready: Ready, **settings: Any) -> tuple[SimulatedController, SimulatedTime]:
    found, now = ready("readme", 100.0), SimulatedTime()
    return SimulatedController(found.rig, replace(settings_of(demands_of(found), 1.0), **settings), now), now


def test_the_simulated_controller_is_off_a_second_after_its_host_is_silent(ready: Ready) -> None:
    line, now = controller(ready)
    line.send(32.0)
    for _ in range(10):
        now.sleep(0.9)
        line.feed()
    line.read()  # nothing but a feed counts
    now.sleep(0.98)
    assert not line.status()["stopped"]
    now.sleep(0.05)
    with pytest.raises(RuntimeError, match="silent"):
        line.read()
    line.send(32.0)
    now.sleep(0.1)
    assert line.rows()[-1].current_A == 0.0


@pytest.mark.parametrize("low_C, high_C, is_cut", [(20.0, 38.0, True), (20.0, 41.2, False), (39.8, 41.2, True)])
def test_the_simulated_controller_has_a_cut_off(ready: Ready, low_C: float, high_C: float, is_cut: bool) -> None:
    """A display without power is at 39.15 °C."""
    line, now = controller(ready, cut_off_display_C=CutOff(low_C, high_C, 0.01))
    now.sleep(0.5)
    assert ("outside" in str(line.status()["stopped"])) == is_cut


@pytest.mark.parametrize("peak_A, limits_A", [(0.5, (-1.0, 1.0)), (1.2, (-1.0, 1.2)), (2.0, (-1.0, 1.5))])
def test_current_limits_are_alike_unless_icons_need_more(
    peak_A: float, limits_A: tuple[float, float], ready: Ready
) -> None:
    demands = replace(demands_of(ready("readme", 100.0)), current_limit_A=(-1.0, 1.5))
    assert settings_of(demands, peak_A).current_limit_A == limits_A


LAX: dict[str, tuple[str, Any]] = {
    "watchdog": ("watchdog_s", 61.0),
    "cut-off": ("cut_off_display_C", CutOff(23.4, 41.3, 0.01)),
    "second cut-off": ("held_cut_off_display_C", HeldCutOff(23.4, 39.5, 5.1)),
    "current limit": ("current_limit_A", (-1.1, 1.11)),
    "loop": ("loop", {"kp_A_per_K": (0.41, 0.41)}),
}


@pytest.mark.parametrize("label", LAX)
def test_a_device_that_is_set_too_lax_is_refused_unless_a_person_states_it(label: str, ready: Ready) -> None:
    status = dict(controller(ready)[0].status())
    demands, (key, value) = demands_of(ready("readme", 100.0)), LAX[label]
    refuse_missing(met_demands(demands, status, {}))
    status[key] = replace(demands.loop, **value) if isinstance(value, dict) else value  # type: ignore[type-var]
    with pytest.raises(Refused, match=label):
        refuse_missing(met_demands(demands, status, {}))
    rows = met_demands(demands, status, statements_of([f"{label}: a fuse, A. Name"]))
    assert [(row.label, row.by) for row in rows if row.how == "stated"] == [(label, "a fuse, A. Name")]


@pytest.mark.parametrize("text", ["nonsense", "fuse: of 1 A, A. Name", "loop: I know it", "loop: , A. Name"])
def test_a_statement_names_a_demand_and_a_person(text: str) -> None:
    with pytest.raises(InputError):
        statements_of([text])


@pytest.mark.parametrize("stop_s, has_begun, key", [(2.0, False, ""), (60.0, False, "Space"), (145.0, True, "")])
def test_a_person_stops_at_any_time(
    stop_s: float, has_begun: bool, key: str, tmp_path: Path, ready: Ready, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a key, or by Ctrl-C; the log is on the disk to its last second before, and then to its end."""
    now, folder, late_s = SimulatedTime(), tmp_path / "out", list[float]()
    monkeypatch.setattr(module, "SimulatedTime", lambda: now)

    def why() -> str:
        if now() < stop_s:
            return ""
        rows = (folder / "turn.log.csv").read_text().splitlines()
        late_s.append(now() - float(rows[-2].split(",")[1]))
        if key:
            return key
        raise KeyboardInterrupt

    result = play_export(ready("readme", 100.0), ["turn", "arrived"], folder=folder, why_stop=why)
    assert late_s[0] < 1.1
    assert result.stopped == (key or "Ctrl-C")
    (play,) = result.plays
    assert not play.ended
    assert np.isfinite(play.rms_K) == has_begun
    assert ("not begun" in repr(result)) == (not has_begun) and "nan" not in repr(result)
    rows = (folder / play.files[0]).read_text().splitlines()
    assert float(rows[-1].split(",")[1]) == pytest.approx(stop_s, abs=0.05)
    assert float(rows[-1].split(",")[7]) == 0.0
    assert json.loads((folder / play.files[2]).read_text())["stopped"] == result.stopped


def test_simulated_time_waits_for_a_computer_that_is_busy(ready: Ready, monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads that read sensors get their turn late: a hundred ticks of simulated time are over sooner."""
    read, told = SimulatedController.read_second, list[str]()

    def late(line: SimulatedController) -> float:
        time.sleep(0.005 if "plays arrived" in told else 0.0)
        return read(line)

    monkeypatch.setattr(SimulatedController, "read_second", late)
    result = play_export(ready("readme", 10.0), ["arrived", "low-battery"], pause_s=5.0, tell=told.append)
    assert not result.stopped
    assert [play.ended for play in result.plays] == [True, True]


def test_folders_play_as_the_icons_do_unless_they_are_others(tmp_path: Path) -> None:
    for form in ("setpoint-csv", "c-array"):
        export(ICON, "thenar", "closed-loop-controller", form, folder=tmp_path / form)
        made = exported_before(tmp_path / form, Rig.load("thenar"), None)
        assert [each.delivery.icon.name for each in made.prepared] == ["double-dip"]
    with pytest.raises(InputError, match="another rig thenar than forearm"):
        exported_before(tmp_path / "c-array", Rig.load("forearm"), None)
    export(ICON, "thenar", "closed-loop-controller", "setpoint-csv", tail_s=1.0, folder=tmp_path / "other")
    with pytest.raises(InputError, match="export again"):
        exported_before(tmp_path / "other", None, None)
    export(ICON, "thenar", "dac-16", folder=tmp_path / "open")
    with pytest.raises(InputError, match="takes no set-points"):
        exported_before(tmp_path / "open", None, None)


def test_bad_input_puts_nothing_out(tmp_path: Path, ready: Ready) -> None:
    with pytest.raises(InputError, match="thermode"):
        play_live(ICON, "tcs2")
    with pytest.raises(InputError, match="not among"):
        play_export(ready("readme", 100.0), ["trun"])
    (tmp_path / "kept.txt").write_text("")
    with pytest.raises(OutputError):
        play_export(ready("readme", 100.0), ["turn"], folder=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["kept.txt"]
    with pytest.raises((Refused, InputError)):
        play_live(ICON, Rig.load("thenar").with_(safety={"display_lowest_C": 31.0, "reason": "a test"}))
