"""Probes: their place, lag, columns, and temperature at any depth."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.circuit.solver.watching import watch
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Drive, Rig, Trace, simulate, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.network import flow_weights, places_of, stacked, temperature_weights
from thermicon.circuit.solver.probes import between, reading_of
from thermicon.circuit.solver.trace import COLUMNS, write_trace
from thermicon.icons import load_library

STEP = load_library("six-icons")["cooling-step"]
THENAR, PAPER = Rig.load("thenar"), Rig.load("shani2021")
FILE = (Path(__file__).parents[3] / "circuit/rigs/thenar.toml").read_text("utf-8")


def probe(name: str = "a", place: str = "skin", **keys: float) -> dict[str, object]:
    return {"name": name, "place": place, **keys}


@pytest.fixture(scope="module")
def trace() -> Trace:
    probes = [
        probe("plate", "display"),
        probe("slow", "display", lag_s=0.4),
        probe("between", "interface"),
        probe("face"),
        probe("at-cold", depth_mm=0.27),
        probe("at_warm", depth_mm=0.38),
        probe("deep", depth_mm=19.47),
    ]
    return simulate(STEP, THENAR.with_(probe=probes))


def test_a_rig_file_names_its_probes(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(FILE + '\n[[probe]]\nname = "pad"\nplace = "skin"\ndepth_mm = 3\n', "utf-8")
    (pad,) = Rig.load(path).probes
    assert (pad.name, pad.place, pad.depth_m, pad.lag_s) == ("pad", "skin", 3e-3, 0.0)
    (changed,) = Rig.load(path).with_(**{"probe.pad.lag_s": 2, "probe.0.depth_mm": 8}).probes
    assert (changed.lag_s, changed.depth_m) == (2.0, 8e-3)
    assert THENAR.probes == ()
    with pytest.raises(RigError, match=r"probe\.b\.lag_s: no such probe; there are 0 \(pad\)"):
        Rig.load(path).with_(**{"probe.b.lag_s": 1})


def test_columns_follow_those_of_the_contract(trace: Trace, tmp_path: Path) -> None:
    names = ["plate", "slow", "between", "face", "at-cold", "at_warm", "deep"]
    assert list(trace.to_frame().columns) == [*COLUMNS, *(f"probe_{name}_C" for name in names)]
    write_trace(trace, tmp_path / "trace.csv")
    back = pd.read_csv(tmp_path / "trace.csv")
    assert list(back.columns) == list(trace.to_frame().columns)
    assert back["probe_slow_C"].to_numpy() == pytest.approx(trace.probe("slow"), abs=1e-6)
    plain, shown = ([line.get_label() for line in trace.plot(probes=asked).get_lines()] for asked in (False, True))
    assert shown == [*plain, *(f"probe {name}" for name in names)]
    with pytest.raises(KeyError, match="no probe 'pat' in this trace; there is plate, slow, between"):
        trace.probe("pat")
    with pytest.raises(ValueError, match="read-only"):
        trace.probe("slow")[0] = 0.0


def test_probes_change_nothing_else(trace: Trace) -> None:
    plain = simulate(STEP, THENAR)
    for name in COLUMNS[1:]:
        assert np.array_equal(getattr(plain, name), getattr(trace, name), equal_nan=True), name


def test_places_are_where_they_say(trace: Trace) -> None:
    assert np.array_equal(trace.probe("plate"), trace.display_C)
    assert trace.probe("between") == pytest.approx((trace.display_C + trace.skin_C) / 2, abs=1e-9)
    assert trace.probe("face") == pytest.approx(trace.skin_C, abs=1e-9)
    assert trace.probe("at-cold") == pytest.approx(trace.cold_receptor_C, abs=1e-9)
    assert trace.probe("at_warm") == pytest.approx(trace.warm_receptor_C, abs=1e-9)
    assert trace.probe("deep") == pytest.approx(THENAR.deep_C, abs=1e-9)


def test_between_lumps_a_depth_is_linear_in_thermal_resistance() -> None:
    # The printed skin's first lumps lie in the middle of the epidermis and of the first of five dermis elements.
    skins = [probe(f"d{k}", depth_mm=depth) for k, depth in enumerate((0.0405, 0.1, 0.281))]
    run = simulate(STEP, PAPER.with_(probe=skins))
    upper, middle, lower = (run.probe(name) for name in ("d0", "d1", "d2"))
    first, rest, whole = 0.0405e-3 / 0.24, 0.019e-3 / 0.45, 0.0405e-3 / 0.24 + 0.2e-3 / 0.45
    assert middle == pytest.approx(upper + (lower - upper) * (first + rest) / whole, abs=1e-9)


def test_a_lag_is_exact_for_what_is_linear_between_rows() -> None:
    times = np.array([0.0, 0.3, 0.5, 2.0])
    rate = np.array([1.0 / 0.7])
    out = reading_of(0.0, rate, rate, 0.0).at(times, np.array([1.0, 1.0, 3.0, 3.0]))
    ramp = 10.0  # K/s from 0.3 to 0.5 s: the lag trails it by ramp · lag · (1 − e^(−t/lag))
    at_ramp_end = 1.0 + ramp * (0.2 - 0.7 * (1 - np.exp(-0.2 / 0.7)))
    assert out == pytest.approx([1.0, 1.0, at_ramp_end, 3.0 + (at_ramp_end - 3.0) * np.exp(-1.5 / 0.7)], abs=1e-12)


def test_a_lagging_probe_starts_settled_and_trails(trace: Trace) -> None:
    slow, plate = trace.probe("slow"), trace.probe("plate")
    lagging = THENAR.with_(probe=[probe("slow", "display", lag_s=0.4)])
    assert (between(np.array([0.0, 0.1]), lagging), between(np.array([0.0, 0.1]), THENAR)) == (10, 1)
    assert slow[0] == plate[0]
    assert slow[190] - plate[190] == pytest.approx(3.0 * 0.4 * (1 - np.exp(-1.9 / 0.4)), abs=2e-3)  # on a 3 °C/s ramp


@pytest.mark.parametrize("rate", [7.0, 40.0, 50.0])
def test_the_rate_of_rows_does_not_matter_to_a_memory(rate: float) -> None:
    rig = THENAR.with_(probe=[probe("slow", "display", lag_s=0.05)])
    coarse, fine = simulate(STEP, rig, rate_Hz=rate), simulate(STEP, rig, rate_Hz=1000)
    assert len(coarse.time_s) == 8 * rate + 1
    expected = np.interp(coarse.time_s, fine.time_s, fine.probe("slow"))
    assert coarse.probe("slow") == pytest.approx(expected, abs=2e-3)


def test_a_run_too_long_for_its_probes_is_refused() -> None:
    rig = THENAR.with_(probe=[probe(f"p{k}", "display", lag_s=1.0) for k in range(21)])
    with pytest.raises(RigError, match=r"its probes need 2\.1e\+08 values over 100000 s; the limit is 2e\+08: shorten"):
        simulate_current(Drive([0, 1e5], [0.1, 0.1]), rig)


@dataclass
class Depths:
    """A run at k depths: temperature in °C and heat flow in W/m² into the skin (k, rows)."""

    temperature_C: Array
    heat_flow_W_per_m2: Array
    trace: Trace


def probe_depths(rig: Rig, depths_m: list[float], rate_Hz: float = 100.0) -> Depths:
    place, contact = places_of(rig), rig.contact.resistance_m2K_per_W
    at = [contact + rig.skin.resistance_to_m2K_per_W(float(depth)) for depth in depths_m]
    rows = [temperature_weights(here, place) for here in at]
    rows += [
        flow_weights(here if depth > 0 else 0.5 * contact, place) for here, depth in zip(at, depths_m, strict=True)
    ]
    plan = design(STEP, rig, 8.0)
    trace, values = watch(plan.drive, rig, stacked(rows), rate_Hz=rate_Hz, start_C=plan.start_C)
    return Depths(values[: len(at)], values[len(at) :], trace)


def test_heat_flow_at_a_lump_is_the_mean_of_its_faces_and_between_lumps_the_faces() -> None:
    k = 20
    lumps = THENAR.column.depth_m
    above, below = (lumps[k - 1] + lumps[k]) / 2, (lumps[k] + lumps[k + 1]) / 2
    flow = probe_depths(THENAR, [above, lumps[k], below]).heat_flow_W_per_m2
    assert flow[1] == pytest.approx((flow[0] + flow[2]) / 2, abs=1e-9)
    conductivity = 0.45  # the lump lies in the dermis
    temperature = probe_depths(THENAR, [lumps[k - 1], lumps[k]]).temperature_C
    expected = conductivity * (temperature[0] - temperature[1]) / (lumps[k] - lumps[k - 1])
    assert flow[0] == pytest.approx(expected, abs=1e-6)


def test_heat_is_kept_between_two_depths() -> None:
    # What enters at the surface less what leaves at 1 mm is what the lumps between have stored (and blood has brought).
    rig = THENAR.with_(**{"skin.layer.dermis.perfusion_per_s": 0.0})
    lumps = rig.column.depth_m
    last = int(np.searchsorted(lumps, 1e-3))
    bottom = (lumps[last] + lumps[last + 1]) / 2
    seen = probe_depths(rig, [0.0, bottom, *lumps[: last + 1]], rate_Hz=2000)
    steps = np.diff(seen.trace.time_s)
    net = seen.heat_flow_W_per_m2[0] - seen.heat_flow_W_per_m2[1]
    kept = float(np.sum(steps * (net[1:] + net[:-1]) / 2))
    change = seen.temperature_C[2:, -1] - seen.temperature_C[2:, 0]
    assert kept == pytest.approx(float(rig.column.capacity_J_per_m2K[: last + 1] @ change), rel=2e-3)
