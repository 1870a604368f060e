"""The player for microcontrollers, compiled by the system's C compiler and run against a simulated plate."""

from __future__ import annotations

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

MAIN = """
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "double_dip.h"
#include "thermicon_player.h"

/* A plate of one heat capacity: a command above 0 cools it, and the room and a standing flow hold it near 32. */
typedef struct { float temperature_C, out, sign, gain, noise; int lost, frozen; float stuck_C; } plate;

static int measure(void *context, float *display_C) {
    plate *p = context;
    p->noise = -p->noise;
    if (p->lost) return 0;
    *display_C = p->frozen ? p->stuck_C : p->temperature_C + p->noise;
    return 1;
}

static void put_out(void *context, float command) { ((plate *)context)->out = command; }

static void go_on(plate *p, float dt) {
    p->temperature_C += dt * (-p->sign * p->gain * p->out + 0.2f * (32.0f + SHIFT - p->temperature_C));
}

int main(int argc, char **argv) {
    const char *story = argc > 1 ? argv[1] : "normal";
    plate p = {32.0f, 0.0f, 1.0f, GAIN, 0.002f, 0, 0, 0.0f};
    thermicon_board board = {measure, put_out, &p, 3.0f, 2.0f, 0.02f, -1.5f, 1.5f};
    thermicon_player player;
    thermicon_icon icon = THERMICON_ICON(double_dip);
    float dt = 0.01f, coldest = 99.0f, first_try = -1.0f, plays = 0.0f, largest_out = 0.0f;
    long turn, plays_began = -1, ended = -1;
    int answer = -1, early = -1, begun;
    if (!strcmp(story, "swapped")) p.sign = -1.0f;
    if (!strcmp(story, "no-sensor")) board.measure = NULL;
    begun = thermicon_begin(&player, &board, icon);
    first_try = (float)thermicon_play(&player, icon);
    for (turn = 0; turn < 6000; turn++) {
        if (strcmp(story, "hang") || turn < 3600) thermicon_feed(&player);
        if (!strcmp(story, "lost") && turn == 3600) p.lost = 1;
        if (!strcmp(story, "frozen") && turn == 3600) { p.frozen = 1; p.stuck_C = p.temperature_C; }
        if (!strcmp(story, "abort") && turn == 3600) thermicon_abort(&player);
        if (!strcmp(story, "runaway") && turn >= 3600) p.temperature_C -= 0.2f;
        if (!strcmp(story, "hot") && turn >= 3600) p.temperature_C += 0.2f;
        thermicon_step(&player, !strcmp(story, "late") && turn == 3600 ? 0.3f : dt);
        go_on(&p, dt);
        if (player.state == THERMICON_PLAYING && p.temperature_C < coldest) coldest = p.temperature_C;
        if (player.state == THERMICON_PLAYING && fabsf(p.out) > largest_out) largest_out = fabsf(p.out);
        if (plays_began < 0 && thermicon_play(&player, icon) == THERMICON_OK) { plays_began = turn; plays += 1; }
        if (plays_began >= 0 && ended < 0 && player.state == THERMICON_RESTING) {
            ended = turn;
            early = thermicon_play(&player, icon);
        }
        if (ended >= 0 && turn == ended + 1990) answer = thermicon_play(&player, icon);
        if (ended >= 0 && turn == ended + 2010 && thermicon_play(&player, icon) == THERMICON_OK) plays += 1;
    }
    printf("begun %d first %d began %ld ended %ld ", begun, (int)first_try, plays_began, ended);
    printf("early %d again %d plays %d ", early, answer, (int)plays);
    printf("state %d fault %d out %.3f ", (int)player.state, (int)player.fault, (double)p.out);
    printf("coldest %.2f ", (double)coldest);
    printf("largest %.3f\\n", (double)largest_out);
    return 0;
}
"""

OK, NO_SENSOR, NOT_RESTED, TOO_SOON = 0, 1, 2, 3
RESTING, PLAYING, STOPPED = 1, 2, 3
NONE, ABORTED, SILENT, LATE, LOST, FROZEN, COLD, WARM, SWAPPED = range(9)


def build(folder: Path, device: str, compiler: str) -> Path:
    form = load_format("c-array")
    files = pack([prepare(ICON, RIG, Device.load(device), form, gate=GreenVerdict)], form)
    assert set(files) == {"double_dip.h", "double_dip.json", "thermicon_player.h"}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    # Under a drive in volts the rest is not zero: the plate's own rest is where its command holds 32.
    shift, gain = ("0.0f", "2.0f") if device == "closed-loop-controller" else ("(0.824f * 2.5f)", "0.5f")
    (folder / "main.c").write_text(MAIN)
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
    assert (told["state"], told["fault"]) == (PLAYING, NONE)
    assert told["coldest"] == pytest.approx(29.0, abs=0.15), "the plate follows the set-points"
    assert told["largest"] <= 1.5


def test_open_loop_puts_out_the_codes_with_the_same_guards(volts: Path) -> None:
    told = run(volts, "normal")
    assert (told["plays"], told["early"], told["fault"]) == (2, TOO_SOON, NONE)
    assert told["largest"] > 1.0


@pytest.mark.parametrize("kind", ["loop", "volts"])
@pytest.mark.parametrize(
    ("story", "fault"),
    [
        ("hang", SILENT),
        ("lost", LOST),
        ("frozen", FROZEN),
        ("abort", ABORTED),
        ("runaway", COLD),
        ("hot", WARM),
        ("late", LATE),
        ("swapped", SWAPPED),
    ],
)
def test_what_goes_wrong_ends_at_zero_for_good(
    kind: str, story: str, fault: int, request: pytest.FixtureRequest
) -> None:
    told = run(request.getfixturevalue(kind), story)
    assert (told["state"], told["fault"], told["out"]) == (STOPPED, fault, 0.0)
    assert told["plays"] == (0 if story == "swapped" else 1)


def test_a_loop_without_a_sensor_does_not_begin(loop: Path) -> None:
    told = run(loop, "no-sensor")
    assert (told["begun"], told["state"], told["out"], told["plays"]) == (NO_SENSOR, STOPPED, 0.0, 0)


def test_an_open_loop_without_a_sensor_keeps_rest_pause_and_watchdog(volts: Path) -> None:
    told = run(volts, "no-sensor")
    assert (told["plays"], told["early"], told["fault"]) == (2, TOO_SOON, NONE)
    assert told["began"] == pytest.approx(3000, abs=3), "no polarity can be tested"


def test_set_points_are_centi_degrees(loop: Path) -> None:
    header = (loop.parent / "double_dip.h").read_text()
    assert "static const float double_dip_step = 0.01f;" in header
    codes = header.split("{")[1].split("}")[0]
    assert int(codes.split(",")[0]) == 3200
    player = (loop.parent / "thermicon_player.h").read_text()
    assert "#define THERMICON_WATCHDOG_S 0.4f" in player
    assert "@" not in player


def test_steps_finer_than_centi_degrees_are_refused() -> None:
    device = Device.load("closed-loop-controller")
    fine = replace(device, records=tuple(r for r in device.records if r.quantity != "set-point step"))
    form = load_format("c-array")
    with pytest.raises(FormatError, match=r"hundredths of a degree; closed-loop-controller has steps of 0\.001 K"):
        pack([prepare(ICON, RIG, fine, form, gate=GreenVerdict)], form)
