"""Results of every public function outlive the program: they are pickled, copied, compared and printed."""

import copy
import inspect
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.circuit.surerig import sure_rig
from tests.perception.pilot.madeup import USUAL, synthetic_measurements, synthetic_trials
from thermicon import circuit, icons, perception
from thermicon.circuit import Rig
from thermicon.perception import Ranking

PAIR = icons.parse(
    "cue 1\nset pair { site thenar; control display; baseline 32 °C }\n"
    "icon dip(depth in 4..6 step 2 °C) { cool by depth at 3 °C/s; hold for 1 s; return at 3 °C/s }\n"
    "icon glow { warm by 4 °C at 3 °C/s; hold for 1 s; return at 3 °C/s }\n"
)
DIP, OTHER, GLOW = PAIR
FIRST, LAST, FEW = "dip_depth=4", "dip_depth=6", {"people": 4, "parameters": 0}
THENAR = Rig.load("thenar")
BY_IDENTITY = (
    *("Batch", "Design", "Drive", "Export", "RigFit", "LiveResult", "Session", "Trace", "InputError"),
    *("Percept", "Ranking", "Choice", "Confusion", "People", "Trials", "Measurements", "Observed"),
)
"""Results of which a copy is another one: they hold arrays, or are raised."""


def drive() -> circuit.Drive:
    return circuit.Drive([0.0, 5.0, 10.0], [0.0, 0.2, 0.0])


def ranking() -> Ranking:
    """With intervals, and the constants that act already asked for."""
    ranked = perception.rank(PAIR, THENAR, people=4, parameters=4)
    assert ranked.new_laboratory is not None and ranked.new_laboratory.each.acting().any()
    return ranked


def fitted() -> object:
    trace = circuit.simulate_current(drive(), THENAR)
    columns = {"time_s": trace.time_s, "current_A": trace.current_A, "display_C": trace.display_C}
    return circuit.fit(pd.DataFrame(columns)[::20], THENAR, free="contact.resistance_m2K_per_W")


RESULTS: dict[str, Callable[[], Any]] = {
    "parse": lambda: PAIR,
    "load_library": lambda: icons.load_library("search-space"),
    "library": icons.library,
    "from_samples": lambda: icons.from_samples(np.arange(40) / 4, 32.0 - np.r_[:20, 20:0:-1] / 5, name="dip"),
    "wave": lambda: icons.wave("sine", by=3, every=4, duration=12),
    "Rig": lambda: THENAR,
    "Limits": lambda: THENAR.limits,
    "Device": lambda: circuit.Device.load("dac-16"),
    "Drive": drive,
    "simulate": lambda: circuit.simulate(DIP, THENAR),
    "Outcome": lambda: circuit.simulate(DIP, THENAR).outcome,
    "simulate_many": lambda: circuit.simulate_many(PAIR, [THENAR], nominal=THENAR, end_s=6.0),
    "design": lambda: circuit.design(DIP, THENAR, 6.0),
    "nearest_reachable": lambda: circuit.nearest_reachable(icons.Icon.of("steep", icons.cool(by=20, at=20)), THENAR),
    "gate": lambda: circuit.gate(drive(), sure_rig()),
    "play_session": lambda: circuit.play_session(PAIR, circuit.SessionPlan((FIRST, "glow")), THENAR),
    "export": lambda: circuit.export([GLOW], sure_rig(), "dac-16", "csv"),
    "fit": fitted,
    "play_live": lambda: circuit.play_live(GLOW, sure_rig()),
    "InputError": lambda: circuit.InputError("nothing"),
    "Observer": perception.Observer.load,
    "draw_people": lambda: perception.draw_people(3),
    "perceive": lambda: perception.perceive(circuit.simulate(DIP, THENAR)),
    "measure": lambda: perception.measure(USUAL[0], THENAR),
    "confuse": lambda: perception.confuse(2.0 - 2.0 * np.eye(3)),
    "rank": ranking,
    "Goal": lambda: perception.Goal.parse("90 % felt-and-named"),
    "judge_goal": lambda: perception.judge_goal("correct >= 50 %", ranking()),
    "choose": lambda: perception.choose(ranking(), perception.Selection(2)),
    "cheapest_edit": lambda: perception.cheapest_edit(ranking(), FIRST, LAST),
    "frontier": lambda: perception.frontier(PAIR, THENAR, most=3, **FEW),
    "search": lambda: perception.search(PAIR, THENAR, count=2, evaluations=4, **FEW),
    "plan": lambda: perception.plan(PAIR, THENAR, participants=[4], trials=[6], draws=20),
    "read_trials": lambda: synthetic_trials(PAIR, THENAR, participants=3, trials=12, seed=1),
    "read_measurements": lambda: synthetic_measurements(THENAR, participants=4),
    "observed": lambda: perception.observed(synthetic_measurements(THENAR, participants=4), PAIR, THENAR, draws=20),
}
NO_RESULTS = (
    *("back", "cool", "current", "hold", "play", "pulse", "ramp", "repeat", "rest", "step", "total", "warm"),
    *("format_text", "to_json", "netlist", "information_bits", "plot"),
    *("read_cue", "from_csv", "read_drive", "simulate_current", "validate"),
)
"""Statements as `wave`, texts and arrays, and what has another one's result; the report has a test of its own."""


def test_every_public_function_is_here() -> None:
    doors = (icons, circuit, perception)
    functions = {name for door in doors for name in door.__all__ if inspect.isfunction(getattr(door, name))}
    assert functions <= {*RESULTS, *NO_RESULTS}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_pickled_copied_compared_and_printed(name: str) -> None:
    result = RESULTS[name]()
    kind = type(result).__name__
    for again in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
        assert type(again) is type(result) and again is not None
        assert (str(again), repr(again)) == (str(result), repr(result)) and len(repr(again)) < 2000
        assert again == result or kind in BY_IDENTITY
