"""Verdicts are records: no sentence is needed to reach one, and each record has its words."""

import subprocess
import sys
from typing import get_args

import pytest

from thermicon.circuit.safety.checks import CURE_OF, Before, Check, Cure, Scenario, cures_of
from thermicon.circuit.safety.words import CURES, check_text, more_and_cure, scenario_text

JUDGED = """
import sys
from thermicon.circuit import Drive, Rig, gate
from thermicon.circuit.safety.display import DisplayCourse
from thermicon.circuit.safety.gate import gate_shown
import numpy as np
rig = Rig.load("thenar").with_(**{
    **{f"uncertainty.{key}_relative": 0 for key in ("contact_resistance", "gain", "seebeck", "conductance", "plates")},
    "uncertainty.reason": "a test in the fewest corners"})
hot = gate(Drive([0, 1, 3, 4], [0.08, -3.0, -3.0, 0.08]), rig)
shown = gate_shown([[DisplayCourse("at once", 0.01, np.linspace(32.0, 36.0, 200))]], rig, stuck_C=(5.0, 45.0))
told = (hot.colour, hot.safe, hot.mended_by_pause, bool(hot.findings), len(hot.demands.faults), shown[0].colour)
words = [name for name in sys.modules if "words" in name and name.startswith("thermicon.circuit.safety")]
print(told, words, sep="\\n")
"""


def test_a_verdict_is_reached_without_the_module_of_words() -> None:
    done = subprocess.run([sys.executable, "-c", JUDGED], capture_output=True, text=True, check=True)
    told, words = done.stdout.splitlines()
    assert told.startswith("('red', False, False, True, 4, ")
    assert words == "[]"


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
    assert more_and_cure([check, check]) == f"; also beyond hard limits: {quantity} 50 °C (limit 42); use {CURES[cure]}"


def test_a_limit_that_counts_from_the_start_says_so() -> None:
    check = Check("skin surface", "soft", 24.0, 24.2, "°C", 1.0, 0.5, "source", 8.0, upper=False)
    assert ", 8 K from where it began, from 0.50 s on" in check_text(check)
    assert {"note", "scenario", "text", "passed"} < set(check.to_dict())
