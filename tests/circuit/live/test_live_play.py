"""Refusals and stops of live play."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.live.thermostat import Thermostat, played
from thermicon.base.files.atomic import OutputError
from thermicon.circuit import Rig, export, play_live
from thermicon.circuit.live import play_log
from thermicon.circuit.live.controller import ControllerSettings, SimulatedController
from thermicon.circuit.live.demanded import met_demands, refuse_missing, statements_of
from thermicon.circuit.live.live_player import LivePlayer, play_in_order
from thermicon.circuit.live.play_live import SimulatedTime, live_numbers, play_ready
from thermicon.circuit.live.play_log import PlayLog
from thermicon.circuit.live.ready import ReadySet, exported_before
from thermicon.circuit.play import watch
from thermicon.circuit.play.watch import Refused
from thermicon.circuit.rig.rigfile import InputError
from thermicon.circuit.safety.demands import CutOff
from thermicon.icons import load_library

ICON = load_library("six-icons")["double-dip"]
Ready = Callable[[str, float], ReadySet]


def controller(ready: Ready, **settings: Any) -> tuple[SimulatedController, SimulatedTime]:
    found, now = ready("readme", 100.0), SimulatedTime()
    return SimulatedController(found.rig, replace(ControllerSettings.of(found.demands, 1.0), **settings), now), now


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
    assert "silent" in str(line.status()["stopped"])
    with pytest.raises(RuntimeError, match="silent"):
        line.read()
    line.send(32.0)
    now.sleep(0.1)
    assert line.rows()[-1].current_A == 0.0


@pytest.mark.parametrize("low_C, high_C, is_cut", [(20.0, 38.0, True), (20.0, 41.2, False), (39.8, 41.2, True)])
def test_the_simulated_controller_has_a_cut_off(ready: Ready, low_C: float, high_C: float, is_cut: bool) -> None:
    """A display without power is at 39.15 °C."""
    line, now = controller(ready, cut=CutOff(low_C, high_C, 0.01))
    now.sleep(0.5)
    assert ("outside" in str(line.status()["stopped"])) == is_cut


def test_current_limits_are_alike_for_both_signs_unless_icons_need_more(ready: Ready) -> None:
    demands = replace(ready("readme", 100.0).demands, current_limit_A=(-1.0, 1.5))
    assert [ControllerSettings.of(demands, peak_A).limits_A for peak_A in (0.5, 1.2, 2.0)] == [
        (-1.0, 1.0), (-1.0, 1.2), (-1.0, 1.5),
    ]  # fmt: skip


LAX: dict[str, tuple[str, Any]] = {
    "watchdog": ("watchdog_s", 61.0),
    "cut-off": ("cut_off_display_C", (23.4, 41.3, 0.01)),
    "second cut-off": ("held_cut_off_display_C", (23.4, 39.5, 5.1)),
    "current limit": ("current_limit_A", (-1.1, 1.11)),
    "loop": ("loop", (0.41, 0.098, 0.0, 0.1, 0.01)),
}


@pytest.mark.parametrize("label", LAX)
def test_a_device_that_is_set_too_lax_is_refused_unless_a_person_states_it(label: str, ready: Ready) -> None:
    line, _ = controller(ready)
    demands, (key, value) = ready("readme", 100.0).demands, LAX[label]
    rows = met_demands(demands, {**line.status(), key: value}, {})
    assert [row.label for row in rows if row.how == "missing"] == [label]
    with pytest.raises(Refused, match=label):
        refuse_missing(rows)
    said = statements_of([f"{label}: a fuse, A. Name"])
    (stated,) = [row for row in met_demands(demands, {**line.status(), key: value}, said) if row.how == "stated"]
    assert stated.by == "a fuse, A. Name"
    refuse_missing(met_demands(demands, line.status(), {}))


@pytest.mark.parametrize("text", ["nonsense", "fuse: of 1 A, A. Name", "loop: I know it", "loop: , A. Name"])
def test_a_statement_names_a_demand_and_a_person(text: str) -> None:
    with pytest.raises(InputError):
        statements_of([text])


def test_a_device_without_a_watchdog_is_refused_before_it_rests(ready: Ready, monkeypatch: pytest.MonkeyPatch) -> None:
    found = ready("readme", 100.0)
    device = Thermostat(found.rig, found.demands, np.random.default_rng(0), world=0)
    monkeypatch.setattr(device, "cut", lambda why: None)
    with pytest.raises(Refused, match="silence"):
        played(device, found, [found.drives["turn"]])
    assert device.goal_C is None
    assert device.current_A == 0.0
    assert device.now_s < 7.0


def test_without_its_stop_a_sensor_that_lies_is_played_on_with(ready: Ready, monkeypatch: pytest.MonkeyPatch) -> None:
    found, late = ready("readme", 100.0), []
    for most_K in (watch.APART_K, np.inf):
        monkeypatch.setattr(watch, "APART_K", most_K)
        monkeypatch.setattr(watch, "BESIDE_K", 10.0)
        device = Thermostat(found.rig, found.demands, np.random.default_rng(0), world=0)
        device.at(40.0, lambda device=device: device.break_by("second off", 3.0, 0.0))  # type: ignore[misc]
        played(device, found, [found.drives["turn"]], 20.0)
        late.append(device.off_at_s - 40.0)
    assert late[0] < 0.6
    assert late[1] > 5.0


@pytest.mark.parametrize("stop_s, has_begun", [(2.0, False), (60.0, False), (145.0, True)])
def test_a_person_stops_at_any_time(stop_s: float, has_begun: bool, tmp_path: Path, ready: Ready) -> None:
    found, now = ready("readme", 100.0), SimulatedTime()
    why = lambda: "Space was pressed" if now() >= stop_s else ""  # noqa: E731
    result = play_ready(found, ["turn", "arrived"], now, now.sleep, folder=tmp_path / "out", why_stop=why)
    assert result.stopped == "Space was pressed"
    (play,) = result.plays
    assert not play.ended
    assert np.isfinite(play.rms_K) == has_begun
    rows = (tmp_path / "out" / play.files[0]).read_text().splitlines()
    assert float(rows[-1].split(",")[1]) == pytest.approx(stop_s, abs=0.05), "the log is complete"
    assert float(rows[-1].split(",")[7]) == 0.0
    assert json.loads((tmp_path / "out" / play.files[2]).read_text())["stopped"] == "Space was pressed"


def test_ctrl_c_is_a_stop_with_a_log(tmp_path: Path, ready: Ready) -> None:
    found, now = ready("readme", 100.0), SimulatedTime()

    def why() -> str:
        if now() >= 30.0:
            raise KeyboardInterrupt
        return ""

    result = play_ready(found, ["turn"], now, now.sleep, folder=tmp_path / "out", why_stop=why)
    assert result.stopped == "Ctrl-C"
    assert (tmp_path / "out" / "turn.log.json").exists()


@pytest.mark.parametrize(
    "late_s, protects, is_stopped", [(0.15, False, False), (0.3, False, True), (0.6, True, False), (1.1, True, True)]
)
def test_how_late_this_computer_may_be(late_s: float, protects: bool, is_stopped: bool, ready: Ready) -> None:
    """As late as the cut-off may react, where the guard has to act; else as the watchdog allows."""
    found = ready("readme", 100.0)
    device = Thermostat(found.rig, found.demands, np.random.default_rng(0), world=0)
    device.at(40.0, lambda: setattr(device, "hangs_s", late_s))
    numbers = live_numbers(found.demands, protects)._replace(rest_s=20.0)
    player = LivePlayer(device, numbers, PlayLog(None, {}), device.clock, device.sleep)
    assert bool(play_in_order(player, [found.drives["turn"]], 0.0, dict)[1]) == is_stopped


def test_a_log_is_on_the_disk_while_it_is_written(tmp_path: Path, ready: Ready) -> None:
    found, now, seen = ready("readme", 100.0), SimulatedTime(), list[float]()

    def why() -> str:
        if now() > 50.0:
            rows = (tmp_path / "out" / "turn.log.csv").read_text().splitlines()
            seen.append(now() - float(rows[-2].split(",")[1]))
            return "enough"
        return ""

    play_ready(found, ["turn"], now, now.sleep, folder=tmp_path / "out", why_stop=why)
    assert seen[0] < 1.1


def test_nothing_that_takes_long_is_written_while_the_output_is_on(
    tmp_path: Path, ready: Ready, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two plays in a row: the device waits for its host for a second."""
    found = ready("readme", 100.0)
    device = Thermostat(found.rig, found.demands, np.random.default_rng(0), world=0)
    written = []
    monkeypatch.setattr(play_log, "write_trace", lambda *given: written.append(device.goal_C))
    player = LivePlayer(device, live_numbers(found.demands, True), PlayLog(tmp_path, {}), device.clock, device.sleep)
    play_in_order(player, [found.drives["turn"]] * 2, 1.0, dict)
    assert written == [None, None]


def test_a_folder_plays_as_the_icons_do(tmp_path: Path) -> None:
    for form in ("setpoint-csv", "c-array"):
        export(ICON, "thenar", "closed-loop-controller", form, folder=tmp_path / form)
        ready = ReadySet.of(exported_before(tmp_path / form, Rig.load("thenar"), None, None))
        assert list(ready.drives) == ["double-dip"]


def test_folders_that_are_refused(tmp_path: Path) -> None:
    export(ICON, "thenar", "closed-loop-controller", "setpoint-csv", folder=tmp_path / "drives")
    with pytest.raises(InputError, match="another rig thenar than forearm"):
        exported_before(tmp_path / "drives", Rig.load("forearm"), None, None)
    export(ICON, "thenar", "closed-loop-controller", "setpoint-csv", tail_s=1.0, folder=tmp_path / "other")
    with pytest.raises(InputError, match="export again"):
        exported_before(tmp_path / "other", None, None, None)
    export(ICON, "thenar", "dac-16", folder=tmp_path / "open")
    with pytest.raises(InputError, match="takes no set-points"):
        exported_before(tmp_path / "open", None, None, None)
    drive = tmp_path / "drives" / "double-dip.csv"
    drive.write_text(drive.read_text().replace("32.", "33.", 1))
    with pytest.raises(InputError, match="digest differs"):
        exported_before(tmp_path / "drives", None, None, None)


def test_bad_input_puts_nothing_out(tmp_path: Path, ready: Ready) -> None:
    with pytest.raises(InputError, match="thermode"):
        play_live(ICON, "tcs2")
    now = SimulatedTime()
    with pytest.raises(InputError, match="not among"):
        play_ready(ready("readme", 100.0), ["trun"], now, now.sleep)
    (tmp_path / "kept.txt").write_text("")
    with pytest.raises(OutputError, match="never overwritten"):
        play_ready(ready("readme", 100.0), ["turn"], now, now.sleep, folder=tmp_path)
    assert now() == 0.0
    hot = load_library("six-icons")["double-dip"]
    with pytest.raises((Refused, InputError)):
        play_live(hot, Rig.load("thenar").with_(safety={"display_lowest_C": 31.0, "reason": "a test"}))
