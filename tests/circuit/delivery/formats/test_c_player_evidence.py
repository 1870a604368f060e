"""The C player on healthy and on faulty boards by chance, and with each of its stops removed.

`-m slow` makes 300 plays of each sort and device, or as many as THERMICON_EVIDENCE says.
"""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
import pytest

from tests.circuit.delivery.formats.board import BOARDS, CONTROLLER, CORNERS, VOLTS, build, compiled, run
from tests.circuit.delivery.formats.test_c_player import FAULTS, KINDS, LIES, NUMBERS, STAYS, STOPPED, Story, check
from tests.circuit.verdicts import POLARITY
from thermicon.circuit.safety.demands import CutOff, HeldCutOff

RUNS = int(os.environ.get("THERMICON_EVIDENCE", "300"))
SOME = [12, pytest.param(RUNS, marks=pytest.mark.slow)]
TEST = replace(POLARITY, test_current_A=0.3, test_s=2.0, display_change_at_least_K=1.33)
HELD = HeldCutOff(27.5, 39.5, 8.0)
STATED: dict[str, dict[str, Any]] = {
    CONTROLLER: {
        "polarity_check": TEST, "cut_off_display_C": CutOff(26.2, 41.2, 0.1), "held_cut_off_display_C": HELD,
        "current_limit_A": (-0.86, 1.29),
    },
    VOLTS: {
        "polarity_check": replace(TEST, display_change_at_least_K=0.96), "held_cut_off_display_C": HELD,
        "cut_off_display_C": CutOff(22.5, 40.7, 0.1), "rest_before_first_play_s": 69.0,
    },
}  # fmt: skip
"""As the gate states them for this icon and rig, with a second cut-off that no healthy play needs."""


@pytest.fixture(scope="module", params=[CONTROLLER, VOLTS])
def player(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]
) -> Path:
    return build(tmp_path_factory.mktemp(request.param), request.param, tool("cc"), **STATED[request.param])


def some_board(rng: np.random.Generator) -> dict[str, Any]:
    """A healthy board: any world and start, and sensors that differ by 0.3 K at most, the second one late."""
    first_mK = rng.uniform(-300, 300)
    return {
        "world": int(rng.integers(CORNERS)),
        "start": str(rng.choice(["held", "off"])),
        "step_mK": float(rng.choice([0, 10, 50, 62.5, 100])),
        "gain": float(rng.uniform(0.8, 1.2)),
        "first_mK": float(first_mK),
        "second_mK": float(np.clip(first_mK + rng.uniform(-300, 300), -300, 300)),
        "second_ms": float(rng.uniform(50, 300)),
        "turns": 12000,
    }


@pytest.mark.parametrize("count", SOME)
def test_healthy_plays_are_not_stopped(count: int, player: Path) -> None:
    rng = np.random.default_rng(31)
    for _ in range(count):
        board = some_board(rng)
        told = run(player, **board)
        assert told["fault"] == 0, (board, told)
        assert told["plays"] >= 2 and told["wrong"] == 0


@pytest.mark.parametrize("count", SOME)
def test_bad_sensors_and_swapped_wires_are_off_in_time(count: int, player: Path) -> None:
    rng, noticed = np.random.default_rng(32), 0
    for _ in range(count):
        board = some_board(rng)
        began = 100 * run(player, **board)["began"]
        at, which = float(round(began + rng.uniform(-300, 500))), float(rng.integers(1, 3))
        lie_mK = float(rng.choice([-1, 1]) * rng.uniform(1500, 5000))
        faults: list[tuple[dict[str, float], float]] = [
            ({"bad_at": at, "kind": LIES, "which": which, "lie_mK": lie_mK}, 0.6 if abs(lie_mK) > 3000 else 1.4),
            ({"bad_at": at, "kind": STAYS, "which": which}, 2.0),
        ]
        if CONTROLLER in str(player):  # in open loop the cut-off alone bounds what swapped wires do
            faults.append(({"swap_at": max(at, began + 10.0)}, 3.0))
        fault, within_s = faults[rng.integers(len(faults))]
        told = run(player, **board, **fault)
        since_s = told["moved"] if fault.get("kind") == STAYS else 0.01 * fault.get("bad_at", fault.get("swap_at", 0.0))
        if told["state"] == STOPPED:
            assert told["out"] == told["pin"] == 0 and told["stopped"] - since_s <= within_s, (board, fault, told)
            noticed += 1
        else:
            assert told["moved"] < 0 and fault["kind"] == STAYS, (board, fault, told)
    assert noticed > 0.8 * count


STOPS: dict[str, tuple[str, str]] = {
    "lost": ("/* not a number fails too */\n        thermicon_stop(player, THERMICON_SENSOR_LOST);", ";"),
    "no number": ("!(now > THERMICON_SENSOR_LOW_C && now < THERMICON_SENSOR_HIGH_C)", "0"),
    "too cold": ("if (now < THERMICON_LOW_C) thermicon_stop(player, THERMICON_TOO_COLD);", ""),
    "too warm": ("if (now > THERMICON_HIGH_C) thermicon_stop(player, THERMICON_TOO_WARM);", ""),
    "held": ("thermicon_limit(player, is_held, ", "thermicon_limit(player, 0, "),
    "held while off": ("player->state != THERMICON_OFF && (now", "(now"),
    "off course": ("thermicon_exceeds(beside_K, THERMICON_OFF_COURSE_K)", "0"),
    "off course in open loop": ("THERMICON_CLOSED_LOOP && thermicon_exceeds(beside_K", "thermicon_exceeds(beside_K"),
    "frozen": ("thermicon_exceeds(moved, 3.0f * THERMICON_SENSOR_STEP_K)", "0"),
    "frozen by the other": ("moved = other->reading_C - sensor->other_C;", "moved = 0.0f;"),
    "frozen by the prediction": ("moved = expected - sensor->expected_C;", ";"),
    "apart": ("thermicon_limit(player, is_apart, ", "thermicon_limit(player, 0, "),
    "late second sensor": ("late = player->late_C, second", "late = first, second"),
    "first sensor": ("if (has_first) thermicon_check(player, first, second);", ""),
    "second sensor": ("if (has_second) thermicon_check(player, second, first);", ""),
    "silent": ("thermicon_stop(player, THERMICON_HOST_SILENT);", ";"),
    "late": ("if (elapsed > most) thermicon_stop(player, THERMICON_LOOP_LATE);", ""),
    "late for codes": ("&& two_periods < most) most = two_periods;", "&& two_periods < most) most = most;"),
    "late for set-points": ("if (!THERMICON_CLOSED_LOOP && player->state", "if (player->state"),
    "clock": ("thermicon_stop(player, THERMICON_CLOCK_STANDS);\n    player->now_us", ";\n    player->now_us"),
    "first polarity": ("first->test_from_C - first->reading_C < THERMICON_TEST_FALL_K", "0"),
    "second polarity": ("second->test_from_C - second->reading_C < THERMICON_TEST_FALL_K", "0"),
    "abort": ("player->aborted = 1;", ";"),
    "abort at once": ("= 1;\n    player->board->put_out(player->board->context, 0.0f);", "= 1;"),
    "abort before a step": ("    if (player->aborted) thermicon_stop(player, THERMICON_ABORTED);\n", ""),
    "abort in a step": ("if (player->aborted) thermicon_stop(player, THERMICON_ABORTED); /*", "/*"),
    "abort before a play": ("STOPPED || player->aborted)", "STOPPED)"),
    "first fault": ("    if (player->state != THERMICON_STOPPED) player->fault = fault;", "    player->fault = fault;"),
    "zero": ("player->board->put_out(player->board->context, 0.0f);\n    thermicon_mark", "thermicon_mark"),
    "pin": ("thermicon_mark(player, 0);\n    if (player->state", "if (player->state"),
    **{
        f"{name} {new}": (f"#define THERMICON_{name} {old}f", f"#define THERMICON_{name} {new}f")
        for name, old, others in (
            ("APART_K", 1.0, (0.85, 1.15)), ("APART_S", 0.3, (0.2, 0.4)),
            ("OFF_COURSE_K", 1.5, (1.35, 1.65)), ("OFF_COURSE_S", 1.0, (0.85, 1.15)),
            ("SENSOR_STEP_K", 0.1, (0.075, 0.125)), ("FROZEN_S", 1.0, (0.85, 1.15)),
        ) for new in others
    },
}  # fmt: skip
"""Each stop as the header has it, and what is left without it; then each number of its own, smaller and larger."""


@pytest.mark.slow
def test_without_a_stop_a_story_ends_otherwise(tmp_path: Path, tool: Callable[[str], str]) -> None:
    texts = {}
    for kind, (device, demands) in KINDS.items():
        (tmp_path / kind).mkdir()
        build(tmp_path / kind, device, tool("cc"), **demands)
        texts[kind] = (tmp_path / kind / "thermicon_player.h").read_text()
    kept = [name for name in STOPS if not is_missed(name, texts, tmp_path, tool("cc"))]
    assert kept == []


def is_missed(name: str, texts: dict[str, str], folder: Path, compiler: str) -> bool:
    """Whether a story ends otherwise without a stop."""
    programs, (old, new) = {}, STOPS[name]
    for kind, text in texts.items():
        assert text.count(old) == 1, (name, text.count(old))
        (folder / kind / "thermicon_player.h").write_text(text.replace(old, new))
        programs[kind] = compiled(folder / kind, compiler, *BOARDS[KINDS[kind][0]], "-w")
    stories: list[tuple[str, Story]] = [*NUMBERS.values(), *(("loop", story) for story in FAULTS.values())]
    for kind, (fault, scenario) in (*stories, *(("volts", story) for story in FAULTS.values())):
        try:
            check(fault, scenario, run(programs[kind], **scenario))
        except (AssertionError, CalledProcessError):
            return True
    return False
