"""The exported netlist in ngspice: an independent solver for the same physics."""

import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from thermicon.circuit import Drive, InputError, Rig, Trace, netlist, simulate, simulate_current
from thermicon.circuit.delivery.netlist import EDGE_S
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.network import RECORDED
from thermicon.icons import load_library, parse

Tool = Callable[[str], str]
WITHIN_K = 2e-3
WITHIN_V = 1e-3
WITHIN_SHARE = 2e-3


@dataclass(frozen=True)
class Apart:
    """Largest differences between a trace and ngspice: A, K of all temperature probes, V, and heat flow as a share."""

    ampere: float
    kelvin: float
    volt: float
    flow_share: float

    def small(self) -> bool:
        close = self.kelvin < WITHIN_K and self.volt < WITHIN_V and self.flow_share < WITHIN_SHARE
        return close and self.ampere < 1e-6


def run_ngspice(text: str, ngspice: str, folder: Path, out: str) -> np.ndarray:
    (folder / "rig.cir").write_text(text, encoding="ascii")
    run = subprocess.run([ngspice, "-b", "rig.cir"], cwd=folder, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stdout + run.stderr
    return np.loadtxt(folder / out, skiprows=1)


def apart(trace: Trace, table: np.ndarray, drive: Drive) -> Apart:
    """Compare at the rows; what jumps at a row of a held drive is compared just behind it.

    Current and voltage are left out at the last row, and where a flank begins within 3 µs behind a row.

    Heat flow is a share of its range in the run, or of 1 kW/m² where that is more.
    """
    time = trace.time_s
    behind = time[:-1] + (1.01 * EDGE_S if drive.held else 0.0)
    calm = drive.at(behind + 2 * EDGE_S) == drive.at(time[:-1]) if drive.held else np.full(len(behind), True)
    current, voltage, *probes = table[:, 1:].T
    far: dict[bool, list[float]] = {True: [], False: []}
    for probe, theirs in zip(RECORDED, probes, strict=True):
        ours = getattr(trace, probe)
        difference = float(np.abs(np.interp(time, table[:, 0], theirs) - ours).max())
        kelvin = probe.endswith("_C")
        far[kelvin].append(difference if kelvin else difference / max(float(np.ptp(ours)), 1e3))
    return Apart(
        float(np.abs(np.interp(behind, table[:, 0], current) - trace.current_A[:-1])[calm].max()),
        max(far[True]),
        float(np.abs(np.interp(behind, table[:, 0], voltage) - trace.voltage_V[:-1])[calm].max()),
        max(far[False]),
    )


def played(rig: Rig, drive: Drive, ngspice: str, folder: Path) -> Apart:
    table = run_ngspice(netlist(rig, drive, out_file="out.txt"), ngspice, folder, "out.txt")
    return apart(simulate_current(drive, rig), table, drive)


CORNERS = Drive([0, 1, 2, 5, 9, 12, 20], [0.1, 0.1, 1.2, 1.2, -0.8, 0.3, 0.3])
JUMPS = Drive([0, 1, 1.5, 6, 9, 12, 20], [0.1, 0.5, 1.2, -0.9, -0.8, 0.3, 0.3], held=True)
# Rows of the trace fall into flanks, and two rows lie closer than one flank is wide.
BESIDE = Drive([0, 1.0000003, 1.9999996, 2.5, 2.5000005, 4], [0.1, 0.9, -0.4, 0.5, 1.1, 1.1], held=True)


BODIES = {
    "warm sink": {"heat_sink.temperature_C": 28.0, "heat_sink.capacity_J_per_K": 40.0,
                  "heat_sink.air_resistance_K_per_W": 1.5},
    "steady sink": {"heat_sink.temperature_C": None, "heat_sink.capacity_J_per_K": 40.0,
                    "heat_sink.air_resistance_K_per_W": 1.5},
}  # fmt: skip


PLAYED: dict[str, tuple[str, dict[str, object], Drive]] = {
    **{f"{kind} on {name}": (name, {}, drive) for name in ("thenar", "shani2021")
       for kind, drive in (("corners", CORNERS), ("jumps", JUMPS), ("beside", BESIDE))},
    **{body: ("thenar", dict(keys), CORNERS) for body, keys in BODIES.items()},
}  # fmt: skip


@pytest.mark.parametrize("case", PLAYED)
def test_a_drive_agrees_on_a_rig(case: str, tool: Tool, tmp_path: Path) -> None:
    name, keys, drive = PLAYED[case]
    found = played(Rig.load(name).with_(**keys), drive, tool("ngspice"), tmp_path)
    assert found.small(), found


@pytest.mark.parametrize(
    ("cue", "name"),
    [
        ("cooling-step-skin", "shani2021"),
        ("six-icons", "thenar"),
        pytest.param("cooling-step-skin", "thenar", marks=pytest.mark.slow),
        pytest.param("six-icons", "shani2021", marks=pytest.mark.slow),
    ],
)
def test_an_icon_agrees_from_its_rest(name: str, cue: str, tool: Tool, tmp_path: Path) -> None:
    rig, icon = Rig.load(name), load_library(cue).icons[0]
    plan = design(icon, rig, 12.0)
    text = netlist(rig, plan.drive, rest_A=plan.rest_A, out_file="out.txt")
    table = run_ngspice(text, tool("ngspice"), tmp_path, "out.txt")
    assert abs(table[0, 1] - plan.rest_A) < 1e-9  # the operating point is that of rest
    assert abs(table[0, 4] - plan.start_C[1]) < 1e-6
    found = apart(simulate(icon, rig, tail_s=4.0), table, plan.drive)
    assert found.small(), found


def test_an_icon_in_amperes_agrees(tool: Tool, tmp_path: Path) -> None:
    icons = parse(
        "cue 1\nset amps { control current }\n"
        "icon a {\n  to 0.5 A at 1 A/s\n  hold for 1 s\n  to -0.25 A at 0.5 A/s\n  return at 0.5 A/s\n}\n"
    )
    rig, icon = Rig.load("thenar"), icons["a"]
    trace = simulate(icon, rig, tail_s=2.0)
    plan = design(icon, rig, float(trace.time_s[-1]))
    text = netlist(rig, plan.drive, rest_A=plan.rest_A, out_file="out.txt")
    assert text.count("\n+ ") == len(plan.drive.time_s) + 1  # its corners and no more, and the bracket
    found = apart(trace, run_ngspice(text, tool("ngspice"), tmp_path, "out.txt"), plan.drive)
    assert found.small(), found


def test_a_designed_drive_replayed_starts_from_rest(tool: Tool, tmp_path: Path) -> None:
    rig = Rig.load("thenar")
    plan = design(load_library("cooling-step-skin").icons[0], rig, 3.0)
    drive = Drive(plan.drive.time_s[:-150], plan.drive.current_A[:-150], held=True)
    rest = run_ngspice(netlist(rig, drive, rest_A=plan.rest_A, out_file="a.txt"), tool("ngspice"), tmp_path, "a.txt")
    first = run_ngspice(netlist(rig, drive, out_file="b.txt"), tool("ngspice"), tmp_path, "b.txt")
    at_rest, at_first = rest[0, 4], first[0, 4]
    assert at_rest == pytest.approx(plan.start_C[1], abs=1e-6)
    assert at_first == pytest.approx(simulate_current(drive, rig).display_C[0], abs=1e-6)
    assert abs(at_rest - at_first) > 5


def test_a_file_that_ngspice_cannot_write_to_is_told() -> None:
    with pytest.raises(InputError, match=r"'a;b\.txt': ngspice cannot write .* use letters, digits, blanks"):
        netlist(Rig.load("shani2021"), CORNERS, out_file="a;b.txt")


def test_a_file_with_blanks_and_capitals_is_written(tool: Tool, tmp_path: Path) -> None:
    drive = Drive([0, 0.1], [0.1, 0.1])
    run_ngspice(netlist(Rig.load("shani2021"), drive, out_file="My Out.txt"), tool("ngspice"), tmp_path, "My Out.txt")


def test_the_file_is_plain_text_that_both_programs_read() -> None:
    """Only ASCII, no control section unless asked for, and no function that only one of the two programs has."""
    rig = replace(Rig.load("thenar"), title="für °C\n.end")
    text = netlist(rig, CORNERS, title="größer × 2")
    assert text.isascii()
    lines = text.splitlines()
    assert lines[0].startswith("* gr??er x 2 on rig thenar, written by thermicon ")
    assert [line for line in lines if line.startswith(".")] == [
        ".options reltol=1e-06 abstol=1e-12 vntol=1e-9",
        ".tran 0.01 20.0 0 0.0025",
        ".end",
    ]
    assert {line[0] for line in lines} <= set("*+.RCVGB")
    assert max(map(len, lines)) < 250
    code = "\n".join(line for line in lines if line[0] != "*")
    assert not any(word in code for word in ("$", ";", "{", "?", "uic", "if(", "\t"))
    names = [line.split()[0].lower() for line in lines if line[0] not in "*+."]
    assert len(names) == len(set(names))


currents = st.floats(-1.0, 1.5).map(lambda value: round(value, 3))


@st.composite
def rigs(draw: st.DrawFn) -> Rig:
    """Rigs over the range of modules, contacts and skins; every plate slow enough for steps of 10 ms."""

    def between(low: float, high: float) -> float:
        return draw(st.floats(low, high).map(lambda value: float(f"{value:.4g}")))

    base = Rig.load(draw(st.sampled_from(["thenar", "shani2021"])))
    changes: dict[str, object] = {
        "module.seebeck_V_per_K": between(0.02, 0.06),
        "module.resistance_ohm": between(1.0, 8.0),
        "module.thermal_resistance_K_per_W": between(2.0, 10.0),
        "module.hot_plate_J_per_K": between(1.0, 10.0),
        "module.cold_plate_J_per_K": between(1.0, 10.0),
        "heat_sink.temperature_C": between(15.0, 45.0),
        "heat_sink.resistance_K_per_W": between(0.1, 1.0),
        "driver.transconductance_A_per_V": between(0.05, 2.0),
        "contact.area_cm2": between(2.0, 16.0),
        "contact.resistance_m2K_per_W": between(3e-4, 3e-3),
        "skin.layer.0.thickness_mm": between(0.05, 0.6),
        "skin.layer.1.perfusion_per_s": between(0.0, 1e-2),
        "skin.cold_receptor_mm": between(0.1, 0.2),
        "skin.warm_receptor_mm": between(0.25, 0.4),
    }
    if base.skin.elements is not None:
        changes["skin.elements"] = [draw(st.integers(1, 4)), draw(st.integers(1, 8))]
    return base.with_(**changes)


@st.composite
def drives(draw: st.DrawFn) -> Drive:
    """Drives of 3 to 8 rows over at most 14 s, linear or held, rows on and off the beat of a trace's rows."""
    gaps = draw(st.lists(st.floats(0.05, 2.0).map(lambda gap: round(gap, 3)), min_size=2, max_size=7))
    times = [0.0, *np.cumsum(gaps).round(3).tolist()]
    values = draw(st.lists(currents, min_size=len(times), max_size=len(times)))
    return Drive(times, values, held=draw(st.booleans()))


@settings(
    max_examples=40,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
@given(rigs(), drives())
def test_random_drives_on_random_rigs_agree(tool: Tool, rig: Rig, drive: Drive) -> None:
    try:
        trace = simulate_current(drive, rig)
    except RigError:  # a current that has no steady state on this rig
        assume(False)
    with tempfile.TemporaryDirectory() as folder:
        table = run_ngspice(netlist(rig, drive, out_file="out.txt"), tool("ngspice"), Path(folder), "out.txt")
    found = apart(trace, table, drive)
    assert found.small(), found
