"""Numbers of the gate as players get them: the strictest of a set, rounded to the safe side."""

import ast
import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import MADE_UP, POLARITY, GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.formats.form import MustPrevent, Played, must_prevent
from thermicon.circuit.safety.checks import CutOff
from thermicon.icons import load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]
MUST = must_prevent([MADE_UP])


def test_the_strictest_of_a_set_counts() -> None:
    gentle = replace(
        MADE_UP, watchdog_s=1.0, pause_at_least_s=90.0, polarity_check=replace(POLARITY, needed=False),
        cut_off_display_C=CutOff(24.0, 44.0, 0.5), current_limit_A=(-1.0, 0.5),
    )  # fmt: skip
    found = must_prevent([replace(MADE_UP, current_limit_A=(-0.8, 0.9)), gentle])
    assert found == MustPrevent(0.4, 24.0, 40.0, 0.1, True, 0.2, 0.5, 0.15, 30.0, 90.0, limits_A=(-0.8, 0.5))


def test_the_numbers_of_a_polarity_test_belong_together() -> None:
    """What the right wiring is sure to reach in 2 s, it need not reach in 0.5 s."""
    longer = replace(POLARITY, test_current_A=0.1, test_s=2.0, display_change_at_least_K=0.25)
    found = must_prevent([replace(MADE_UP, polarity_check=longer), MADE_UP])
    assert (found.test_current_A, found.test_s, found.test_fall_K) in [(0.1, 2.0, 0.25), (0.2, 0.5, 0.15)]


def test_what_the_gate_does_not_find_is_assumed() -> None:
    unknown = replace(MADE_UP, polarity_check=None, rest_before_first_play_s=None, pause_at_least_s=None)
    found = must_prevent([unknown])
    assert (found.test_polarity, found.rest_s, found.pause_s) == (False, 1800.0, 60.0)


def test_a_set_has_one_player() -> None:
    form = load_format("c-array")
    ready = prepare(ICON, RIG, Device.load("dac-12"), form, gate=GreenVerdict)
    assert set(form.player([Played(ready.delivery, "a.h", "a.json")], MUST)) == set(form.set_files)


@given(
    st.builds(
        MustPrevent, watchdog_s=st.floats(0.02, 60), low_C=st.floats(5, 31), high_C=st.floats(33, 50),
        react_within_s=st.floats(0.02, 2), test_current_A=st.floats(0.01, 2), test_s=st.floats(0.1, 5),
        test_fall_K=st.floats(0.01, 3), rest_s=st.floats(0.1, 1800), pause_s=st.floats(0.1, 600),
        gains=st.tuples(*[st.floats(0, 5)] * 3), limits_A=st.tuples(st.floats(-9, -0.01), st.floats(0.01, 9)),
    )
)  # fmt: skip
@settings(max_examples=50)
def test_rounding_goes_to_the_safe_side(must: MustPrevent) -> None:
    """In the 32 bits of a microcontroller, and as the script reads its numbers; by less than a millionth."""
    header = load_format("c-array").player([drive("c-array", "dac-12")], must)["thermicon_player.h"].decode()
    told = {
        name: float(np.float32(value)) for name, value in re.findall(r"#define THERMICON_(\w+) (-?[\d.e-]+)f", header)
    }
    shorter = {"WATCHDOG_S": must.watchdog_s, "REACT_S": must.react_within_s, "HIGH_C": must.high_C}
    shorter |= {"TEST_FALL_K": must.test_fall_K, "TEST_COMMAND": must.test_current_A / 0.1}
    shorter |= dict(zip(("KP", "KI", "KD"), must.gains, strict=True)) | {"HIGHEST_A": must.limits_A[1]}
    longer = {"REST_S": must.rest_s, "PAUSE_S": must.pause_s, "LOW_C": must.low_C, "TEST_S": must.test_s}
    longer |= {"LOWEST_A": must.limits_A[0]}
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
    assert (values["LOW_C"], values["HIGH_C"]) == (must.low_C, must.high_C)
    assert (values["REST_S"], values["PAUSE_S"], values["TEST_S"]) == (must.rest_s, must.pause_s, must.test_s)
    assert 2.0 * values["LOOK_EVERY_S"] <= must.react_within_s
    assert values["LATE_S"] <= min(must.react_within_s, must.watchdog_s)


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
