"""``thermicon simulate`` at the command line."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.notebooks.conftest import Cli
from thermicon.circuit import Rig, nearest_reachable
from thermicon.icons import read_cue

COLUMNS = [
    *("icon", "time_s", "current_A", "voltage_V", "target_C", "hot_plate_C", "display_C", "skin_C"),
    *("cold_receptor_C", "warm_receptor_C", "heat_flow_skin_W_per_m2"),
    *("heat_flow_cold_receptor_W_per_m2", "heat_flow_warm_receptor_W_per_m2"),
]
WEAK = ("--icon", "cool-step", "--set", "driver.current_limit_A=0.8")


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_the_trace_has_the_promised_columns_and_rows(cli: Cli, two: Path, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"trace{suffix}"
    said = cli.good("simulate", two, "-o", out)
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
    if suffix == ".csv":
        assert cli("simulate", two, "-o", "-").stdout == out.read_text(encoding="utf-8")


def test_one_icon_a_rate_and_a_tail(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "trace.csv"
    cli.good("simulate", two, "--icon", "warm-step", "--rate", 20, "--tail", 2, "-o", out)
    frame = pd.read_csv(out)
    assert set(frame["icon"]) == {"warm-step"}
    assert len(frame) == 161
    assert frame["target_C"].iloc[-1] == pytest.approx(32.0)


def test_films_of_a_set_are_one_for_each_icon_and_say_what_is_felt(cli: Cli, two: Path, tmp_path: Path) -> None:
    figure = ("--figure", tmp_path / "a.svg", "--icon", "cool-step")
    cli.good("simulate", two, *figure)
    before = (tmp_path / "a.svg").read_bytes()
    said = cli.good("simulate", two, *figure, "--film", tmp_path / "one.svg").stderr
    assert (tmp_path / "a.svg").read_bytes() == before
    assert f"wrote {tmp_path / 'one.svg'}: felt at " in said
    said = cli.good("simulate", two, "--film", tmp_path / "all.svg").stderr
    assert said.count("wrote ") == 2
    assert (tmp_path / "all-cool-step.svg").read_bytes() == (tmp_path / "one.svg").read_bytes()
    assert (tmp_path / "all-warm-step.svg").is_file()


def test_a_miss_is_data_and_not_a_failure(cli: Cli, two: Path, tmp_path: Path) -> None:
    said = cli.good("simulate", two, *WEAK)
    assert "NOT reached: misses its target by" in said.stdout
    icon, rig = read_cue(two)["cool-step"], Rig.load("thenar").with_(**{"driver.current_limit_A": 0.8})
    near = nearest_reachable(icon, rig)
    assert near is not None
    assert f"\n  nearest   {near.sentence}\n" in said.stdout
    lines = cli("simulate", two, *WEAK, "-o", tmp_path / "a.csv").stderr.splitlines()
    assert "; it is reached with its " in lines[0]


def test_a_netlist_is_written_and_how_to_run_it_is_said(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "cool.cir"
    said = cli("simulate", two, "--icon", "cool-step", "-o", out)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr.splitlines() == [
        "cool-step: 8 s, reached (everywhere within 1 mK)",
        f"wrote {out}; open it in LTspice, or run ngspice -b -r cool.raw cool.cir",
    ]
    text = out.read_text(encoding="ascii")
    assert text.startswith("* cool-step of two.cue on rig thenar, written by thermicon ")
    assert ".control" not in text
    assert not list(tmp_path.glob(".*"))
    assert cli("simulate", "cooling-step-skin", "-o", out).exit_code == 0, "the one icon of a set needs no name"


@pytest.mark.slow
def test_ngspice_plays_what_simulate_writes(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tool: Callable[[str], str]
) -> None:
    ngspice = tool("ngspice")
    options = ("--icon", "cool-step", "--tail", "2", "--set", "contact.area_cm2=4")
    monkeypatch.chdir(tmp_path)
    said = cli.good("simulate", two, *options, "-o", "Cool.sp")
    assert said.stderr.endswith("wrote Cool.sp; ngspice -b Cool.sp writes the probes into Cool.txt\n")
    cli.good("simulate", two, *options, "-o", "trace.csv")
    run = subprocess.run([ngspice, "-b", "Cool.sp"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    theirs = pd.read_csv(tmp_path / "Cool.txt", sep=r"\s+").add_prefix("/")
    ours = pd.read_csv(tmp_path / "trace.csv")
    for column in ("hot_plate_C", "display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
        played = np.interp(ours["time_s"], theirs["/time"], theirs[f"/v({column})"])
        assert np.abs(played - ours[column]).max() < 2e-3, column
    behind = np.interp(ours["time_s"][:-1] + 1.01e-6, theirs["/time"], theirs["/v(plus)"])
    assert np.abs(behind - ours["voltage_V"][:-1]).max() < 1e-3


TURNS = """cue 1
set turns { elements left, right; site thenar; baseline 32 °C }
icon turn { together {
  on left { warm by 3 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
  on right { cool by 3 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
} }
icon leave { on left { cool by 4 °C at 2 °C/s; return at 2 °C/s } }
"""


def test_several_elements_are_simulated_on_a_layout_with_a_row_for_each(cli: Cli, tmp_path: Path) -> None:
    (path := tmp_path / "turns.cue").write_text(TURNS, encoding="utf-8")
    said = cli.good("simulate", path, "--rig", "wheel").stdout
    headlines = [line.partition(":")[0] for line in said.splitlines() if not line.startswith(" ")]
    assert headlines == ["turn on left", "turn on right", "leave on left", "leave on right"]
    table, figure = tmp_path / "turn.csv", tmp_path / "turn.svg"
    cli.good("simulate", path, "--rig", "wheel", "--icon", "turn", "-o", table, "--figure", figure)
    assert {line.partition(",")[0] for line in table.read_text().splitlines()[1:]} == {"turn on left", "turn on right"}
    drawn = figure.read_text(encoding="utf-8")
    assert "left (°C)" in drawn
    assert "right (°C)" in drawn


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ([], "give a layout that has them, such as wheel"),
        (["--rig", "ring-four"], "give a layout that has them"),
        (["--rig", "wheel", "--film", "turn.svg"], "this set is for several; draw a --figure"),
        (["--rig", "wheel", "--icon", "trun"], "did you mean turn?"),
        (["--rig", "wheel", "--set", "contact.area_cm2=4"], "write set = { … } into an element of the layout file"),
    ],
)
def test_what_cannot_be_simulated_on_elements_is_refused(
    options: list[str], told: str, cli: Cli, tmp_path: Path
) -> None:
    (path := tmp_path / "turns.cue").write_text(TURNS, encoding="utf-8")
    said = cli("simulate", path, *options)
    assert said.exit_code
    assert told in said.stderr
