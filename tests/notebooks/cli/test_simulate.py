"""``thermicon simulate``: the trace file as scripts expect it, the summary as people do."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from thermicon.circuit import Rig, nearest_reachable
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import read_cue

Cli = Callable[..., Any]
COLUMNS = [
    "icon",
    "time_s",
    "current_A",
    "voltage_V",
    "target_C",
    "hot_plate_C",
    "display_C",
    "skin_C",
    "cold_receptor_C",
    "warm_receptor_C",
    "heat_flow_skin_W_per_m2",
    "heat_flow_cold_receptor_W_per_m2",
    "heat_flow_warm_receptor_W_per_m2",
]


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_the_trace_has_the_promised_columns_and_rows(cli: Cli, two: Path, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"trace{suffix}"
    said = cli("simulate", two, "-o", out)
    assert said.exit_code == 0, said.stderr
    assert said.stdout == ""
    first, second, last = said.stderr.splitlines()
    assert first.startswith("cool-step: 8 s, reached")
    assert second.startswith("warm-step: 6 s, reached")
    assert last == f"wrote {out}"
    frame = pd.read_csv(out) if suffix == ".csv" else pd.read_parquet(out)
    assert list(frame.columns) == COLUMNS
    assert list(frame["icon"].unique()) == ["cool-step", "warm-step"]
    first = frame[frame["icon"] == "cool-step"]
    assert len(first) == 801
    assert first["time_s"].iloc[-1] == pytest.approx(8.0)
    assert first["target_C"].min() == pytest.approx(26.0)
    assert not list(tmp_path.glob(".*"))


def test_another_site_alone_is_warned_of(cli: Cli, two: Path) -> None:
    said = cli("simulate", two, "--set", "skin.site=forearm")
    assert said.exit_code == 0
    words = " ".join(said.stderr.split())
    assert "warning: skin.site = forearm changes the name of the site" in words
    assert "use --rig forearm or --rig tcs2, or set skin.layer" in words


def test_one_icon_a_rate_and_a_tail(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "trace.csv"
    assert cli("simulate", two, "--icon", "warm-step", "--rate", 20, "--tail", 2, "-o", out).exit_code == 0
    frame = pd.read_csv(out)
    assert set(frame["icon"]) == {"warm-step"}
    assert len(frame) == 161
    assert frame["target_C"].iloc[-1] == pytest.approx(32.0)


def test_stdout_carries_the_same_bytes_as_a_file(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "trace.csv"
    cli("simulate", two, "-o", out)
    said = cli("simulate", two, "-o", "-")
    assert said.exit_code == 0
    assert said.stdout == out.read_text(encoding="utf-8")


def test_the_summary_says_what_matters(cli: Cli, two: Path) -> None:
    said = cli("simulate", two, "--icon", "cool-step")
    assert said.exit_code == 0
    assert said.stderr == ""
    head, *rest = said.stdout.splitlines()
    assert head.startswith("cool-step: 8 s, reached (everywhere within 1 mK)")
    words = "\n".join(rest)
    assert "current   −0.48 to 1.11 A" in words
    assert "display   26–32 °C" in words
    assert "cold receptor −" in words


def test_a_miss_is_data_and_not_a_failure(cli: Cli, two: Path) -> None:
    said = cli("simulate", two, "--icon", "cool-step", "--set", "driver.current_limit_A=0.8")
    assert said.exit_code == 0
    assert "NOT reached: misses its target by" in said.stdout
    assert "K" in said.stdout
    icon, rig = read_cue(two)["cool-step"], Rig.load("thenar").with_(**{"driver.current_limit_A": 0.8})
    near = nearest_reachable(icon, rig)
    assert near is not None
    assert said.stdout.endswith(f"\n  nearest   {near.sentence}\n")


@pytest.mark.slow
def test_a_miss_beside_a_file_says_how_to_mend_it(cli: Cli, two: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "a.csv", tmp_path / "a.png"
    options = ("--icon", "cool-step", "--set", "driver.current_limit_A=0.8", "-o", out, "--figure", picture)
    lines = cli("simulate", two, *options).stderr.splitlines()
    assert "; it is reached with its " in lines[0]
    assert lines[1:] == [f"wrote {out}", f"wrote {picture}"]


def test_a_designed_drive_replays_exactly_when_held(cli: Cli, two: Path, tmp_path: Path) -> None:
    designed = pd.read_csv(io.StringIO(cli("simulate", two, "--icon", "cool-step", "-o", "-").stdout))
    # A drive starts steady with its first current, so one period at the resting current goes ahead.
    resting_A, _ = steady_state(Rig.load("thenar"), "display", 32.0)
    lead = pd.DataFrame({"time_s": [0.0], "current_A": [resting_A]})
    shifted = designed[["time_s", "current_A"]].assign(time_s=designed["time_s"] + 0.01)
    drive = tmp_path / "drive.csv"
    pd.concat([lead, shifted]).to_csv(drive, index=False)
    miss = {}
    for name, options in (("held", ["--hold"]), ("linear", [])):
        said = cli("simulate", "--current", drive, *options, "-o", "-")
        assert said.exit_code == 0, said.stderr
        replayed = pd.read_csv(io.StringIO(said.stdout))
        assert list(replayed.columns) == COLUMNS
        assert replayed["icon"].isna().all()
        assert replayed["target_C"].isna().all()
        assert replayed["time_s"].iloc[-1] == pytest.approx(8.01)
        miss[name] = np.abs(replayed["skin_C"].to_numpy()[1:] - designed["skin_C"].to_numpy()).max()
    assert miss["held"] < 5e-4  # the first 10 ms start from a corner in one run and from a row in the other
    assert 1e-3 < miss["linear"] < 0.5


def test_too_strong_a_drive_only_warns(cli: Cli, tmp_path: Path) -> None:
    drive = tmp_path / "drive.csv"
    drive.write_text("time_s,current_A\n0,0.1\n1,2.0\n2.005,0.1\n")
    said = cli("simulate", "--current", drive, "--figure", tmp_path / "drive.png")
    assert said.exit_code == 0
    assert said.stderr.count("warning:") == 1
    assert "A" in said.stderr
    assert said.stdout.startswith("drive: 2")
    assert (tmp_path / "drive.png").stat().st_size > 10_000


@pytest.mark.slow
def test_a_figure_an_icon(cli: Cli, two: Path, tmp_path: Path) -> None:
    assert cli("simulate", two, "--figure", tmp_path / "over.png").exit_code == 0
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["over-cool-step.png", "over-warm-step.png"]


def test_a_drive_that_burns_is_called_unsafe(cli: Cli, tmp_path: Path) -> None:
    drive = tmp_path / "drive.csv"
    drive.write_text("time_s,current_A\n0,0\n1,-1.5\n30,-1.5\n")
    said = cli("simulate", "--current", drive)
    assert said.exit_code == 0
    assert "NOT SAFE: skin surface reaches" in said.stderr
    assert "hard limit" in said.stderr
