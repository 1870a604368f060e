"""Probes: where they sit, how they lag, what they add to a trace, and how a bad one is refused."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from thermicon.circuit import Drive, Rig, Trace, simulate, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.probes import reading_of
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
        probe("pad", "insulated skin"),
    ]
    return simulate(STEP, THENAR.with_(probe=probes))


def test_a_rig_file_names_its_probes(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(FILE + '\n[[probe]]\nname = "pad"\nplace = "insulated skin"\nlateral_mm = 3\n', "utf-8")
    (pad,) = Rig.load(path).probes
    assert (pad.name, pad.place, pad.depth_m, pad.lag_s) == ("pad", "insulated skin", 0.0, 0.0)
    assert (pad.lateral_m, pad.width_m, pad.insulation_m2K_per_W) == pytest.approx((3e-3, 6e-3, 2e-3 / 0.015))
    assert Rig.load(path).with_(**{"probe.pad.lag_s": 2, "probe.0.width_mm": 8}).probes[0].width_m == 8e-3
    assert THENAR.probes == ()


def test_setting_a_probe_that_is_not_there() -> None:
    with pytest.raises(RigError, match=r"probe\.b\.lag_s: no such probe; there are 0 \(a\)"):
        THENAR.with_(probe=[probe()]).with_(**{"probe.b.lag_s": 1})


def test_columns_follow_those_of_the_contract(trace: Trace, tmp_path: Path) -> None:
    names = ["plate", "slow", "between", "face", "at-cold", "at_warm", "deep", "pad"]
    assert list(trace.to_frame().columns) == [*COLUMNS, *(f"probe_{name}_C" for name in names)]
    for suffix, read in ((".csv", pd.read_csv), (".parquet", pd.read_parquet)):
        write_trace(trace, tmp_path / f"trace{suffix}")
        back = read(tmp_path / f"trace{suffix}")
        assert list(back.columns) == list(trace.to_frame().columns)
        assert back["probe_pad_C"].to_numpy() == pytest.approx(trace.probe("pad"), abs=1e-6)
    with pytest.raises(KeyError, match="no probe 'pat' in this trace; there is plate, slow, between"):
        trace.probe("pat")
    with pytest.raises(ValueError, match="read-only"):
        trace.probe("pad")[0] = 0.0


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
    assert slow[0] == plate[0]
    assert slow[190] - plate[190] == pytest.approx(3.0 * 0.4 * (1 - np.exp(-1.9 / 0.4)), abs=2e-3)  # on a 3 °C/s ramp


@pytest.mark.parametrize("rate", [7.0, 40.0, 50.0])
def test_the_rate_of_rows_does_not_matter_to_a_memory(rate: float) -> None:
    rig = THENAR.with_(probe=[probe("slow", "display", lag_s=0.05), probe("pad", "insulated skin", lateral_mm=1.0)])
    coarse, fine = simulate(STEP, rig, rate_Hz=rate), simulate(STEP, rig, rate_Hz=1000)
    assert len(coarse.time_s) == 8 * rate + 1
    for name in ("slow", "pad"):
        expected = np.interp(coarse.time_s, fine.time_s, fine.probe(name))
        assert coarse.probe(name) == pytest.approx(expected, abs=2e-3), name


def test_a_run_too_long_for_its_probes_is_refused() -> None:
    rig = THENAR.with_(probe=[probe("pad", "insulated skin")])
    with pytest.raises(RigError, match=r"its probes need 4\.9e\+08 values over 100000 s; the limit is 2e\+08: shorten"):
        simulate_current(Drive([0, 1e5], [0.1, 0.1]), rig)
