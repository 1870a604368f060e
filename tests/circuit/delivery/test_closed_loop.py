"""PID loops on a display thermistor, beside the same loops in ngspice."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import icon_of
from thermicon.circuit import Drive, Rig, Trace, netlist, simulate, simulate_many
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.batch_inputs import bank_of, run_regulate
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import Icon

GAINS = {"lag_s": 0.1, "kp_A_per_K": 2.0, "ki_A_per_Ks": 1.0, "kd_As_per_K": 0.15}
LOOP = Rig.load("thenar").with_set([f"controller.{key}={value}" for key, value in GAINS.items()])


@pytest.mark.parametrize("verb", ["cool", "warm"])
def test_a_step_that_meets_the_limit_overshoots_little_and_settles(verb: str) -> None:
    trace = simulate(icon_of(f"{verb} by 1 °C over 10 ms; hold for 7 s"), LOOP)
    change = np.abs(trace.display_C - 32.0)
    assert np.abs(trace.current_A).max() == 1.5, "the limit is hit"
    assert change.max() < 1.1
    assert np.abs(change - 1.0)[trace.time_s > 5.0].max() < 0.020


def test_the_integral_does_not_wind_up_at_the_limit() -> None:
    # A step too large for the driver: the time at the limit would wind a plain integral up to some 10 A.
    trace = simulate(icon_of("cool by 12 °C over 10 ms; hold for 14 s"), LOOP)
    assert (trace.current_A == 1.5).sum() > 150
    assert (32.0 - trace.display_C).max() < 12.3


def test_the_loop_lags_a_ramp_and_says_so() -> None:
    ramp = icon_of("cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s")
    outcome = simulate(ramp, LOOP).outcome
    assert not outcome.reached
    assert 0.1 < abs(outcome.largest_miss_K) < 1.5
    assert simulate(ramp, Rig.load("thenar")).outcome.reached


def test_under_skin_control_the_loop_follows_the_display_that_the_skin_needs() -> None:
    cue = icon_of("cool by 3 °C at 1 °C/s; hold for 5 s", "skin")
    trace, ideal = simulate(cue, LOOP), simulate(cue, Rig.load("thenar"))
    assert np.abs(trace.skin_C - ideal.skin_C)[trace.time_s > 6].max() < 0.05
    miss = max(trace.skin_C - trace.target_C, key=abs)
    assert trace.outcome.largest_miss_K == pytest.approx(miss, abs=0.01), "what is judged is the skin"


def test_a_loop_starts_at_rest_and_stays_there() -> None:
    assert np.ptp(simulate(icon_of("rest for 4 s"), LOOP).display_C) < 1e-9


def test_a_gain_below_zero_is_refused() -> None:
    with pytest.raises(RigError, match=r"controller\.kp_A_per_K = -1 A/K: must be at least 0 A/K"):
        Rig.load("thenar").with_(**{"controller.kp_A_per_K": -1})


@pytest.mark.parametrize(("periods", "late"), [(0.0, 0), (0.5, 1), (1.0, 1), (1.5, 2)])
def test_a_loop_whose_output_is_late_acts_on_what_its_sensor_showed_whole_periods_before(
    periods: float, late: int
) -> None:
    rig, period, gains = Rig.load("shani2021"), 0.05, (0.3, 0.8, 0.01)
    bias, rest = steady_state(rig, "display", 32.0)
    goal, lane, bank = np.where(np.arange(60) < 5, 32.0, 31.0), np.zeros(1, dtype=np.int64), bank_of(rig)
    told = np.array([[0.0, *gains, periods * period]])
    current, display, why = run_regulate(
        bank, lane, lane, period, goal[np.newaxis], told, np.array([bias]), bank.states([rest])
    )
    assert not why.any(), "no limit is met"
    shown, total, before = [32.0] * (1 + late) + display[0].tolist(), 0.0, 32.0
    for k in range(60):
        seen = shown[k]  # the display of `late` periods ago
        error = seen - goal[k]
        asked = bias + gains[0] * error + gains[1] * total + gains[2] * (seen - before) / period
        assert current[0, k] == pytest.approx(asked, abs=1e-9)
        total, before = total + error * period, seen
    assert np.ptp(display) > 0.9


Tool = Callable[[str], str]


def ngspice_columns(text: str, ngspice: str, folder: Path) -> dict[str, np.ndarray]:
    """Run a netlist whose control section writes out.txt; return its columns by their names."""
    (folder / "loop.cir").write_text(text)
    run = subprocess.run([ngspice, "-b", "loop.cir"], cwd=folder, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr
    with (folder / "out.txt").open() as file:
        names = file.readline().lower().split()
        return dict(zip(names, np.loadtxt(file).T, strict=True))


def apart(trace: Trace, columns: dict[str, np.ndarray], probe: str) -> float:
    time_s, values = columns["time"], columns[f"v({probe.lower()})"]
    return float(np.abs(np.interp(trace.time_s, time_s, values) - getattr(trace, probe)).max())


def sampled_loop(rig: Rig, cue: Icon, end_s: float) -> str:
    """The netlist of a rig whose command comes from a sampled PID made of capacitors and B sources."""
    bias = steady_state(rig, "display", 32.0)[0]
    text = netlist(rig, Drive([0.0, end_s], [bias, bias]), out_file="out.txt")
    text = re.sub(r"Vcommand command 0 PWL\(\n(\+.*\n)+", "", text)
    corners = cue.corners(32.0)
    points = " ".join(f"{t!r} {v!r}" for t, v in zip(corners.time_s, corners.value, strict=True))
    lag, period = GAINS["lag_s"], 1 / rig.driver.update_Hz
    low, high = rig.driver.current_min_A, rig.driver.current_max_A

    def hold_of(name: str, source: str, clock: str) -> str:
        # Follows its source with 0.1 µs while the clock is 1, and with 10 s (for the operating point) while it is 0.
        return f"B{name} 0 {name} I=0.1*(V({clock})+1e-8)*(({source})-V({name}))\nC{name} {name} 0 10n\n"

    def clock(name: str, delay: float) -> str:
        return f"V{name} {name} 0 PULSE(0 1 {delay!r} 50n 50n 1u {period!r})\n"

    loop = (
        clock("k0", period - 8e-6)  # the last sample of the thermistor is kept before the next is taken
        + clock("k1", 1e-9)
        + clock("k2", 3e-6)
        + f"Vset set 0 PWL({points} {end_s + 1!r} {corners.value[-1]!r})\n"
        + f"Rfelt felti felt 1\nCfelt felt 0 {lag!r}\nBfelt felti 0 V=V(cold)\n"
        + hold_of("now", "V(felt)", "k1")
        + hold_of("was", "V(now)", "k0")
        + hold_of("err", "V(felt)-V(set)", "k1")
        + hold_of(
            "ask",
            f"{bias!r}+{GAINS['kp_A_per_K']!r}*V(err)+{GAINS['ki_A_per_Ks']!r}*V(total)"
            f"+{GAINS['kd_As_per_K'] / period!r}*(V(now)-V(was))",
            "k2",
        )
        + f"Bgive give 0 V=min(max(V(ask),{low!r}),{high!r})\n"
        + f"Bcommand command 0 V=V(give)/{rig.driver.transconductance_A_per_V!r}\n"
        + "Btotal 0 total I=(((V(ask)-V(give))*V(err)) < 1e-12) ? V(err) : 0\nCtotal total 0 1\nRtotal total 0 1e12\n"
    )
    return text.replace(".options reltol", loop + ".options reltol")


@pytest.mark.slow
@pytest.mark.parametrize("body", ["cool by 1 °C over 10 ms; hold for 5 s", "cool by 3 °C at 2 °C/s; hold for 3 s"])
def test_the_same_loop_in_ngspice_agrees_within_5_mK(body: str, tool: Tool, tmp_path: Path) -> None:
    cue = icon_of(body)
    trace = simulate(cue, LOOP)
    columns = ngspice_columns(sampled_loop(LOOP, cue, float(trace.time_s[-1])), tool("ngspice"), tmp_path)
    assert apart(trace, columns, "display_C") < 5e-3


def test_a_batch_runs_the_loop_too() -> None:
    cues = [icon_of("cool by 6 °C at 3 °C/s; hold for 4 s"), icon_of("warm by 2 °C at 1 °C/s; hold for 5 s")]
    other = LOOP.with_(**{"contact.resistance_m2K_per_W": 9e-4})
    batch = simulate_many(cues, [LOOP, other], nominal=LOOP, end_s=9.0, probes=("display_C",))
    for r, rig in enumerate((LOOP, other)):
        for c, cue in enumerate(cues):
            alone = simulate(cue, rig, tail_s=9.0 - cue.corners(32.0).duration_s)
            assert np.abs(batch["display_C"][r, c] - alone.display_C).max() < 1e-4
    skin = [icon_of("cool by 3 °C at 1 °C/s; hold for 5 s", "skin")]
    replayed = simulate_many(skin, [LOOP], nominal=LOOP, end_s=9.0, probes=("skin_C",))
    assert np.abs(replayed["skin_C"][0, 0] - simulate(skin[0], LOOP, tail_s=1.0).skin_C).max() < 1e-4
    with pytest.raises(RigError, match="cannot be solved again through a PID loop, which measures only the display"):
        simulate_many(skin, [LOOP], nominal=LOOP, end_s=9.0, tracking="ideal")
    with pytest.raises(RigError, match="must all have a controller, or none"):
        simulate_many(cues, [Rig.load("thenar")], nominal=LOOP, end_s=9.0)
