"""The player for microcontrollers, compiled by the system's C compiler and run against a simulated plate."""

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]
CFLAGS = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"]

OK, NO_SENSOR, NOT_RESTED, TOO_SOON = 0, 1, 2, 3
PLAYING, STOPPED, NO_FAULT = 2, 3, 0


def build(folder: Path, device: str, compiler: str) -> Path:
    form = load_format("c-array")
    files = pack([prepare(ICON, RIG, Device.load(device), form, gate=GreenVerdict)], form)
    assert set(files) == {"double_dip.h", "double_dip.json", "thermicon_player.h"}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    # Under a drive in volts the rest is not zero: the plate's own rest is where its command holds 32.
    shift, gain = ("0.0f", "2.0f") if device == "closed-loop-controller" else ("(0.824f * 2.5f)", "0.5f")
    shutil.copy(Path(__file__).with_name("player_main.c"), folder / "main.c")
    program = folder / "player"
    subprocess.run(
        [compiler, *CFLAGS, f"-DSHIFT={shift}", f"-DGAIN={gain}", "main.c", "-o", str(program), "-lm"],
        cwd=folder, check=True,
    )  # fmt: skip
    return program


def run(program: Path, story: str) -> dict[str, Any]:
    words = subprocess.run([str(program), story], capture_output=True, text=True, check=True).stdout.split()
    return {name: float(value) for name, value in zip(words[::2], words[1::2], strict=True)}


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]) -> Path:
    return build(tmp_path_factory.mktemp("loop"), "closed-loop-controller", tool("cc"))


@pytest.fixture(scope="module")
def volts(tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]) -> Path:
    return build(tmp_path_factory.mktemp("volts"), "dac-12", tool("cc"))


def test_a_loop_tests_rests_plays_and_keeps_the_pause(loop: Path) -> None:
    told = run(loop, "normal")
    assert (told["begun"], told["first"]) == (OK, NOT_RESTED)
    assert told["began"] == pytest.approx(3050, abs=5), "0.5 s of test, 30 s of rest"
    assert told["ended"] - told["began"] == pytest.approx(801, abs=3)
    assert (told["early"], told["again"], told["plays"]) == (TOO_SOON, TOO_SOON, 2)
    assert (told["state"], told["fault"]) == (PLAYING, NO_FAULT)
    assert told["coldest"] == pytest.approx(29.0, abs=0.15), "the plate follows the set-points"
    assert told["largest"] <= 1.5


def test_open_loop_puts_out_the_codes_with_the_same_guards(volts: Path) -> None:
    told = run(volts, "normal")
    assert (told["plays"], told["early"], told["fault"]) == (2, TOO_SOON, NO_FAULT)
    assert told["largest"] > 1.0


@pytest.mark.parametrize("kind", ["loop", "volts"])
@pytest.mark.parametrize(
    ("fault", "story"), [*enumerate(("abort", "hang", "late", "lost", "frozen", "runaway", "hot", "swapped"), 1)]
)
def test_what_goes_wrong_ends_at_zero_for_good(
    kind: str, fault: int, story: str, request: pytest.FixtureRequest
) -> None:
    """The faults stand in the order of the player's own list."""
    told = run(request.getfixturevalue(kind), story)
    assert (told["state"], told["fault"], told["out"]) == (STOPPED, fault, 0.0)
    assert told["plays"] == (0 if story == "swapped" else 1)


def test_a_loop_without_a_sensor_does_not_begin(loop: Path) -> None:
    told = run(loop, "no-sensor")
    assert (told["begun"], told["state"], told["out"], told["plays"]) == (NO_SENSOR, STOPPED, 0.0, 0)


def test_an_open_loop_without_a_sensor_keeps_rest_pause_and_watchdog(volts: Path) -> None:
    told = run(volts, "no-sensor")
    assert (told["plays"], told["early"], told["fault"]) == (2, TOO_SOON, NO_FAULT)
    assert told["began"] == pytest.approx(3000, abs=3), "no polarity can be tested"


def test_set_points_are_centi_degrees(loop: Path) -> None:
    header = (loop.parent / "double_dip.h").read_text()
    assert "static const float double_dip_step = 0.01f;" in header
    assert int(header.split("{")[1].split(",")[0]) == 3200
    player = (loop.parent / "thermicon_player.h").read_text()
    assert "#define THERMICON_WATCHDOG_S 0.4f" in player
    assert "@" not in player


def test_steps_finer_than_centi_degrees_are_refused() -> None:
    form, device = load_format("c-array"), Device.load("closed-loop-controller")
    fine = replace(device, records=tuple(r for r in device.records if r.quantity != "set-point step"))
    with pytest.raises(FormatError, match=r"hundredths of a degree; closed-loop-controller has steps of 0\.001 K"):
        pack([prepare(ICON, RIG, fine, form, gate=GreenVerdict)], form)
