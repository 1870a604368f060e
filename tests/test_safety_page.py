"""The constants, tests and files that docs/explain/safety.md names."""

import ast
import re
from pathlib import Path

from tests.circuit.safety.test_single_faults import BEGINNINGS
from thermicon.circuit import Rig, SessionPlan, play_session
from thermicon.circuit.rig.rules import LONGEST_SESSION_MIN, Limits
from thermicon.circuit.safety.current import ENDINGS
from thermicon.circuit.safety.held import BEYOND_K
from thermicon.circuit.safety.plant import RECOVERED_K
from thermicon.circuit.safety.polarity import TEST_A, TEST_S
from thermicon.circuit.safety.repeated import LONGEST_PAUSE_S
from thermicon.circuit.safety.single_faults import INSTANTS, MARGIN, REACTIONS_S
from thermicon.circuit.safety.spans import ENDING_S, LATER_S
from thermicon.icons import load_library

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "explain" / "safety.md"
NAMED = re.compile(r"`?(tests/[\w/]+\.py)(?:::(\w+))?")
FILE = re.compile(r"`((?:base|icons|circuit|perception|notebooks)/[\w./-]+\.\w+)`")


def test_the_constants_without_a_source_are_those_of_the_code() -> None:
    text = re.sub(r"\s+", " ", PAGE.read_text(encoding="utf-8"))
    assert set(ENDINGS) == {"last value held", "zero current", "power off"}
    for words in (
        f"session of {Limits.shipped().session_s / 60:g} min",
        f"1 to {LONGEST_SESSION_MIN:g} min",
        f"{ENDING_S:g} s of each ending",
        f"{LATER_S / 60:g} min of zero current",
        f"within {RECOVERED_K:g} K of rest",
        f"0 to {LONGEST_PAUSE_S:g} s",
        f"{MARGIN:g} of the time",
        f"{BEYOND_K:g} K beyond",
        f"{TEST_A:g} A for {TEST_S:g} s",
        f"{INSTANTS} stretches of the drive",
        f"{', '.join(f'{one:g}' for one in REACTIONS_S[:0:-1])} or {REACTIONS_S[0]:g} s",
    ):
        assert words in text, words


def test_the_beginnings_that_the_page_names_are_those_from_which_faults_are_tried() -> None:
    """`tests/circuit/safety/test_single_faults.py` draws states of each of them and finds them between the bounds."""
    assert tuple(re.findall(r"^\| `([a-z ]+)` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)) == BEGINNINGS


def test_a_session_of_a_closed_loop_is_judged_in_the_open_loop_scenarios() -> None:
    page, rig = " ".join(PAGE.read_text(encoding="utf-8").split()), Rig.load("thenar")
    plan = SessionPlan(("cooling-step",), 10.0)
    looped = play_session(load_library("six-icons"), plan, rig, tracking="display")
    assert f"**is judged in the {looped.scenarios} open-loop scenarios too**" in page
    coldest = next(check for check in looped.checks if check.quantity == "display" and not check.upper)
    assert coldest.value < looped.trace.display_C.min() - 1.0, "a loop would not let the display go so far"


def faults_of(text: str) -> list[str]:
    """What a page names that does not exist: a test file, a test in it, or a file of the project."""
    found = [f"{name}: no such file" for name in FILE.findall(text) if not (ROOT / name).is_file()]
    for file, test in NAMED.findall(text):
        if not (ROOT / file).is_file():
            found.append(f"{file}: no such file")
        elif test and test not in named_in(ROOT / file):
            found.append(f"{file}::{test}: no such test")
    return found


def named_in(path: Path) -> set[str]:
    """Names of the test functions of a file, those in classes included."""
    tree = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.name[:5] == "test_"}


def test_every_file_and_test_that_the_page_names_exists() -> None:
    assert faults_of(PAGE.read_text(encoding="utf-8")) == []
    text = "`tests/none.py`, `tests/test_house.py::test_none`, `circuit/none.py`, `tests/test_house.py`"
    files = [f"{name}: no such file" for name in ("circuit/none.py", "tests/none.py")]
    assert faults_of(text) == [*files, "tests/test_house.py::test_none: no such test"]
