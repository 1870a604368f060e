"""The microcontroller player on a simulated board."""

import hashlib
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.delivery.formats.board import CONTROLLER, ICON, RIG, VOLTS, build, run
from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import POLARITY, GreenVerdict
from thermicon.circuit import Device
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.formats.c_array import COURSE_S
from thermicon.circuit.delivery.formats.form import course_C
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.safety.demands import HeldCutOff

OK, NO_SENSOR, NOT_RESTED, NO_CLOCK = 0, 1, 2, 6
STOPPED, NO_FAULT = 3, 0
ABORTED, SILENT, LATE, LOST, FROZEN, COLD, WARM, SWAPPED, STANDS, APART, OFF_COURSE, HELD = range(1, 13)
OPEN, STAYS, NO_NUMBER, LIES, ON_COURSE = range(1, 6)
"""Kinds of a bad sensor, as in `player_main.c`."""
KINDS: dict[str, tuple[str, dict[str, Any]]] = {
    "loop": (CONTROLLER, {}),
    "volts": (VOLTS, {}),
    "held": (CONTROLLER, {"held_cut_off_display_C": HeldCutOff(31.5, 32.5, 3.0)}),
}
"""Devices, and demands of their own."""

Story = tuple[int, dict[str, Any]]
FAULTS: dict[str, Story] = {
    "abort": (ABORTED, {"abort_at": 4600}),
    "abort in measure": (ABORTED, {"abort_at": 4600, "inside": 1}),
    "abort in now_us": (ABORTED, {"abort_at": 4600, "inside": 2}),
    "abort in put_out": (ABORTED, {"abort_at": 4600, "inside": 3}),
    "abort in mark": (ABORTED, {"abort_at": 4050, "inside": 4}),
    "abort between a step and a play": (ABORTED, {"abort_at": 4053, "inside": 5}),
    "hang": (SILENT, {"mute_at": 4600}),
    "late": (LATE, {"late_at": 4600, "late_us": 3e5}),
    "lost": (LOST, {"bad_at": 4600, "kind": OPEN}),
    "no number": (LOST, {"bad_at": 4600, "kind": NO_NUMBER}),
    "wire broken": (LOST, {"bad_at": 4600, "kind": LIES, "lie_mK": 1e5}),
    "frozen": (FROZEN, {"bad_at": 3900, "kind": STAYS}),
    "runaway": (COLD, {"drift_at": 4600, "drift_mK": -1000}),
    "hot": (WARM, {"drift_at": 4600, "drift_mK": 1000}),
    "swapped": (SWAPPED, {"swap_at": 0}),
    "clock stands": (STANDS, {"stand_at": 4600}),
    "clock goes back": (LATE, {"back_at": 4600, "back_us": 1e6}),
    "second sensor lost": (LOST, {"bad_at": 4600, "kind": OPEN, "which": 2}),
    "first sensor frozen in a ramp": (APART, {"bad_at": 4060, "kind": STAYS, "which": 1}),
    "second sensor frozen in a ramp": (APART, {"bad_at": 4060, "kind": STAYS, "which": 2}),
    "first sensor does not fall in the test": (SWAPPED, {"bad_at": 990, "kind": STAYS, "which": 1}),
    "second sensor does not fall in the test": (SWAPPED, {"bad_at": 990, "kind": STAYS, "which": 2}),
    "second sensor beyond the cut-off": (WARM, {"bad_at": 4600, "kind": LIES, "which": 2}),
    "sensors apart before the test": (APART, {"bad_at": 100, "kind": LIES, "which": 1, "lie_mK": -1500}),
}
"""What stops a loop and a drive in volts alike, and with which fault. A play begins in turn 4054 and ends 8 s later."""

SECOND = {"kind": LIES, "which": 2}
BESIDE = {"kind": ON_COURSE, "bad_at": 4060, "lie_mK": 1600, "turns": 4800}
ONE_STAYS = {"step_mK": 50, "kind": LIES, "which": 1, "bad_at": 6600}
NUMBERS: dict[str, tuple[str, Story]] = {
    "0.9 K apart": ("loop", (NO_FAULT, {**SECOND, "bad_at": 3000, "lie_mK": 900})),
    "1.1 K apart": ("loop", (APART, {**SECOND, "bad_at": 3000, "lie_mK": 1100})),
    "0.9 K apart, colder": ("volts", (NO_FAULT, {**SECOND, "bad_at": 3000, "lie_mK": -900})),
    "1.1 K apart, colder": ("volts", (APART, {**SECOND, "bad_at": 3000, "lie_mK": -1100})),
    "0.6 K apart, and 0.3 s late": ("loop", (NO_FAULT, {"first_mK": 300, "second_mK": -300, "second_ms": 300})),
    "apart for 0.25 s": ("loop", (NO_FAULT, {**SECOND, "bad_at": 4600, "good_at": 4625, "lie_mK": 2500})),
    "apart for 0.35 s": ("loop", (APART, {**SECOND, "bad_at": 4600, "good_at": 4635, "lie_mK": 2500})),
    "1.4 K beside": ("loop", (NO_FAULT, {**BESIDE, "lie_mK": 1400})),
    "1.6 K beside": ("loop", (OFF_COURSE, BESIDE)),
    "1.4 K beside, colder": ("loop", (NO_FAULT, {**BESIDE, "lie_mK": -1400})),
    "1.6 K beside, colder": ("loop", (OFF_COURSE, {**BESIDE, "lie_mK": -1600})),
    "beside for 0.9 s": ("loop", (NO_FAULT, {**BESIDE, "good_at": 4150})),
    "beside for 1.1 s": ("loop", (OFF_COURSE, {**BESIDE, "good_at": 4170})),
    "only the second sensor beside": ("loop", (NO_FAULT, {**BESIDE, "which": 2, "first_mK": 900})),
    "open loops are not known so well": ("volts", (NO_FAULT, {**BESIDE, "lie_mK": 3000})),
    "warmer for 2.9 s": ("held", (NO_FAULT, {**SECOND, "bad_at": 3000, "good_at": 3290, "lie_mK": 800})),
    "warmer for 3.1 s": ("held", (HELD, {**SECOND, "bad_at": 3000, "good_at": 3310, "lie_mK": 800})),
    "colder for 2.9 s": ("held", (NO_FAULT, {**SECOND, "bad_at": 3000, "good_at": 3290, "lie_mK": -800})),
    "colder for 3.1 s": ("held", (HELD, {**SECOND, "bad_at": 3000, "good_at": 3310, "lie_mK": -800})),
    "within the second cut-off": ("held", (NO_FAULT, {**SECOND, "bad_at": 3000, "lie_mK": 450})),
    "warm without power": ("held", (NO_FAULT, {"start": "off"})),
    "the other moved by 0.25 K": ("volts", (NO_FAULT, {**ONE_STAYS, "lie_mK": 250})),
    "the other moved by 0.35 K": ("volts", (FROZEN, {**ONE_STAYS, "lie_mK": 350})),
    "stays for 0.9 s after": ("volts", (NO_FAULT, {**ONE_STAYS, "lie_mK": 350, "good_at": 6690})),
    "stays for 1.1 s after": ("volts", (FROZEN, {**ONE_STAYS, "lie_mK": 350, "good_at": 6710})),
    "one sensor": ("volts", (NO_FAULT, {"sensors": 1})),
    "one sensor, frozen": ("volts", (FROZEN, {"sensors": 1, "kind": STAYS, "bad_at": 4060})),
    "one sensor of another place, frozen": ("volts", (FROZEN, {"sensors": 2, "kind": STAYS, "bad_at": 3010})),
    "codes late by 9 ms": ("volts", (NO_FAULT, {"late_at": 4500, "late_us": 9000})),
    "codes late by 11 ms": ("volts", (LATE, {"late_at": 4500, "late_us": 11000})),
    "codes in turns of 25 ms": ("volts", (LATE, {"dt_us": 25000})),
    "rest late by 80 ms": ("volts", (NO_FAULT, {"late_at": 3000, "late_us": 80000})),
    "set-points late by 80 ms": ("loop", (NO_FAULT, {"late_at": 4500, "late_us": 80000})),
    "set-points late by 95 ms": ("loop", (LATE, {"late_at": 4500, "late_us": 95000})),
    "set-points in turns of 25 ms": ("loop", (NO_FAULT, {"dt_us": 25000, "turns": 2000})),
}
"""Both sides of each number that decides; a play of the second sensor alone begins 10.5 s earlier, without a test."""


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]) -> dict[str, Path]:
    return {
        name: build(tmp_path_factory.mktemp(name), device, tool("cc"), **demands)
        for name, (device, demands) in KINDS.items()
    }


@pytest.fixture
def loop(programs: dict[str, Path]) -> Path:
    return programs["loop"]


@pytest.fixture
def volts(programs: dict[str, Path]) -> Path:
    return programs["volts"]


def test_a_loop_tests_rests_plays_and_keeps_the_pause(loop: Path) -> None:
    told = run(loop)
    assert (told["begun"], told["first"]) == (OK, NOT_RESTED)
    assert told["tested"] == pytest.approx(10.0, abs=0.03) and told["tested"] > 10.0
    assert told["began"] == pytest.approx(40.5, abs=0.05), "10 s off, 0.5 s of test, 30 s of rest"
    assert told["ended"] - told["began"] == pytest.approx(8.01, abs=0.03)
    assert (told["plays"], told["fault"], told["wrong"]) == (2, NO_FAULT, 0)
    assert told["paused"] == pytest.approx(20.0, abs=0.03) and told["paused"] >= 20.0
    assert told["coldest"] == pytest.approx(28.97, abs=0.05), "as predicted"
    assert told["largest"] <= 1.5


def test_open_loop_puts_out_the_codes_with_the_same_guards(volts: Path) -> None:
    told = run(volts)
    assert (told["plays"], told["fault"], told["wrong"]) == (2, NO_FAULT, 0)
    assert told["paused"] >= 20.0
    assert told["largest"] > 1.0


@pytest.mark.parametrize("kind", ["loop", "volts"])
@pytest.mark.parametrize("story", FAULTS)
def test_what_goes_wrong_ends_at_zero_for_good(kind: str, story: str, programs: dict[str, Path]) -> None:
    check(*FAULTS[story], run(programs[kind], **FAULTS[story][1]))


@pytest.mark.parametrize("story", NUMBERS)
def test_both_sides_of_a_number(story: str, programs: dict[str, Path]) -> None:
    kind, (fault, scenario) = NUMBERS[story]
    check(fault, scenario, run(programs[kind], **scenario))


def check(fault: int, scenario: dict[str, Any], told: dict[str, Any]) -> None:
    """A story ends with its fault, and then at zero, or plays on: twice, or once where it ends early."""
    assert told["fault"] == fault
    assert told["wrong"] == 0 or ("stand_at" in scenario and told["wrong"] <= 1.0), "100 steps of a clock that stands"
    if fault:
        assert (told["state"], told["out"], told["pin"]) == (STOPPED, 0.0, 0)
        before_a_play = told["stopped"] < 40 or scenario.get("inside") == 5
        assert told["plays"] == (0 if before_a_play else 1) or "dt_us" in scenario or "sensors" in scenario
    else:
        assert told["state"] != STOPPED and told["plays"] == (1 if "turns" in scenario else 2)


def test_both_sensors_must_fall_as_far_as_demanded(tmp_path: Path, tool: Callable[[str], str], volts: Path) -> None:
    """The second one follows the display later, and so falls less."""
    slow = {"second_ms": 300.0}
    told = run(volts, **slow)
    first_K, second_K = told["fell"], told["fell_second"]
    assert 0.15 < second_K < first_K - 0.1
    for demanded_K, fault in ((second_K - 0.01, NO_FAULT), (second_K + 0.01, SWAPPED), (first_K + 0.01, SWAPPED)):
        test = replace(POLARITY, display_change_at_least_K=demanded_K)
        program = build(tmp_path, VOLTS, tool("cc"), polarity_check=test)
        assert run(program, **slow)["fault"] == fault
        assert run(program, sensors=1)["fault"] == (SWAPPED if demanded_K > first_K else NO_FAULT)


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
    [{"start_us": 2**32 - 43e6}, {"tick_us": 16_000}, {"tick_us": 1000, "dt_us": 50, "turns": 1_100_000}],
    ids=["wraps", "is coarse", "is coarser than the loop is quick"],
)
def test_a_clock_that_wraps_or_is_coarse_plays_the_same(volts: Path, clock: dict[str, float]) -> None:
    told = run(volts, **clock)
    assert (told["fault"], told["wrong"]) == (NO_FAULT, 0)
    assert told["began"] == pytest.approx(40.5, abs=0.07) and told["waited"] >= 40.5 - 0.016
    assert told["ended"] - told["began"] == pytest.approx(8.01, abs=0.04)


def test_a_long_pause_keeps_its_length_in_a_quick_loop(tmp_path: Path, tool: Callable[[str], str]) -> None:
    """A sum of steps in 32 bits would lose them: 600 s would be 546 s."""
    slow = build(tmp_path, VOLTS, tool("cc"), rest_before_first_play_s=600.0, polarity_check=None)
    told = run(slow, dt_us=50, turns=12_400_000)
    assert told["waited"] == pytest.approx(600.0, abs=1e-3) and told["waited"] >= 600.0


def test_after_a_restart_the_pause_is_held_too(tmp_path: Path, tool: Callable[[str], str]) -> None:
    """The board may have been restarted in a play, after an abort, or between plays; before the first play too."""
    waits = {"rest_before_first_play_s": 2.0, "pause_at_least_s": 20.5, "polarity_check": None}
    quick = build(tmp_path, VOLTS, tool("cc"), **waits)
    for event in ({"begin_at": 2400}, {"abort_at": 2400, "begin_at": 2450}, {"begin_at": 3100}, {}):
        told = run(quick, turns=5500, **event)
        assert told["plays"] == (1 if event else 2)
        assert told["waited"] == pytest.approx(20.5, abs=0.03) and told["waited"] >= 20.5


@pytest.mark.parametrize("event", [{"begin_at": 4600}, {"abort_at": 4600, "begin_at": 4650}, {"begin_at": 1020}])
@pytest.mark.parametrize("kind", ["loop", "volts"])
def test_after_a_restart_the_output_is_off_before_the_test(
    kind: str, event: dict[str, float], programs: dict[str, Path]
) -> None:
    told = run(programs[kind], **event)
    assert told["tested"] - 0.01 * event["begin_at"] == pytest.approx(10.0, abs=0.04)
    assert told["tested"] - 0.01 * event["begin_at"] > 10.0 and told["fault"] == NO_FAULT


def test_without_any_safe_hang_the_cut_off_protects(tmp_path: Path, tool: Callable[[str], str]) -> None:
    """A watchdog of 0: without a sensor nothing would be guarded, and with it the player still plays."""
    none = build(tmp_path, VOLTS, tool("cc"), watchdog_s=0.0)
    assert run(none, sensors=0)["begun"] == NO_SENSOR
    assert (run(none)["plays"], run(none)["fault"]) == (2, NO_FAULT)
    told = run(none, mute_at=4600)
    assert (told["fault"], told["stopped"]) == (2, pytest.approx(46.1, abs=0.03)), "the host has 0.1 s, as the cut-off"


@pytest.mark.parametrize(("own", "silent_s"), [("0.2f", 0.2), ("0.2", 0.2), ("60", 0.4)])
def test_a_watchdog_may_be_shorter_than_judged_and_never_longer(
    own: str, silent_s: float, tmp_path: Path, tool: Callable[[str], str]
) -> None:
    told = run(build(tmp_path, VOLTS, tool("cc"), f"-DTHERMICON_WATCHDOG_S={own}"), mute_at=4600)
    assert (told["fault"], told["stopped"] - 46.0) == (SILENT, pytest.approx(silent_s, abs=0.02))


def test_a_pin_marks_each_icon_and_falls_at_a_stop(loop: Path) -> None:
    """The board itself ends with an error where the pin is told its level again."""
    told = run(loop)
    assert (told["marks"], told["pin"], told["marked"]) == (2, 0, pytest.approx(16.0, abs=0.03))
    told = run(loop, abort_at=4600)
    assert (told["marks"], told["pin"], told["marked"]) == (1, 0, pytest.approx(46.0 - told["began"], abs=0.02))
    assert run(loop, sensors=0)["pin"] == run(loop, begin_at=4600)["pin"] == 0
    assert run(loop, pin=0)["plays"] == 2, "it may be absent"


@pytest.mark.parametrize("step_mK", [50, 100])
def test_a_sensor_of_tenths_is_not_called_frozen(volts: Path, loop: Path, step_mK: float) -> None:
    """It reads the same for the whole rest and pause, and after the pause what it read at the end of the play."""
    for program in (volts, loop):
        told = run(program, step_mK=step_mK, second_ms=300, turns=13000)
        assert (told["plays"], told["fault"]) == (4, NO_FAULT)


def test_a_sensor_that_froze_in_the_rest_is_noticed_a_second_after_the_display_has_moved(volts: Path) -> None:
    told = run(volts, bad_at=3000, kind=STAYS)
    assert told["fault"] == FROZEN
    assert 1.0 < told["stopped"] - told["began"] < 1.6


def test_set_points_are_centi_degrees(loop: Path) -> None:
    header = (loop.parent / "double_dip.h").read_text()
    assert "static const float double_dip_step = 0.01f;" in header
    assert int(header.split("{")[1].split(",")[0]) == 3200
    player = (loop.parent / "thermicon_player.h").read_text()
    assert "#define THERMICON_WATCHDOG_S 0.39999998f" in player, "0.4 in 32 bits is longer"
    assert "@" not in player


def test_the_course_is_the_predicted_display_and_not_the_set_points(loop: Path) -> None:
    form = load_format("c-array")
    delivery = prepare(ICON, RIG, Device.load(CONTROLLER), form, gate=GreenVerdict).delivery
    player = (loop.parent / "thermicon_player.h").read_text()
    (codes,) = re.findall(r"course_double_dip\[\] PROGMEM = \{([^}]*)\}", player)
    course = [0.01 * int(code) for code in codes.split(",")]
    assert course == pytest.approx(course_C(delivery, COURSE_S), abs=0.0051)
    set_points = delivery.played.command[:: round(COURSE_S * delivery.rate_Hz)]
    assert max(abs(a - b) for a, b in zip(course, set_points, strict=False)) > 1.0


def test_the_header_names_its_export_and_its_icons(tmp_path: Path, loop: Path, volts: Path) -> None:
    digests = set()
    for folder in (loop.parent, volts.parent):
        text = (folder / "thermicon_player.h").read_bytes()
        (digest,) = re.findall(rb'THERMICON_DIGEST "([0-9a-f]{16})"', text)
        whole = (folder / "double_dip.h").read_bytes() + text.replace(digest, b"0" * 16)
        assert hashlib.sha256(whole).hexdigest()[:16].encode() == digest
        assert b'#define THERMICON_NAMES "double_dip"\n' in text
        digests.add(digest)
    assert len(digests) == 2


def test_steps_finer_than_centi_degrees_are_refused() -> None:
    form, device = load_format("c-array"), Device.load(CONTROLLER)
    fine = replace(device, records=tuple(r for r in device.records if r.quantity != "set-point step"))
    with pytest.raises(FormatError, match=r"hundredths of a degree; closed-loop-controller has steps of 0\.001 K"):
        pack([prepare(ICON, RIG, fine, form, gate=GreenVerdict)], form)
