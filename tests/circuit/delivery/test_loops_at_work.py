"""Evidence that permitted controllers stay inside every limit.

The ordinary suite has one export; `-m slow` has 200 of shipped and made-up cues on shipped rigs, twelve controllers
each, or as many as THERMICON_EVIDENCE says.
"""

import json
import os
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
import pytest

from tests.circuit.delivery.adversarial import BASES, between
from tests.circuit.delivery.benches import Loop
from tests.circuit.delivery.exported_files import Course, read_file, sidecar_in
from tests.circuit.delivery.followed import Follower
from tests.circuit.delivery.independent import Circuit, Json, worlds_of
from tests.circuit.delivery.lanes import Lanes
from tests.circuit.delivery.loops_at_work import Controllers, at_work
from tests.circuit.delivery.one_drive import icon_of, prepare, worst_case
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.safety.demands import Demands
from thermicon.circuit.safety.gate import Gate
from thermicon.icons import Icon, load_library

EXPORTS = min(200, int(os.environ.get("THERMICON_EVIDENCE", "200")))
SETS = ("six-icons", "wave-shapes", "pulse-sequences")
EACH, FAULTS = 6, 25


def some_icon(rng: np.random.Generator) -> Icon:
    """A shipped icon, or steps, ramps and pulses about a baseline."""
    if rng.random() < 0.4:
        icons = [one for one in load_library(str(rng.choice(SETS))) if one.context.control != "current"]
        return icons[int(rng.integers(len(icons)))]
    way, other = ("warm", "cool") if rng.random() < 0.6 else ("cool", "warm")
    size, rate = between(rng, 0.5, 8.0), between(rng, 0.5, 5.0)
    shape = f"{way} by {size} °C at {rate} °C/s; hold for {between(rng, 0.1, 4)} s"
    kind = rng.random()
    if kind < 0.3:
        shape += f"; {other} by {between(rng, 0.2, 1.5) * size:.2f} °C at 3 °C/s; hold for 0.5 s"
    elif kind < 0.7:
        shape += f"; return at {between(rng, 0.5, 4)} °C/s"
    control = "display" if rng.random() < 0.7 else "skin"
    return icon_of(shape, control, f"{rng.uniform(30, 34):.1f}")


def some_export(number: int, quick: bool = False) -> tuple[str, list[str], int]:
    """One export by chance: what was unsafe, and how many controllers played it; none where it was not written."""
    rng = np.random.default_rng([33, number])
    rig, icon = Rig.load(str(rng.choice(BASES))), some_icon(rng)
    if quick:
        rig = rig.with_(**{"driver.update_Hz": 20.0})
    form = load_format("setpoint-csv")
    try:
        ready = prepare(icon, rig, Device.load("closed-loop-controller"), form)
    except ValueError:
        return "", [], 0
    if ready.refusals:
        return "", [], 0
    files, stem = pack([ready], form), form.stem(icon.name)
    told, course = sidecar_in(files, stem), read_file(files, stem)
    assert isinstance(course, Course)
    demands, what = told["hardware_must_prevent"], f"#{number} {rig.name} {' '.join(str(icon).split())}"
    plays, pause = int(rng.choice([1, 2, 20], p=[0.4, 0.5, 0.1])), float(demands["pause_at_least_s"])
    inside = Controllers.within(demands["loop"], rng, EACH)
    beyond = Controllers.of_any_kind(demands["loop"], rng, EACH)
    document, found = told["rig"]["document"], []
    for kind, which in (("inside", inside), ("beyond", beyond)):
        within = kind == "inside"
        worst = at_work(
            document, demands, course, which, rng, plays if within else 1, pause, doses=within,
            faults=(FAULTS if number % 4 == 0 else 5) if within else 0,
        )  # fmt: skip
        if worst.unsafe:
            found.append(f"{what}: {kind} the demands: {worst.unsafe}")
    return what, found, 2 * EACH


def test_a_few_controllers_stay_inside_every_limit() -> None:
    what, found, _ = some_export(1, quick=True)
    assert what
    assert found == []


def test_beyond_the_demanded_current_the_same_controllers_pass_a_limit() -> None:
    form = load_format("setpoint-csv")
    rig = Rig.load("thenar").with_(**{"driver.update_Hz": 20.0, "skin.elements": [1] * 5})
    icon = icon_of("warm by 6 °C at 2 °C/s; hold for 1 s")
    files = pack([prepare(icon, rig, Device.load("closed-loop-controller"), form)], form)
    told, course = sidecar_in(files, "a"), read_file(files, "a")
    assert isinstance(course, Course)
    demands: dict[str, Any] = told["hardware_must_prevent"]
    rng = np.random.default_rng(1)
    which = Controllers.of_any_kind(demands["loop"], rng, 12)
    safe = at_work(told["rig"]["document"], demands, course, which, rng, 1, 0.0, doses=False)
    assert not safe.unsafe
    stronger = demands | {"current_limit_A": [-4.0, 4.0]}
    assert "rate" in at_work(told["rig"]["document"], stronger, course, which, rng, 1, 0.0, doses=False).unsafe
    blind = demands | {"cut_off_display_C": {"low": -50.0, "high": 90.0, "react_within_s": 1.0}}
    which.offset_K[:] = -8.0
    hot = at_work(told["rig"]["document"], blind, course, which, rng, 1, 0.0, doses=False)
    assert "skin high" in hot.unsafe, "a sensor that is wrong needs the second one"


def hottest_of_a_stuck_loop(rig: Rig, demands: Demands, wrong_K: float) -> float:
    """Skin in °C at worst: display at the cut-off as a wrong sensor shows it, for good, then full heat, then none."""
    follower, cut = Follower(json.loads(rig.document), np.random.default_rng(0), extra=0), demands.cut_off_display_C
    assert demands.current_limit_A is not None
    state, hottest = follower.rest(cut.high + wrong_K)[:, :, None], -np.inf
    for amperes, length_s in ((demands.current_limit_A[0], cut.react_within_s), (0.0, 5.0)):
        move, add = follower.modes(amperes * follower.circuit.gain).step(0.005)
        for _ in range(round(length_s / 0.005)):
            state = move @ state + add
            hottest = max(hottest, float(follower.circuit.read(state)[:, 0].max()))
    return hottest


def test_a_cut_off_keeps_the_limit_with_a_sensor_wrong_by_0_3_K_and_asks_for_no_more() -> None:
    rig = sure_rig().with_(**{"driver.update_Hz": 20.0, "skin.elements": [1] * 5})
    icon, controller = icon_of("warm by 6 °C at 2 °C/s; hold for 1 s"), Device.load("closed-loop-controller")

    def judged(highest_C: float) -> Gate:
        return worst_case(deliver(icon, rig.with_(**{"safety.skin_highest_C": highest_C}), controller))

    def demanded(highest_C: float) -> Demands:
        found = judged(highest_C)
        assert found.safe, found.reason
        return found.demands

    usual = demanded(42.0)
    wrong_C, right_C = (hottest_of_a_stuck_loop(rig, usual, wrong_K) for wrong_K in (0.3, 0.0))
    assert right_C + 0.1 < wrong_C < 42.9, "a kelvin above the limit, in a fault"
    kept, near = demanded(wrong_C - 1.0 + 0.12), demanded(wrong_C - 1.0 - 0.04)
    assert (kept.cut_off_display_C, kept.current_limit_A) == (usual.cut_off_display_C, usual.current_limit_A)
    assert hottest_of_a_stuck_loop(rig, near, 0.3) < wrong_C - 0.04, "tighter, though a right sensor needs it not"


def exported(changes: dict[str, float]) -> tuple[Loop, Json]:
    """A loop on the independent circuit of a small rig, with what its export demands, which is green."""
    rig = sure_rig().with_(**{"driver.update_Hz": 20.0, "skin.elements": [1] * 5}, **changes)
    icon, form = icon_of("warm by 1 °C at 2 °C/s; hold for 1 s"), load_format("setpoint-csv")
    ready = prepare(icon, rig, Device.load("closed-loop-controller"), form)
    assert not ready.refusals
    files = pack([ready], form)
    course, demands, document = read_file(files, "a"), ready.verdict.demanded, json.loads(rig.document)
    assert isinstance(course, Course)
    lanes = Lanes.of(Circuit.of(document, worlds_of(document)))
    return Loop(lanes, course, demands, rig.driver.update_Hz, np.random.default_rng(0)), demands


def test_a_driver_stuck_while_the_display_is_warm_keeps_the_hot_plate_within_its_limit() -> None:
    poor = {"heat_sink.resistance_K_per_W": 0.6, "module.hot_plate_J_per_K": 1.5}

    def hottest(highest_C: float) -> tuple[float, float]:
        """The hot plate until the cut-off has acted, and the current limit, at a limit of its own."""
        bench, demands = exported(poor | {"safety.hot_plate_highest_C": highest_C})
        cut, flows = demands["cut_off_display_C"], bench.settling(demands["cut_off_display_C"]["high"])
        state, most = bench.lanes.steady(flows, flows**2), bench.flow(demands["current_limit_A"][1])
        ends = np.array([[cut["low"], np.inf, cut["react_within_s"], -1e9, 1e9, 1e9]])
        return float(bench.lanes.hold(state, bench.every, most, 60.0, ends)[0, 7]), float(most[0, 0])

    usual_C, usual_A = hottest(60.0)
    assert hottest(usual_C + 1.0) == (usual_C, usual_A), "no narrower than it must be"
    assert hottest(usual_C - 0.2)[0] < usual_C - 0.2


def test_a_loop_that_stays_at_its_limit_leaves_the_display_inside_the_cut_off() -> None:
    """From no power it runs there, where it then cools less than with less current."""
    weak = {"heat_sink.temperature_C": 38.0, "module.seebeck_V_per_K": 0.0214}
    for driver_A, too_strong in ((1.75, False), (2.2, True)):
        bench, demands = exported(weak | {"driver.current_limit_A": driver_A})
        given, high = (-driver_A, driver_A), demands["cut_off_display_C"]["high"]
        assert (demands["current_limit_A"] != given) == too_strong
        assert bench.wait(bench.unpowered(), 120.0)[0, 5] < high
        bench.least, bench.most = (end * bench.gain for end in given)
        bench.loop[:, 4:6] = given
        assert (bench.wait(bench.unpowered(), 120.0)[0, 5] > high) == too_strong


def test_a_loop_that_swings_when_one_update_late_is_told_to_be_quicker_and_a_weaker_one_is_not() -> None:
    shape, controller = "cool by 3 °C at 2 °C/s; hold for 1 s; return at 2 °C/s", Device.load("closed-loop-controller")
    delays_s = []
    for kp in (2.5, 1.0):
        gains = {"kp_A_per_K": kp, "ki_A_per_Ks": 0.25 * kp, "lag_s": 0.1}
        rig = sure_rig().with_(**{"driver.update_Hz": 20.0, "skin.elements": [1] * 5}, controller=gains)
        found = worst_case(deliver(icon_of(shape), rig, controller))
        assert found.safe and found.demands.loop is not None, found.reason
        delays_s.append(found.demands.loop.delay_at_most_s)
    assert delays_s[0] < 0.05 <= delays_s[1]


@pytest.mark.slow
def test_controllers_inside_the_demands_stay_inside_every_limit() -> None:
    written, played, unsafe, number = 0, 0, [], 100
    with ProcessPoolExecutor(2) as pool:
        while written < EXPORTS:
            some = range(number, number + max(2, EXPORTS // 10))
            for what, found, count in pool.map(some_export, some):
                written, played, unsafe = written + bool(what), played + count, [*unsafe, *found]
            number = some.stop
            assert number < 100 + 10 * EXPORTS, "a gate that refuses everything is safe and of no use"
    print(f"{written} of {number - 100} exports were written, and played by {played} controllers")
    assert unsafe == []
