"""A thermode rig: a prescribed display above the skin."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.builders import missing
from tests.circuit.delivery.one_drive import icon_of
from thermicon.circuit import Drive, Rig, design, netlist, simulate, simulate_current, simulate_many
from thermicon.circuit.rig.rigfile import RigError, read_table
from thermicon.circuit.safety.verdict import summarise
from thermicon.circuit.solver.trace import write_trace
from thermicon.icons import load_library, parse

RIG = Rig.load("tcs2")
STEP = load_library("six-icons")["cooling-step"]
SKIN = load_library("cooling-step-skin").icons[0]
PROMPT = RIG.with_(**{"thermode.lag_s": 0.0})


def test_the_display_is_what_the_cue_prescribes_behind_the_lag() -> None:
    trace = simulate(STEP, RIG)
    coarse, fine = (simulate(STEP, RIG, rate_Hz=rate) for rate in (10.0, 1000.0))
    assert coarse.skin_C == pytest.approx(trace.skin_C[::10], abs=1e-9)
    assert fine.skin_C[::10] == pytest.approx(trace.skin_C, abs=1e-3)
    probed = simulate(STEP, RIG.with_(probe=[{"name": "deep", "place": "skin", "depth_mm": 0.122}]))
    assert probed.probe("deep") == pytest.approx(trace.cold_receptor_C, abs=1e-9)
    assert trace.outcome is not None and trace.outcome.reached  # a lag is a delay and not a miss
    assert trace.outcome.largest_miss_K == pytest.approx(0.0, abs=1e-9)
    assert simulate(STEP, PROMPT).display_C == pytest.approx(trace.target_C, abs=1e-9)
    ramp = (trace.time_s > 1.9) & (trace.time_s <= 2.0)  # 3 K/s, long under way
    assert trace.display_C[ramp] - trace.target_C[ramp] == pytest.approx(3.0 * 0.21, rel=1e-3)


def test_the_skin_at_rest_and_after_long_is_in_steady_state_with_the_display() -> None:
    still = simulate(icon_of("cool by 4 °C over 10 ms\n hold for 1 s"), RIG, tail_s=1200.0, rate_Hz=10.0)
    resistance = RIG.contact.resistance_m2K_per_W
    for row in (0, -1):  # the flow through the contact, by its own resistance
        flow = (still.display_C[row] - still.skin_C[row]) / resistance
        assert flow == pytest.approx(still.heat_flow_skin_W_per_m2[row], rel=1e-6)


def test_a_skin_controlled_cue_is_followed_by_the_skin() -> None:
    trace = simulate(SKIN, PROMPT)
    assert trace.reachable
    assert np.abs(trace.skin_C - trace.target_C).max() < 0.02


def test_a_ramp_rate_and_a_range_hold_it_back_and_say_so() -> None:
    slow = RIG.with_(**{"thermode.slew_K_per_s": 2.0})
    late = simulate(STEP, slow)
    assert not late.reachable and "limited by the ramp rate of the thermode from 0.00 s" in str(late.reason)
    narrow = simulate(STEP, RIG.with_(**{"thermode.lowest_C": 28.0}))
    assert narrow.display_C.min() >= 28.0
    assert not missing(["misses its target by 2.00 K", "range of the thermode"], str(narrow.reason))
    with pytest.raises(RigError, match=r"a baseline of 32 °C on the display is beyond its 35 … 60 °C"):
        simulate(STEP, RIG.with_(**{"thermode.lowest_C": 35.0}))


def test_corners_are_rounded_to_the_resolution() -> None:
    odd = icon_of("cool by 1.04 °C at 1 °C/s\n hold for 2 s")
    assert simulate(odd, PROMPT).display_C.min() == pytest.approx(31.0)
    assert simulate(odd, PROMPT.with_(**{"thermode.resolution_K": 0.0})).display_C.min() == pytest.approx(30.96)


def test_what_a_thermode_has_not_is_empty_in_files_and_none_in_summaries(tmp_path: Path) -> None:
    trace = simulate(STEP, RIG)
    assert not trace.has_current
    write_trace(trace, tmp_path / "t.csv")
    header, row = (tmp_path / "t.csv").read_text().splitlines()[:2]
    cells = dict(zip(header.split(","), row.split(","), strict=True))
    assert [cells[name] for name in ("current_A", "voltage_V", "hot_plate_C")] == ["", "", ""]
    summary = summarise(trace).to_dict()
    absent = {key for key, value in summary.items() if value is None} - {"reason"}
    assert absent == {
        "current_min_A", "current_max_A", "voltage_min_V", "voltage_max_V", "energy_J", "hot_plate_min_C",
        "hot_plate_max_C",
    }  # fmt: skip
    assert summary["safety"] == "green"
    json.dumps(summary, allow_nan=False)


def test_what_needs_a_module_ends_with_a_sentence() -> None:
    words = r"rig tcs2 is a thermode: it has no (module|driver|heat sink), and takes temperatures, not current"
    for part in ("module", "heat_sink", "driver", "module_source"):
        with pytest.raises(RigError, match=words):
            getattr(RIG, part)
    drive = Drive([0.0, 1.0], [0.0, 0.1])
    for asked in (lambda: simulate_current(drive, RIG), lambda: netlist(RIG, drive), lambda: design(STEP, RIG, 8.0)):
        with pytest.raises(RigError, match=words):
            asked()


def test_a_current_is_refused_in_words() -> None:
    icon = parse("cue 1\nset a { control current }\nicon ramp { to 0.6 A at 1 A/s\n return at 1 A/s }\n")["ramp"]
    words = r"rig tcs2 is a thermode: it takes temperatures, and ramp prescribes a current; use control display"
    with pytest.raises(RigError, match=words):
        simulate(icon, RIG)


def test_many_people_get_the_same_display_on_their_own_skins() -> None:
    other = RIG.with_(**{"contact.resistance_m2K_per_W": 6e-4})
    batch = simulate_many([STEP, SKIN], [RIG, other], nominal=RIG, end_s=8.0, probes=("display_C", "warm_receptor_C"))
    assert np.array_equal(batch["display_C"][0], batch["display_C"][1])
    assert batch["warm_receptor_C"][0, 0] == pytest.approx(simulate(STEP, RIG).warm_receptor_C, abs=1e-9)
    assert batch["warm_receptor_C"][1, 0] == pytest.approx(simulate(STEP, other).warm_receptor_C, abs=1e-9)
    anew = simulate_many([SKIN], [other], nominal=RIG, end_s=8.0, tracking="ideal", probes=("skin_C",))
    assert anew["skin_C"][0, 0] == pytest.approx(simulate(SKIN, other).skin_C, abs=1e-9)
    with pytest.raises(RigError, match=r"rigs of one batch must have the same thermode, or none"):
        simulate_many([STEP], [RIG, Rig.load("forearm")], nominal=RIG, end_s=8.0)


def test_a_rig_is_a_thermode_or_has_a_module() -> None:
    document = json.loads(Rig.load("thenar").document)
    with pytest.raises(RigError, match=r"the rig has no module and no heat_sink and no driver; remove \[module\]"):
        read_table({**document, "thermode": json.loads(RIG.document)["thermode"]}, "x.toml")
    bare = {key: table for key, table in document.items() if key not in ("module", "heat_sink", "driver")}
    with pytest.raises(RigError, match=r"add \[module\], \[heat_sink\] and \[driver\], or a \[thermode\]"):
        read_table(bare, "x.toml")
    with pytest.raises(RigError, match=r"driver is missing; add it"):
        read_table({key: table for key, table in document.items() if key != "driver"}, "x.toml")
