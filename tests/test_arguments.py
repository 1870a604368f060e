"""What people give by mistake: every public function works, or says in an InputError which argument takes what."""

import importlib
import inspect
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from thermicon.circuit import Drive, InputError, SessionPlan, Trace, simulate
from thermicon.icons import Icon, IconSet, back, cool, from_samples, load_library, read_cue
from thermicon.perception import Condition, Ranking, Selection, Trials, information_bits, rank

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("icons", "circuit", "perception", "notebooks")
DIP = Icon.of("dip", cool(by=4, at=2), back(at=2), control="display", baseline_C=32, site="thenar", means="left")
WRONG = (None, -7, 2.5, float("nan"), True, b"six", "no such thing", [], {}, object(), pd.DataFrame({"a": [1]}), len)
RIGHT: dict[str, Any] = {
    "icon": DIP, "icons": "six-icons", "rig": "thenar", "rigs": ["thenar"], "nominal": "thenar", "end_s": 9.0,
    "drive": Drive([0, 1], [0, 0.1]), "plan": SessionPlan(("cooling-step",)), "logs": "none.csv", "path": "none.csv",
    "condition": Condition("threshold", "limits", "cold", 32.0, 12.0, 1.0, 0.0), "asked": Selection(2),
    "trials": Trials(("a", "b"), ("p",), np.ones((1, 2, 2))), "key": "contact.area_cm2", "values": [4.0],
    "goal": "correct >= 50 %", "a": "cooling-step", "b": "warming-step", "n": 2, "time_s": [0, 1, 2],
    "temperature_C": [32, 30, 32], "text": str(DIP), "ranking": lambda: ranked(), "found": lambda: ranked(),
    "trace": lambda: played(), "d_prime": np.ones((2, 2)), "confusion": np.eye(2), "shape": "sine", "every": 1.0,
    "duration": 1.0, "count": 2, "to": 0.1, "name": "six-icons", "source": "six-icons",
}  # fmt: skip
"""A right value of each argument that has no default."""


@cache
def ranked() -> Ranking:
    return rank("six-icons", people=2, parameters=0)


@cache
def played() -> Trace:
    return simulate(DIP)


def functions() -> list[tuple[str, str]]:
    """Every public function that takes something, with each of its first two arguments."""
    found = []
    for package in PACKAGES:
        door = importlib.import_module(f"thermicon.{package}")
        for name in sorted(door.__all__):
            if inspect.isfunction(getattr(door, name)) and not name.endswith("extension"):
                arguments = [each for each in inspect.signature(getattr(door, name)).parameters if each != "ax"]
                found += [(f"{package}.{name}", argument) for argument in arguments[:2]]
    return found


@pytest.mark.parametrize(("function", "argument"), functions())
def test_a_wrong_argument_works_or_is_an_error_for_people(function: str, argument: str) -> None:
    package, _, name = function.partition(".")
    called = getattr(importlib.import_module(f"thermicon.{package}"), name)
    known = inspect.signature(called).parameters
    for wrong in WRONG:
        if wrong is None and known[argument].default is None:
            continue
        given = {
            each: RIGHT[each] for each in known if known[each].default is inspect.Parameter.empty and each in RIGHT
        }
        given = {each: right() if inspect.isfunction(right) else right for each, right in given.items()}
        first = argument == next(iter(given), argument) and known[argument].kind is not inspect.Parameter.KEYWORD_ONLY
        try:
            if known[argument].kind is inspect.Parameter.VAR_POSITIONAL:
                called(*given.values(), wrong)
            elif first:  # whatever it is called
                called(wrong, **{each: right for each, right in given.items() if each != argument})
            else:
                called(**given | {argument: wrong})
        except InputError as error:
            assert len(str(error)) > 10


def test_the_error_names_the_argument_and_what_it_takes() -> None:
    for call, words in (
        (
            lambda: simulate("six-icons", "thenar"),
            "simulate: icon takes an Icon such as load_library.*, not 'six-icons'$",
        ),
        (
            lambda: rank(pd.DataFrame({"a": [1]})),
            r"rank: icons takes an IconSet .*, a name or a path, not a DataFrame$",
        ),
        (lambda: rank("six-icons", norm="naming"), "rank: norm is called memory now$"),
        (lambda: rank("six-icons", peple=3), r"rank: peple is no argument; did you mean people\?$"),
        (lambda: rank("six-icons", "thenr"), r"thenr: no such rig; did you mean thenar\?$"),
        (
            lambda: Icon.of("a", cool(by=4, at=2), control="skni"),
            "control takes 'skin', 'display' or 'current', not 'skni'",
        ),
    ):
        with pytest.raises(InputError, match=words):
            call()  # type: ignore[no-untyped-call]


def test_information_is_of_proportions() -> None:
    """The wanted bits are those of an independent calculation, with every icon presented equally often."""
    counts = np.array([[8, 2, 0], [1, 9, 0], [0, 0, 10]])
    assert information_bits(counts / 10) == pytest.approx(1.1832, abs=1e-4)
    assert information_bits(np.array([[0.5, 0.4995], [0.5, 0.5]])) == pytest.approx(0.0, abs=1e-3)
    for wrong in (
        counts,
        10 * counts,
        [[1.2, -0.2], [0, 1]],
        [[0, 0], [0, 1]],
        [[0.5, 0.4], [0.4, 0.5]],
        [[0.498, 0.5], [0, 1]],
    ):
        with pytest.raises(InputError, match="divide each row of counts by its sum"):
            information_bits(wrong)


def test_icons_of_code_and_of_arrays_are_read_back_equal(tmp_path: Path) -> None:
    glow = Icon.of("glow", cool(by=1, at=1), back(at=1), control="display", baseline_C=32, site="thenar")
    both = IconSet.of([DIP, glow], "alerts", "Two alerts")
    both.save(tmp_path / "both.cue")
    assert read_cue(tmp_path / "both.cue") == both
    assert (DIP.context.control, DIP.context.baseline_C, DIP.context.site, DIP.metadata.means) == (
        "display",
        32,
        "thenar",
        "left",
    )
    trace = simulate(load_library("six-icons")["cooling-step"])
    trace.to_csv(tmp_path / "trace.csv")
    again = pd.read_csv(tmp_path / "trace.csv")
    icon = from_samples(again.time_s, again.display_C, tolerance_K=0.1)
    assert np.interp(again.time_s, *np.array([icon.corners().time_s, icon.corners().value])) == pytest.approx(
        again.display_C, abs=0.11
    )
    for wrong in (lambda: from_samples([0, 1], [32]), lambda: both.save("both.txt"), lambda: IconSet.of([])):
        with pytest.raises(InputError):
            wrong()


def test_what_pages_say_of_a_name_is_there() -> None:
    """`Trace.to_csv` in a page, for every class at a front door."""
    doors = [importlib.import_module(f"thermicon.{package}") for package in PACKAGES]
    classes = {
        name: getattr(door, name) for door in doors for name in door.__all__ if inspect.isclass(getattr(door, name))
    }
    named = [
        (page.name, *match)
        for page in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))
        for match in re.findall(r"`([A-Z]\w+)\.(\w+)", page.read_text(encoding="utf-8"))
        if match[0] in classes
    ]
    assert len(named) > 10
    wrong = [
        each
        for each in named
        if not hasattr(classes[each[1]], each[2]) and each[2] not in classes[each[1]].__annotations__
    ]
    assert wrong == []
