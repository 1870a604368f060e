"""A fit finds the truth in the program's own traces, whatever they start from, or says that it is not known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from thermicon.circuit import Rig, fit, simulate
from thermicon.circuit.fitting.forward import steady_level
from thermicon.circuit.fitting.keys import CONTACT
from thermicon.circuit.fitting.log import LogError, read_log, read_logs
from thermicon.circuit.fitting.rig_fit import RigFit
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.simulate import simulate_current
from thermicon.circuit.solver.steady import state_under_current, steady_state
from thermicon.circuit.solver.trace import Trace
from thermicon.icons import Icon, from_samples

RIGS = ("thenar", "fingertip", "forearm", "hand-dorsum", "shani2021", "tcs2")
NOISE = {"display_C": 0.01, "skin_C": 0.01, "hot_plate_C": 0.01, "voltage_V": 0.003}
ZERO_K, LAG_S = 0.1, 0.3


def an_icon(random: np.random.Generator) -> Icon:
    """Four to seven ramps or holds, longer together than the shortest log that a fit takes."""
    lengths = random.uniform(1.5, 3.0, random.integers(4, 8)).round(1)
    levels = np.r_[32.0, random.uniform(28.0, 35.0, len(lengths)).round(1)]
    for held in range(1, len(lengths), 3):
        levels[held + 1] = levels[held]
    return from_samples(np.r_[0.0, np.cumsum(lengths)], levels)


def another_contact(rig: Rig, random: np.random.Generator) -> Rig:
    factor = np.exp(random.uniform(np.log(0.67), np.log(1.5)))
    return rig.with_(**{CONTACT: rig.contact.resistance_m2K_per_W * float(factor)})


def powered_on(rig: Rig, current_A: np.ndarray, rate_Hz: float = 100.0) -> Trace:
    """A trace that starts without power."""
    drive = Drive(np.arange(len(current_A)) / rate_Hz, current_A, held=True)
    return simulate_current(drive, rig, rate_Hz=rate_Hz, start_C=state_under_current(network_of(rig), 0.0))


def logged(trace: Trace, random: np.random.Generator, noise: bool) -> pd.DataFrame:
    frame = trace.to_frame()
    if any(name == "thermistor" for name, _ in trace.probes):
        frame["display_C"] = trace.probe("thermistor")
    for column, sd in NOISE.items() if noise else ():
        zero = random.normal(0.0, ZERO_K) if column.endswith("_C") else 0.0
        frame[column] += zero + random.normal(0.0, sd, len(frame))
    return frame


def truth_found(name: str, seed: int, folder: Path) -> tuple[bool, RigFit]:
    """Fit one random icon: on even seeds held at first, otherwise without power; noise and lag on some of each."""
    random = np.random.default_rng(seed)
    rig = Rig.load(name)
    if seed % 4 > 1 and rig.thermode is None:
        rig = rig.with_(probe=[{"name": "thermistor", "place": "display", "lag_s": LAG_S}])
    true = another_contact(rig, random)
    trace = simulate(an_icon(random), true)
    if seed % 2 and rig.thermode is None:
        trace = powered_on(true, np.asarray(trace.current_A))
    log = logged(trace, random, noise=seed % 8 > 3)
    path = folder / f"{name}-{seed}.csv"
    log.to_csv(path, index=False)
    found = fit(path if seed % 3 else log, rig, free=[CONTACT])
    return found[CONTACT].low <= true.contact.resistance_m2K_per_W <= found[CONTACT].high, found


@pytest.mark.parametrize("name", RIGS)
def test_a_trace_without_noise_is_fitted_without_an_offset(name: str, tmp_path: Path) -> None:
    for seed in (0, 3):
        inside, found = truth_found(name, seed, tmp_path)
        assert inside and found[CONTACT].identified, seed
        assert max(abs(each.offset_K) for each in found.channels) < 0.05
        assert not any("not steady" in note for note in found.notes)


@pytest.mark.slow
def test_the_truth_is_inside_in_95_of_100(tmp_path: Path) -> None:
    inside = [truth_found(RIGS[seed % len(RIGS)], seed, tmp_path)[0] for seed in range(200)]
    assert np.mean(inside) >= 0.95


@pytest.fixture(scope="module")
def drifting() -> tuple[Rig, Rig, pd.DataFrame]:
    """A rig, the true one, and its log from power on over a wait of 20 s through an icon."""
    random, rig = np.random.default_rng(5), Rig.load("thenar")
    true = another_contact(rig, random)
    holding = np.full(2000, steady_state(true, "display", 32.0)[0])
    current = np.concatenate([holding, np.asarray(simulate(an_icon(random), true).current_A)])
    return rig, true, logged(powered_on(true, current), random, noise=True)


def test_a_log_that_begins_while_the_display_drifts_says_that_nothing_is_known(
    drifting: tuple[Rig, Rig, pd.DataFrame],
) -> None:
    rig, true, log = drifting
    whole = fit(log, rig, free=[CONTACT])
    assert whole[CONTACT].low <= true.contact.resistance_m2K_per_W <= whole[CONTACT].high and whole[CONTACT].identified
    cut = fit(log[log.time_s >= 15.0], rig, free=[CONTACT])
    assert not cut[CONTACT].identified and cut[CONTACT].cure.startswith("first log a few seconds of rest")
    assert any("not steady at the first row" in note for note in cut.notes)
    assert cut.rig.contact == rig.contact


def test_a_clock_that_starts_again_begins_another_run_and_rows_sent_again_do_not(
    drifting: tuple[Rig, Rig, pd.DataFrame],
) -> None:
    rig, true, log = drifting
    late = log[log.time_s >= 15.0]
    both = pd.concat([log, late.assign(time_s=late.time_s - 15.0, display_C=late.display_C + 1e-4)])
    assert [each.name for each in read_logs(both)] == ["table, recording 1", "table, recording 2"]
    assert len(read_logs(pd.concat([log, log[:500]]))) == len(read_logs(log)) == 1
    found = fit(both, rig, free=[CONTACT])[CONTACT]
    assert not found.identified or found.low <= true.contact.resistance_m2K_per_W <= found.high
    assert fit(pd.concat([log, log.assign(display_C=log.display_C + 1e-4)]), rig, free=[CONTACT])[CONTACT].identified
    with pytest.raises(LogError, match="the clock starts again 1 times: give each recording its own file"):
        read_log(both)


def test_residuals_far_beyond_noise_leave_nothing_known(drifting: tuple[Rig, Rig, pd.DataFrame]) -> None:
    rig, _, log = drifting
    for wrong, known in ((1.001, True), (1.3, False)):
        other = rig.with_(**{"module.seebeck_V_per_K": wrong * rig.module.seebeck_V_per_K})
        assert fit(log, other, free=[CONTACT])[CONTACT].identified is known, wrong


def test_a_smooth_ramp_is_no_noise() -> None:
    assert steady_level(np.linspace(0.663, 1.2, 80)) == 0.663
    shaken = 0.1 + np.random.default_rng(1).normal(0.0, 0.01, 200)
    assert steady_level(shaken) == pytest.approx(0.1, abs=0.004), "of noise many rows are averaged"


def test_a_column_that_is_empty_throughout_is_left_out(drifting: tuple[Rig, Rig, pd.DataFrame]) -> None:
    rig, _, log = drifting
    found = fit(log.assign(skin_C=np.nan), rig, free=[CONTACT])
    assert any("empty throughout, and left out: skin_C" in note for note in found.notes)
    assert "skin_C" not in {each.column for each in found.channels}


def test_rows_that_were_sent_again_count_once(drifting: tuple[Rig, Rig, pd.DataFrame]) -> None:
    rig, _, log = drifting
    again = pd.concat([log[:900], log[700:]])
    plain, twice = (fit(rows, rig, free=[CONTACT]) for rows in (log, again))
    assert any("sent again count once: 200" in note for note in twice.notes)
    assert twice[CONTACT].value == plain[CONTACT].value
    again.iloc[950, again.columns.get_loc("display_C")] += 1.0
    with pytest.raises(ValueError, match="the clock starts again here: give each recording its own file"):
        fit(again, rig, free=[CONTACT])
