"""Numbers of the gate as players get them."""

import ast
import hashlib
import json
import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import LOOP, MADE_UP, POLARITY, GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import Format, format_names, load_format
from thermicon.circuit.delivery.formats.form import Played
from thermicon.circuit.delivery.pack import pack, sidecar_name
from thermicon.circuit.delivery.prepare import Prepared
from thermicon.circuit.play.drives import check_commands
from thermicon.circuit.play.watch import Refused
from thermicon.circuit.safety.demands import DEMANDS, CutOff, Demands, HeldCutOff, Loop, PolarityCheck
from thermicon.icons import load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]


def test_the_strictest_of_a_set_counts() -> None:
    gentle = replace(
        MADE_UP, watchdog_s=1.0, pause_at_least_s=90.0, polarity_check=replace(POLARITY, needed=False),
        cut_off_display_C=CutOff(24.0, 44.0, 0.5), current_limit_A=(-1.0, 0.5), zero_current_at_most_s=700.0,
        held_cut_off_display_C=HeldCutOff(25.0, 38.0, 9.0),
    )  # fmt: skip
    strict = replace(
        MADE_UP, current_limit_A=(-0.8, 0.9), zero_current_at_most_s=90.0,
        held_cut_off_display_C=HeldCutOff(21.0, 37.0, 12.0),
    )  # fmt: skip
    assert Demands.strictest([strict, gentle]) == Demands(
        0.4, CutOff(24.0, 40.0, 0.1), POLARITY, 30.0, 90.0, 90.0, (), HeldCutOff(25.0, 37.0, 9.0), (-0.8, 0.5)
    )
    assert Demands.strictest([gentle, MADE_UP]).held_cut_off_display_C == gentle.held_cut_off_display_C


def test_the_numbers_of_a_polarity_test_belong_together() -> None:
    """What the right wiring is sure to reach in 2 s, it need not reach in 0.5 s."""
    longer = replace(POLARITY, test_current_A=0.1, test_s=2.0, display_change_at_least_K=0.25)
    unneeded = replace(POLARITY, needed=False, test_s=0.1)
    demands = [replace(MADE_UP, polarity_check=check) for check in (unneeded, longer, POLARITY)]
    assert Demands.strictest(demands).test == POLARITY
    assert Demands.strictest(demands[:1]).test is None


def test_what_the_gate_does_not_find_is_assumed() -> None:
    unknown = replace(MADE_UP, polarity_check=None, rest_before_first_play_s=None, pause_at_least_s=None)
    for demands in (Demands.strictest([unknown]), Demands.strictest([unknown, MADE_UP])):
        assert (demands.rest_s, demands.pause_s) == (1800.0, 60.0)
    assert Demands.strictest([unknown]).test is None


def test_a_set_has_one_player() -> None:
    form = load_format("c-array")
    ready = prepare(ICON, RIG, Device.load("dac-12"), form, gate=GreenVerdict)
    assert set(form.player([Played(ready.delivery, "a.h", "a.json")], MADE_UP)) == set(form.set_files)


LOOPS = st.builds(
    Loop, *[st.tuples(st.floats(0, 5), st.floats(0, 5))] * 2, st.floats(0, 5), *[st.floats(0, 1)] * 4,
    *[st.tuples(st.floats(0, 5), st.floats(0, 5))] * 2, st.floats(0, 1),
)  # fmt: skip
ANY = st.builds(
    Demands, watchdog_s=st.floats(0.02, 60), faults=st.just(()), zero_current_at_most_s=st.none(),
    cut_off_display_C=st.builds(CutOff, st.floats(5, 31), st.floats(33, 50), st.floats(0.02, 2)),
    polarity_check=st.builds(
        PolarityCheck, st.just(True), st.just(10.0), st.floats(0.01, 2), st.floats(0.1, 5), st.floats(0.01, 3),
        st.just((20.0, 40.0)),
    ),
    rest_before_first_play_s=st.floats(0.1, 1800), pause_at_least_s=st.floats(0.1, 600),
    held_cut_off_display_C=st.builds(HeldCutOff, st.floats(5, 31), st.floats(33, 50), st.floats(1, 60)),
    current_limit_A=st.tuples(st.floats(-9, -0.01), st.floats(0.01, 9)), loop=LOOPS,
)  # fmt: skip


@given(ANY)
@settings(max_examples=50)
def test_rounding_goes_to_the_safe_side(must: Demands) -> None:
    """In the 32 bits of a microcontroller, and as the script reads its numbers; by less than a millionth."""
    cut, test, loop = must.cut_off_display_C, must.test, must.loop
    assert test is not None and loop is not None and must.current_limit_A is not None
    header = load_format("c-array").player([drive("c-array", "dac-12")], must)["thermicon_player.h"].decode()
    told = {
        name: float(np.float32(value)) for name, value in re.findall(r"#define THERMICON_(\w+) (-?[\d.e-]+)f", header)
    }
    shorter = {"WATCHDOG_S": must.watchdog_s, "REACT_S": cut.react_within_s, "HIGH_C": cut.high}
    shorter |= {"TEST_FALL_K": test.display_change_at_least_K, "TEST_COMMAND": test.test_current_A / 0.1}
    shorter |= dict(zip(("KP", "KI", "KD"), loop.played, strict=True)) | {"HIGHEST_A": must.current_limit_A[1]}
    longer = {"REST_S": must.rest_s, "PAUSE_S": must.pause_s, "LOW_C": cut.low, "TEST_S": test.test_s}
    longer |= {"LOWEST_A": must.current_limit_A[0]}
    assert all(told[name] <= value for name, value in shorter.items())
    assert all(told[name] >= value for name, value in longer.items())
    assert all(told[name] == pytest.approx(value, rel=1e-6) for name, value in {**shorter, **longer}.items())
    script = drive("psychopy", "ni-analogue-output")
    play_icons = load_format("psychopy").player([script], must)["play_icons.py"].decode()
    values = {
        name.id: value
        for node in ast.parse(play_icons).body if isinstance(node, ast.Assign)
        for name, value in zip(
            getattr(node.targets[0], "elts", node.targets), _values(node.value), strict=False
        )
    }  # fmt: skip
    assert (values["LOW_C"], values["HIGH_C"]) == (cut.low, cut.high)
    assert (values["REST_S"], values["PAUSE_S"], values["TEST_S"]) == (must.rest_s, must.pause_s, test.test_s)
    assert 2.0 * values["LOOK_EVERY_S"] <= cut.react_within_s
    assert values["LATE_S"] <= min(cut.react_within_s, must.watchdog_s)


@cache
def drive(form: str, device: str) -> Played:
    ready = prepare(ICON, RIG, Device.load(device), load_format(form), gate=GreenVerdict)
    return Played(ready.delivery, "a.h", "a.json")


def _values(node: ast.expr) -> list[Any]:
    try:
        value = ast.literal_eval(node)
    except ValueError:
        return []
    return list(value) if isinstance(value, tuple) else [value]


EVERY = replace(
    MADE_UP, zero_current_at_most_s=700.0, held_cut_off_display_C=HeldCutOff(25.0, 38.0, 9.0),
    current_limit_A=(-1.2, 1.2), loop=LOOP,
)  # fmt: skip
"""Everything that may be demanded."""
OTHER = replace(
    EVERY, watchdog_s=0.3, cut_off_display_C=CutOff(21.0, 39.0, 0.05), rest_before_first_play_s=40.0,
    held_cut_off_display_C=HeldCutOff(24.0, 37.0, 8.0), polarity_check=replace(POLARITY, test_s=0.7),
    pause_at_least_s=30.0, zero_current_at_most_s=600.0, current_limit_A=(-1.1, 1.1),
    loop=replace(LOOP, playing_kp_A_per_K=(0.17, 0.19)),
)  # fmt: skip


def sent(form: Format) -> Prepared:
    device = Device.load("closed-loop-controller" if form.name == "psychopy" else form.device)
    return prepare(ICON, Rig.load("tcs2") if form.name == "tcs2-serial" else RIG, device, form, gate=GreenVerdict)


@pytest.mark.parametrize("form", [load_format(name) for name in format_names()], ids=format_names())
def test_every_demand_is_met_and_what_a_player_holds_or_proves_changes_the_player(form: Format) -> None:
    """So that none is dropped: what nothing holds or proves is stated, and the sidecar has all of them."""
    met, ready = form.met(EVERY), sent(form)
    assert set(met) == set(DEMANDS) == set(EVERY.demanded)
    assert set(met.values()) <= {"held", "proven", "stated"}
    assert form.player is not None or set(met.values()) == {"stated"}
    verdict = type("Verdict", (GreenVerdict,), {"demands": EVERY, "demanded": EVERY.to_dict()})(None)
    about = json.loads(pack([replace(ready, verdict=verdict)], form)[sidecar_name(ICON.name, form)])
    assert about["format"]["demands_met"] == met
    assert all(about["hardware_must_prevent"][name] is not None for name in met)
    for name, how in met.items():
        if how != "stated":
            changed = replace(EVERY, **{name: getattr(OTHER, name)})
            assert form.player([Played(ready.delivery, "a", "a.json")], changed) != form.player(
                [Played(ready.delivery, "a", "a.json")], EVERY
            ), name


def test_the_limit_of_a_driver_is_stated_where_no_loop_keeps_it() -> None:
    form = load_format("c-array")
    assert form.met(EVERY)["current_limit_A"] == "held"
    assert form.met(replace(EVERY, loop=None))["current_limit_A"] == "stated"
    assert "polarity_check" not in form.met(replace(EVERY, polarity_check=replace(POLARITY, needed=False)))
    assert "held_cut_off_display_C" not in form.met(MADE_UP)


@pytest.mark.parametrize("device", ["ni-analogue-output", "closed-loop-controller"])
def test_what_is_demanded_is_in_the_script(device: str) -> None:
    """The test of the wires for a controller too, the second cut-off, and the drive with what it is predicted to do."""
    demands = replace(MADE_UP, held_cut_off_display_C=HeldCutOff(25.0, 38.0, 9.0))
    played = replace(drive("psychopy", device), content=b"bytes")
    for needed, held in ((demands, (25.0, 38.0, 9.0)), (MADE_UP, (None, None, None))):
        script: dict[str, Any] = {}
        exec(
            compile(load_format("psychopy").player([played], needed)["play_icons.py"], "play_icons.py", "exec"), script
        )
        script["atexit"].unregister(script["abort"])
        assert (script["HELD_LOW_C"], script["HELD_HIGH_C"], script["HELD_S"]) == held
        assert script["_numbers"]().held_s == held[2]
    test = script["TEST_POLARITY"], script["TEST_CURRENT_A"], script["TEST_S"], script["TEST_FALL_K"]
    assert test == (True, 0.2, 0.5, 0.15)
    assert (script["OFF_BEFORE_TEST_S"], script["POLARITY_SEEN"]) == (10.0, "")
    assert script["CLOSED_LOOP"] == (device == "closed-loop-controller")
    assert script["DRIVES"] == {"a.h": hashlib.sha256(b"bytes").hexdigest()}
    commands = played.delivery.played.command
    assert script["COMMANDS"]["a.h"] == pytest.approx((commands.min(), commands.max()), abs=1e-5)
    trace = played.delivery.trace
    times = 0.1 * np.arange(len(script["COURSES_C"]["a.h"]))
    assert script["COURSES_C"]["a.h"] == pytest.approx(np.interp(times, trace.time_s, trace.display_C), abs=0.006)


def test_a_command_beyond_those_that_were_judged_is_refused() -> None:
    check_commands("a.csv", [-1.0, 2.0], (-1.0, 2.0))
    for command in (-1.1, 2.1):
        with pytest.raises(Refused, match=r"a\.csv: a command of -?\d\.1, judged were -1 to 2"):
            check_commands("a.csv", [0.0, command], (-1.0, 2.0))
