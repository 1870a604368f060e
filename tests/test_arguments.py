"""Wrong arguments of every public function: accepted, or an InputError that names argument and cure."""

import contextlib
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
from thermicon.perception import Condition, Crowd, Ranking, Selection, Trials, information_bits, rank

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("icons", "circuit", "perception", "notebooks")
DIP = Icon.of("dip", cool(by=4, at=2), back(at=2), control="display", baseline_C=32, site="thenar", means="left")
WRONG = (None, -7, 2.5, float("nan"), True, b"six", "no such thing", [], {}, object(), pd.DataFrame({"a": [1]}), len)
RIGHT: dict[str, Any] = {
    "icon": DIP, "icons": "six-icons", "rig": "thenar", "rigs": ["thenar"], "nominal": "thenar", "end_s": 9.0,
    "drive": Drive([0, 1], [0, 0.1]), "plan": SessionPlan(("cooling-step",)), "logs": "none.csv", "path": "none.csv",
    "condition": Condition("threshold", "limits", "cold", 32.0, 12.0, 1.0, 0.0), "asked": Selection(2),
    "trials": Trials(("a", "b"), ("p",), np.ones((1, 2, 2))), "key": "contact.area_cm2", "values": [4.0],
    "goal": "named >= 50 %", "a": "cooling-step", "b": "warming-step", "n": 2, "time_s": [0, 1, 2],
    "temperature_C": [32, 30, 32], "text": str(DIP), "ranking": lambda: ranked(), "found": lambda: ranked(),
    "trace": lambda: played(), "d_prime": np.ones((2, 2)), "confusion": np.eye(2), "shape": "sine", "every": 1.0,
    "duration": 1.0, "count": 2, "to": 0.1, "name": "six-icons", "source": "six-icons",
    "current_A": [0, 0.1], "order": ["cooling-step"],
    "kind": "threshold", "method": "limits", "channel": "cold", "baseline_C": 32.0, "size_K": 12.0,
    "rate_K_per_s": 1.0, "hold_s": 0.0,
}  # fmt: skip
"""A right value of each argument that has no default."""
VARIABLE = inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD
CLASSES = ("Condition", "Crowd", "Drive", "Selection", "SessionPlan", "Task", "Workbench")
"""Classes that people call themselves."""


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
            if (inspect.isfunction(getattr(door, name)) or name in CLASSES) and not name.endswith("extension"):
                arguments = [each for each in inspect.signature(getattr(door, name)).parameters if each != "ax"]
                found += [(f"{package}.{name}", argument) for argument in arguments[:2]]
    return found


@pytest.mark.parametrize(("function", "argument"), functions())
def test_a_wrong_argument_works_or_is_an_error_for_people(function: str, argument: str) -> None:
    package, _, name = function.partition(".")
    called = getattr(importlib.import_module(f"thermicon.{package}"), name)
    known = inspect.signature(called).parameters
    without_default = [each for each in known.values() if each.default is each.empty and each.kind not in VARIABLE]
    needed = [each.name for each in without_default if each.name != argument]
    assert RIGHT.keys() >= set(needed), "write a right value of it into RIGHT"
    given = {each: RIGHT[each]() if inspect.isfunction(RIGHT[each]) else RIGHT[each] for each in needed}
    alone = [] if known[argument].kind is not inspect.Parameter.VAR_POSITIONAL else [*given.values()]
    for wrong in WRONG if known[argument].default is not None else WRONG[1:]:
        words = {} if alone else given | {argument: wrong}
        first = [words.pop(argument)] if argument == next(iter(known)) and known[argument].kind.value < 2 else []
        with contextlib.suppress(InputError):  # or it works
            called(*first, *alone, *([wrong] if alone else []), **words)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ('simulate("six-icons")', "simulate: icon takes an Icon such as load_library.*, not 'six-icons'$"),
        ("rank(WRONG[-2])", "rank: icons takes an IconSet .*, a name or a path, not a DataFrame$"),
        ('rank("six-icons", intervals=8)', "rank: intervals is called parameters in Python$"),
        ('rank("six-icons", peple=3)', r"rank: peple is not an argument; did you mean people\?$"),
        ('rank("six-icons", "thenr")', r"thenr: no such rig; did you mean thenar\?$"),
        ('Icon.of("a", cool(by=4, at=2), control="skni")', "control takes 'skin', 'display' or 'current', not 'skni'"),
        ("from_samples([0, 1], [32])", "2 times for 1 temperatures; give as many of both"),
        ('IconSet.of(DIP).save("dip.txt")', "call it dip.cue"),
        ("IconSet.of([])", "at least one icon"),
        ("rank([DIP, None])", r"a path, but icons\[1\] is None$"),
        ("cool(by=4)", "^cool: needs either at or over, and not both$"),
        ("cool(by=4, over=-1)", "^cool: over = -1.0: a time is positive$"),
        ("hold(-1)", "^hold: duration = -1.0: a time is positive$"),
        ("current(to=99, at=1)", "^current: to = 99.0: 99 A is outside"),
        ('export([DIP, Icon.of("dip", hold(1))])', "two icons are called dip; give each a name of its own$"),
        ("play_session([DIP, DIP], SessionPlan(['dip']))", "two icons are called dip"),
        ('Rig.load("thenar").with_(contact=4)', "^contact: this is a table; name one of its keys, such as contact"),
        ('Rig.load("thenar").with_set("contact.area_cm2=4")', "settings takes a list, each a text, not 'contact"),
    ],
)
def test_the_error_names_the_argument_and_what_it_takes(call: str, words: str) -> None:
    doors = [importlib.import_module(f"thermicon.{package}") for package in PACKAGES]
    names = {name: getattr(door, name) for door in doors for name in door.__all__}
    with pytest.raises(InputError, match=words):
        eval(call, globals() | names)


def test_an_error_of_a_function_that_is_handed_in_is_not_ours() -> None:
    def progress(done: int, total: int) -> None:
        raise ValueError("mine")

    with pytest.raises(ValueError, match=r"^mine$") as told:
        rank("six-icons", people=2, parameters=0, progress=progress)
    assert type(told.value) is ValueError


def test_a_crowd_and_its_words_are_the_same_people() -> None:
    crowd = Crowd(people=3, memory="naming")
    assert rank("six-icons", crowd=crowd, people=2, parameters=0) != ranked()
    assert rank("six-icons", crowd=crowd, people=2, memory="both", parameters=0).to_json() == ranked().to_json()
    assert ranked().crowd.but(observer=None) == Crowd(people=2)


def test_information_is_of_proportions() -> None:
    """The wanted bits are those of an independent calculation, with every icon presented equally often."""
    counts = np.array([[8, 2, 0], [1, 9, 0], [0, 0, 10]])
    assert information_bits(counts / 10) == pytest.approx(1.1832, abs=1e-4)
    assert information_bits(np.array([[0.5, 0.4995], [0.5, 0.5]])) == pytest.approx(0.0, abs=1e-3)
    negative, empty, cut, below = (
        [[1.2, -0.2], [0, 1]],
        [[0, 0], [0, 1]],
        [[0.5, 0.4], [0.4, 0.5]],
        [[0.498, 0.5], [0, 1]],
    )
    for wrong in (counts, 10 * counts, negative, empty, cut, below):
        with pytest.raises(InputError, match="divide each row of counts by its sum"):
            information_bits(wrong)


def test_icons_of_code_and_of_arrays_are_read_back_equal(tmp_path: Path) -> None:
    glow = Icon.of("glow", cool(by=1, at=1), back(at=1), control="display", baseline_C=32, site="thenar")
    both = IconSet.of([DIP, glow], "alerts", "Two alerts")
    both.save(tmp_path / "both.cue")
    assert read_cue(tmp_path / "both.cue") == both
    context = DIP.context
    assert (context.control, context.baseline_C, context.site, DIP.metadata.means) == ("display", 32, "thenar", "left")
    simulate(load_library("six-icons")["cooling-step"]).to_csv(tmp_path / "trace.csv")
    again = pd.read_csv(tmp_path / "trace.csv")
    corners = from_samples(again.time_s, again.display_C, tolerance_K=0.1).corners()
    assert np.interp(again.time_s, corners.time_s, corners.value) == pytest.approx(again.display_C, abs=0.11)


def test_what_pages_say_of_a_name_is_there() -> None:
    """Each public class has the methods by which README and pages call it, such as `Trace.to_csv`."""
    doors = [importlib.import_module(f"thermicon.{package}") for package in PACKAGES]
    pages = [page.read_text(encoding="utf-8") for page in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))]
    said = {match for page in pages for match in re.findall(r"`([A-Z]\w+)\.(\w+)", page)}
    named = [(getattr(door, name), own) for name, own in said for door in doors if name in door.__all__]
    assert len(named) > 10
    assert [each for each in named if not hasattr(*each) and each[1] not in each[0].__annotations__] == []
