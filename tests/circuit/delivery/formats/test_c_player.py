"""The microcontroller player, compiled by the system's C compiler, on a simulated plate."""

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import LOOP, MADE_UP, GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]
CFLAGS = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"]

OK, NO_SENSOR, NOT_RESTED, NO_CLOCK = 0, 1, 2, 6
PLAYING, STOPPED, NO_FAULT = 2, 3, 0
LATE, LOST, FROZEN, STANDS = 3, 4, 5, 9


def build(folder: Path, device: str, compiler: str, **demands: Any) -> Path:
    form = load_format("c-array")
    verdict = type("Verdict", (GreenVerdict,), {"demands": replace(MADE_UP, **demands)})
    files = pack([prepare(ICON, RIG, Device.load(device), form, gate=verdict)], form)
    assert set(files) == {"double_dip.h", "double_dip.json", "thermicon_player.h"}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    # Under a drive in volts the rest is not zero: the plate's own rest is where its command holds 32.
    shift, gain = ("0.0", "2.0") if device == "closed-loop-controller" else ("(0.824 * 2.5)", "0.5")
    shutil.copy(Path(__file__).with_name("player_main.c"), folder / "main.c")
    program = folder / "player"
    subprocess.run(
        [compiler, *CFLAGS, f"-DSHIFT={shift}", f"-DGAIN={gain}", "main.c", "-o", str(program), "-lm"],
        cwd=folder, check=True,
    )  # fmt: skip
    return program


def run(program: Path, **scenario: float) -> dict[str, Any]:
    """What became of a scenario; its names are those of `player_main.c`."""
    text = " ".join(f"{name} {value!r}" for name, value in scenario.items())
    words = subprocess.run([str(program)], input=text, capture_output=True, text=True, check=True).stdout.split()
    return {name: float(value) for name, value in zip(words[::2], words[1::2], strict=True)}


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]) -> Path:
    return build(tmp_path_factory.mktemp("loop"), "closed-loop-controller", tool("cc"), loop=LOOP)


@pytest.fixture(scope="module")
def volts(tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]) -> Path:
    return build(tmp_path_factory.mktemp("volts"), "dac-12", tool("cc"))


def test_a_loop_tests_rests_plays_and_keeps_the_pause(loop: Path) -> None:
    told = run(loop)
    assert (told["begun"], told["first"]) == (OK, NOT_RESTED)
    assert told["began"] == pytest.approx(30.5, abs=0.05), "0.5 s of test, 30 s of rest"
    assert told["ended"] - told["began"] == pytest.approx(8.01, abs=0.03)
    assert (told["plays"], told["fault"], told["wrong"]) == (2, NO_FAULT, 0)
    assert told["paused"] == pytest.approx(20.0, abs=0.03) and told["paused"] >= 20.0
    assert told["coldest"] == pytest.approx(29.0, abs=0.15), "the plate follows the set-points"
    assert told["largest"] <= 1.5


def test_open_loop_puts_out_the_codes_with_the_same_guards(volts: Path) -> None:
    told = run(volts)
    assert (told["plays"], told["fault"], told["wrong"]) == (2, NO_FAULT, 0)
    assert told["paused"] >= 20.0
    assert told["largest"] > 1.0


STORIES: dict[str, tuple[int, dict[str, float]]] = {
    "abort": (1, {"abort_at": 3600}),
    "hang": (2, {"mute_at": 3600}),
    "late": (3, {"late_at": 3600, "late_us": 3e5}),
    "lost": (4, {"bad_at": 3600, "kind": 1}),
    "no number": (4, {"bad_at": 3600, "kind": 3}),
    "frozen": (5, {"bad_at": 3060, "kind": 2}),
    "runaway": (6, {"drift_at": 3600, "drift_mK": -200}),
    "hot": (7, {"drift_at": 3600, "drift_mK": 200}),
    "swapped": (8, {"swapped": 1}),
    "clock stands": (9, {"stand_at": 3600}),
    "clock goes back": (3, {"back_at": 3600, "back_us": 1e6}),
    "second sensor lost": (4, {"bad_at": 3600, "kind": 1, "which": 2}),
    "second sensor frozen": (5, {"bad_at": 3060, "kind": 2, "which": 2}),
    "second sensor beyond the cut-off": (7, {"bad_at": 3600, "kind": 4, "which": 2}),
}


@pytest.mark.parametrize("kind", ["loop", "volts"])
@pytest.mark.parametrize("story", STORIES)
def test_what_goes_wrong_ends_at_zero_for_good(kind: str, story: str, request: pytest.FixtureRequest) -> None:
    """The faults stand in the order of the player's own list."""
    fault, scenario = STORIES[story]
    told = run(request.getfixturevalue(kind), **scenario)
    assert (told["state"], told["fault"], told["out"]) == (STOPPED, fault, 0.0)
    assert told["plays"] == (0 if story == "swapped" else 1)
    assert told["wrong"] == 0 or story == "clock stands"
    assert told["wrong"] < 1.0, "a clock that stands is noticed in 100 steps"


@pytest.mark.parametrize(("sensors", "answer"), [(0, NO_SENSOR), (1, NO_SENSOR), (2, NO_SENSOR), (3, OK)])
def test_a_loop_needs_its_sensor_and_a_second_one(loop: Path, sensors: int, answer: int) -> None:
    told = run(loop, sensors=sensors)
    assert (told["begun"], told["plays"] > 0) == (answer, answer == OK)
    assert answer == OK or (told["state"], told["out"]) == (STOPPED, 0.0)


def test_an_open_loop_without_a_sensor_keeps_rest_pause_and_watchdog(volts: Path) -> None:
    told = run(volts, sensors=0)
    assert (told["plays"], told["fault"]) == (2, NO_FAULT)
    assert told["began"] == pytest.approx(30.0, abs=0.03), "no polarity can be tested"


def test_a_board_without_a_clock_is_refused(volts: Path) -> None:
    """As one that was written when a step was told how long it took."""
    told = run(volts, old=1)
    assert (told["begun"], told["state"], told["out"], told["plays"]) == (NO_CLOCK, STOPPED, 0.0, 0)


@pytest.mark.parametrize(
    "clock",
    [{"start_us": 2**32 - 33e6}, {"tick_us": 16_000}, {"tick_us": 1000, "dt_us": 50, "turns": 900_000}],
    ids=["wraps", "is coarse", "is coarser than the loop is quick"],
)
def test_a_clock_that_wraps_or_is_coarse_plays_the_same(volts: Path, clock: dict[str, float]) -> None:
    told = run(volts, **clock)
    assert (told["fault"], told["wrong"]) == (NO_FAULT, 0)
    assert told["began"] == pytest.approx(30.5, abs=0.07) and told["waited"] >= 30.5 - 0.016
    assert told["ended"] - told["began"] == pytest.approx(8.01, abs=0.04)


def test_a_step_may_leave_out_no_code(volts: Path) -> None:
    """A code lasts 10 ms: steps of 19 ms are those of a loop that is busy, steps of 21 ms sample the drive."""
    assert run(volts, late_at=3500, late_us=9000)["fault"] == NO_FAULT
    assert run(volts, late_at=3500, late_us=11000)["fault"] == LATE
    assert run(volts, dt_us=25000)["fault"] == LATE
    assert run(volts, late_at=1000, late_us=80000)["fault"] == NO_FAULT, "while the rest is held, within REACT_S"


def test_a_long_pause_keeps_its_length_in_a_quick_loop(tmp_path: Path, tool: Callable[[str], str]) -> None:
    """A sum of steps in 32 bits would lose them: 600 s would be 546 s."""
    slow = build(tmp_path, "dac-12", tool("cc"), rest_before_first_play_s=600.0, polarity_check=None)
    told = run(slow, dt_us=50, turns=12_400_000)
    assert told["waited"] == pytest.approx(600.0, abs=1e-3) and told["waited"] >= 600.0


def test_after_a_restart_the_pause_is_held_too(tmp_path: Path, tool: Callable[[str], str]) -> None:
    """The board may have been restarted in a play, after an abort, or between plays; before the first play too."""
    waits = {"rest_before_first_play_s": 2.0, "pause_at_least_s": 20.5, "polarity_check": None}
    quick = build(tmp_path, "dac-12", tool("cc"), **waits)
    for event in ({"begin_at": 2400}, {"abort_at": 2400, "begin_at": 2450}, {"begin_at": 3100}, {}):
        told = run(quick, turns=5500, **event)
        assert told["plays"] == (1 if event else 2)
        assert told["waited"] == pytest.approx(20.5, abs=0.03) and told["waited"] >= 20.5


def test_without_any_safe_hang_the_cut_off_protects(tmp_path: Path, tool: Callable[[str], str]) -> None:
    """A watchdog of 0: without a sensor nothing would be guarded, and with it the player still plays."""
    none = build(tmp_path, "dac-12", tool("cc"), watchdog_s=0.0)
    assert run(none, sensors=0)["begun"] == NO_SENSOR
    assert (run(none)["plays"], run(none)["fault"]) == (2, NO_FAULT)
    told = run(none, mute_at=3600)
    assert (told["fault"], told["stopped"]) == (2, pytest.approx(36.1, abs=0.03)), "the host has 0.1 s, as the cut-off"


@pytest.mark.parametrize("step_mK", [50, 100])
def test_a_sensor_of_tenths_is_not_called_frozen(volts: Path, loop: Path, step_mK: float) -> None:
    """It reads the same for the whole rest and pause, and after the pause what it read at the end of the play."""
    for program in (volts, loop):
        told = run(program, step_mK=step_mK, turns=12000)
        assert (told["plays"], told["fault"]) == (4, NO_FAULT)


def test_a_sensor_that_froze_in_the_rest_is_noticed_a_second_after_the_display_has_moved(volts: Path) -> None:
    told = run(volts, bad_at=2000, kind=2)
    assert told["fault"] == FROZEN
    assert 1.0 < told["stopped"] - told["began"] < 1.6


def test_set_points_are_centi_degrees(loop: Path) -> None:
    header = (loop.parent / "double_dip.h").read_text()
    assert "static const float double_dip_step = 0.01f;" in header
    assert int(header.split("{")[1].split(",")[0]) == 3200
    player = (loop.parent / "thermicon_player.h").read_text()
    assert "#define THERMICON_WATCHDOG_S 0.39999998f" in player, "0.4 in 32 bits is longer"
    assert "@" not in player


def test_steps_finer_than_centi_degrees_are_refused() -> None:
    form, device = load_format("c-array"), Device.load("closed-loop-controller")
    fine = replace(device, records=tuple(r for r in device.records if r.quantity != "set-point step"))
    with pytest.raises(FormatError, match=r"hundredths of a degree; closed-loop-controller has steps of 0\.001 K"):
        pack([prepare(ICON, RIG, fine, form, gate=GreenVerdict)], form)
