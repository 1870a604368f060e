"""What a fit notices, and its words."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.base.files.inputs import shipped_table
from thermicon.circuit import Rig
from thermicon.circuit.fitting import notes
from thermicon.circuit.fitting.keys import CONTACT, free_keys
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.fitting.notes import ALIKE, Noticed, beyond_noise, disagreement, remarks
from thermicon.circuit.fitting.overlay import aligned
from thermicon.circuit.fitting.problem import OFFSET_SD_K, FitProblem
from thermicon.circuit.fitting.runs import runs_of
from thermicon.circuit.fitting.solve import Solution, solve

Fitted = tuple[FitProblem, Solution]


@pytest.fixture(scope="module")
def fitted(log: Log, true_rig: Rig) -> Fitted:
    """The contact of a log, whose other keys are those of the rig."""
    problem = FitProblem.of(
        true_rig, free_keys((CONTACT,), true_rig, False), aligned(true_rig, runs_of([log], true_rig)), OFFSET_SD_K, True
    )
    return problem, solve(problem)


def test_each_cause_has_words_and_all_words_a_cause() -> None:
    code = Path(notes.__file__).read_text(encoding="utf-8") + Path(notes.__file__).with_name("fit.py").read_text(
        "utf-8"
    )
    named = set(re.findall(r'"([a-z-]+)"', code))
    assert set(shipped_table("fit-words.toml")) <= named
    assert set(re.findall(r'Noticed\("([a-z-]+)"', code)) <= set(shipped_table("fit-words.toml"))


def test_of_several_causes_the_first_is_told(fitted: Fitted, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, solution = fitted
    missed, late = beyond_noise(problem, solution.theta, [2.0 * ALIKE, 2.0 * ALIKE]), Noticed("unrested")
    assert len(missed) == 2

    def told(some: tuple[Noticed, ...], column: Noticed | None = None, of: Solution = solution) -> tuple[str, str]:
        noticed, why = disagreement(problem, of, some, column, ())
        return " / ".join(map(str, noticed)), str(why)

    unrested = replace(solution, converged=False)
    assert told(missed, late, unrested) == (str(late), "the columns of a log are not of one time")
    words, why = told(missed, of=unrested)
    assert words.endswith(" / free fewer keys, so that the fit comes to rest") and why == "the fit did not come to rest"
    assert told(missed) == (" / ".join(map(str, missed)), "the rig leaves something out of the logs")
    assert told(()) == ("", "None")
    monkeypatch.setattr(notes, "beyond_noise", lambda *_: missed)
    for keys, cure in (
        ([], "something that is not a key of the rig may be wrong"),
        (["a", "b"], "free a or b as well"),
    ):
        monkeypatch.setattr(notes, "explaining", lambda *_, keys=keys: keys)
        words, why = told(missed)
        assert words.endswith(f"what is held fixed is taken as right: {cure}")
        assert why == "the rig does not match the logs within their noise"


def test_neighbours_are_alike_above_three_alone(fitted: Fitted) -> None:
    problem, solution = fitted
    assert beyond_noise(problem, solution.theta, [ALIKE, ALIKE]) == ()
    first, second = map(str, beyond_noise(problem, solution.theta, [1.01 * ALIKE, 4.0 * ALIKE]))
    assert first.endswith("so that the rig leaves something out; intervals are 1.7 times as wide as its noise alone "
                          "would make them")  # fmt: skip
    assert "voltage_V: neighbouring" in second and "intervals are 3.5 times" in second


def test_a_clock_is_told_with_its_file_as_it_is_called(log: Log, true_rig: Rig) -> None:
    columns: Any = dict(log.columns)
    drive = Log.of("my-daq.csv", {"time_s": log.time_s, **{name: columns[name] for name in ("current_A", "voltage_V")}})
    meter = Log.of("my-meter.csv", {"time_s": log.time_s + 100.0, "display_C": columns["display_C"]})
    runs = aligned(true_rig, runs_of([drive, meter], true_rig))
    problem = FitProblem.of(true_rig, free_keys((CONTACT,), true_rig, False), runs, OFFSET_SD_K, True)
    (clock,) = map(str, remarks(problem, np.asarray(problem.first)))
    assert clock.startswith("my-meter.csv: its clock was shifted by −100.0")
    assert " s against my-daq.csv, and drifts by 0 parts per million" in clock
