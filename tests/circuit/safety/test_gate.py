"""The gate: each rule tripped by a cue of its own."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from functools import cache
from typing import get_args

import pytest

from tests.builders import messages
from tests.circuit.surerig import CERTAIN, sure_rig
from thermicon.circuit import Drive, Gate, Limits, Rig, design, gate, simulate, simulate_current
from thermicon.circuit.safety.checks import CURE_OF, Before, Check, Cure, Scenario, cures_of, findings_of
from thermicon.circuit.safety.current import ENDINGS, CurrentPlant, CurrentPlay
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.plant import Single
from thermicon.circuit.safety.verdict import judge_safety
from thermicon.circuit.safety.words import CURES, check_text, more_and_cure, scenario_text
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import load_library

THENAR = Rig.load("thenar")
STRONG = {"driver.current_limit_A": 8.0, "driver.voltage_limit_V": 60.0, "heat_sink.resistance_K_per_W": 0.02,
          "module.resistance_ohm": 1.5}  # fmt: skip
HOT_SIDE = THENAR.with_(**CERTAIN, **STRONG)
COLD_SIDE = HOT_SIDE.with_(**{"heat_sink.temperature_C": 15.0})
LIGHT_TOUCH = HOT_SIDE.with_(**{"contact.resistance_m2K_per_W": 1e-2})
LIGHT_COLD = LIGHT_TOUCH.with_(**{"heat_sink.temperature_C": 15.0})
RIGS = {"hot side": HOT_SIDE, "cold side": COLD_SIDE, "light touch": LIGHT_TOUCH, "light cold": LIGHT_COLD}
REST = Drive([0, 1], [0.08, 0.08])
PULSE = Drive([0, 1, 1.25, 2], [0.08, 2.0, 0.08, 0.08], held=True)
PULSED = sure_rig("thenar", "contact_resistance_relative", "ambient_K", "gain_relative").with_(
    **STRONG, **{"module.cold_plate_J_per_K": 1.5}
)
STEP = load_library("six-icons")["cooling-step"]


@cache
def pulsed() -> Gate:
    """The verdict on a strong pulse, which several tests read."""
    return gate(PULSE, PULSED)


@cache
def resting() -> Gate:
    """The verdict on a second of rest, which several tests read."""
    return gate(REST, THENAR)


def holding(rig: Rig, control: str, level_C: float, time_s: float = 1.0) -> Drive:
    """A drive that holds a level from before its start until 60 s after its end."""
    current, _ = steady_state(rig, control, level_C)
    return Drive([0, time_s], [current, current])


@pytest.mark.parametrize(("case", "words"), messages(__file__)["trips"].items())
def test_a_level_trips_its_rule(case: str, words: list[str]) -> None:
    name, _, rest = case.partition(": ")
    rig, (control, level, _, time, _) = RIGS[name], rest.split()
    drive = holding(rig, control, float(level), float(time))
    plant = CurrentPlant.of(Ensemble.of(rig))
    once = Single.of(plant, CurrentPlay(drive, float(drive.current_A[0])), rig.limits)
    told = [str(finding) for finding in findings_of(once.checks)]
    for begin in words:
        assert any(text.startswith(begin) for text in told), told
    found = gate(drive, rig, pause_s=600.0)
    assert {(one.quantity, one.upper) for one in findings_of(once.checks)} <= {
        (one.quantity, one.upper) for one in found.findings
    }
    assert found.colour == ("red" if any(one.severity == "hard" for one in found.findings) else "amber")


def test_what_is_far_from_where_it_began_is_amber() -> None:
    drive = Drive([0, 1, 1.5, 6, 7], [0.08, 0.08, 1.1, 1.1, 0.08])
    found = gate(drive, sure_rig())
    assert found.colour == "amber"
    (caution,) = found.cautions
    assert "below the soft limit of 24.27 °C, 8 K from where it began, from" in caution, "32.27 °C at rest"


def test_the_hot_plate_and_the_rate_trip_theirs() -> None:
    weak_sink = THENAR.with_(**CERTAIN, **{"heat_sink.resistance_K_per_W": 1.5})
    found = gate(Drive([0, 1, 20, 21], [0.08, 1.4, 1.4, 0.08], held=True), weak_sink)
    (hot,) = [check for check in found.findings if check.quantity == "hot plate"]
    assert (hot.severity, hot.figures[1], hot.upper) == ("hard", "60", True)
    reason = pulsed().reason
    assert reason.startswith("rate of skin temperature reaches −11.8 K/s at 1.25 s, with contact −30 %")
    assert "below the hard limit of −10 K/s" in reason


def test_the_worst_case_matters() -> None:
    """Green on the rig as given, red within its uncertainty: open loop, nothing corrects a better contact or gain."""
    assert gate(PULSE, PULSED.with_(**CERTAIN)).colour == "green"
    found = pulsed()
    assert found.colour == "red"
    assert found.findings[0].scenario.startswith("contact −30 %, ambient ")
    assert "gain +10 %" in found.findings[0].scenario
    alone = judge_safety(simulate_current(PULSE, PULSED))
    assert (alone.colour, len(alone.checks)) == ("green", len(found.checks)), "one set of rules"


def test_what_follows_matters() -> None:
    """A design that stops at its last corner leaves the current of its return ramp on, and burns."""
    plan = design(STEP, THENAR, 8.0)
    trace = simulate(STEP, THENAR)
    assert judge_safety(trace).colour == "green"
    stopped = gate(plan.drive, sure_rig(), rest_A=plan.rest_A)
    ended = Drive(plan.drive.time_s, [*plan.drive.current_A[:-1], plan.rest_A], held=True)
    assert gate(ended, sure_rig(), rest_A=plan.rest_A).colour == "green"
    assert stopped.colour == "red"
    assert all(finding.scenario == "the rig as given, then last value held" for finding in stopped.findings)
    assert "above the hard limit of 42 °C from 14." in stopped.reason, "6 s after the last sample"
    assert plan.drive.current_A[-1] < plan.rest_A


def test_zero_current_drifts_to_39_degrees() -> None:
    found = resting()
    assert found.drift_C == pytest.approx(39.0, abs=0.1)
    held, none, off = (found.after_C[ending] for ending in ENDINGS)
    assert held == pytest.approx(32.3, abs=0.1)
    assert 36.0 < none < found.drift_C
    assert off == none


def test_a_corner_that_heats_without_end_is_red_and_not_an_error() -> None:
    rig = sure_rig().with_(**{"uncertainty.gain_relative": 0.9})
    found = gate(Drive([0, 1], [-2.5, -2.5]), rig, pause_s=60.0)
    assert found.colour == "red"
    assert "skin surface reaches 1000 °C at" in found.reason
    assert all(math.isfinite(check.value) for check in found.checks)


def test_limits_may_be_given_for_once() -> None:
    tight = gate(REST, sure_rig(), limits=Limits.of({"skin_highest_C": 33.0}))
    assert tight.colour == "red"
    assert resting().colour == "green"
    assert tight.limits.changed == ("skin_highest_C 33 °C instead of 42 °C",)


def test_the_dictionary_tells_all() -> None:
    found = resting()
    assert found.scenarios == 195
    assert (found.reason, found.cautions, found.safe) == (None, (), True)
    assert len(found.checks) == len(Limits.shipped().rules)
    packed = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert packed["colour"] == "green"
    assert packed["findings"] == []
    assert "not a medical or ethical clearance" in packed["what_it_is_not"]
    assert "needs a temperature cut-off of its own" in packed["what_it_is_not"]
    assert set(packed["checks"][0]) == {
        "quantity", "severity", "value", "limit", "unit", "time_s", "since_s", "source", "note", "upper", "scenario",
        "passed", "text",
    }  # fmt: skip


def test_a_limit_that_is_just_exceeded_reads_as_exceeded() -> None:
    check = Check("skin surface", "hard", 42.003, 42.0, "°C", 1.0, 1.0, "source")
    assert str(check).startswith(
        "skin surface reaches 42.003 °C at 1.00 s, above the hard limit of 42 °C from 1.00 s on"
    )
    other = replace(check, quantity="display", value=-0.0004, limit=0.0, upper=False)
    assert "display −0.0004 °C (limit 0)" in more_and_cure([check, other], ())
    assert replace(check, value=41.9999999, since_s=None).figures == ("42", "42")


def test_a_verdict_is_reached_without_the_module_of_words() -> None:
    judged = (
        "import sys; from thermicon.circuit import Drive, Rig, gate\n"
        f"rig = Rig.load('thenar').with_(**{CERTAIN})\n"
        "found = gate(Drive([0, 1, 3, 4], [0.08, -3.0, -3.0, 0.08]), rig)\n"
        "print(found.colour, found.safe, bool(found.findings), 'thermicon.circuit.safety.words' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", judged], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["red", "False", "True", "False"]


@pytest.mark.parametrize(
    ("run", "words"),
    [
        (Scenario("a", ending="zero current"), "a, then zero current"),
        (Scenario((0.0,) * 7, "followed at once"), "the rig as given, followed at once"),
        (Scenario("a", before=Before("cycle", 9.0)), "a, repeated plays with 9 s of pause"),
        (Scenario("a", "x", Before("warm", 2.5), "b"), "a, x, repeated plays with 2.5 s of pause (warm bound), then b"),
        (Scenario("a", before=Before("once", 2.0)), "a, second play after 2 s of pause"),
        (Scenario("a", before=Before("another", 2.0)), "a, after another play and 2 s of pause"),
        (Scenario("a", before=Before("others", 2.0)), "a, after repeated plays of another and 2 s of pause"),
        (Scenario("a", before=Before("any")), "a"),
        (Scenario((0.1, -3.0, 0, 0, 0, 0, 0)), "contact +10 %, ambient −3 K"),
    ],
)  # fmt: skip
def test_each_scenario_has_its_words(run: Scenario, words: str) -> None:
    assert scenario_text(run) == str(run) == words


@pytest.mark.parametrize("cure", get_args(Cure))
def test_each_cure_is_of_some_quantity_and_has_its_words(cure: Cure) -> None:
    at_once = cure == "baseline"
    quantity = "skin surface" if at_once else next(name for name, known in CURE_OF.items() if known == cure)
    check = Check(quantity, "hard", 50.0, 42.0, "°C", 1.0, 0.0 if at_once else 0.5, "source")
    assert cures_of([check]) == (cure,)
    assert (
        more_and_cure([check, check], (cure,))
        == f"; also beyond hard limits: {quantity} 50 °C (limit 42); use {CURES[cure]}"
    )


def test_a_limit_that_counts_from_the_start_says_so() -> None:
    check = Check("skin surface", "soft", 24.0, 24.2, "°C", 1.0, 0.5, "source", 8.0, upper=False)
    assert ", 8 K from where it began, from 0.50 s on" in check_text(check)
    assert {"note", "scenario", "text", "passed"} < set(check.to_dict())
