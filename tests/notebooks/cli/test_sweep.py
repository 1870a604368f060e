"""``thermicon sweep`` at the command line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from tests.notebooks.conftest import Cli
from thermicon.circuit import Rig, simulate
from thermicon.circuit.safety.verdict import summarise
from thermicon.icons import read_cue
from thermicon.notebooks import overview, sweep
from thermicon.notebooks.cli.sweep import Measured
from thermicon.perception import rank
from thermicon.perception.selection.goal_result import judge_goal
from thermicon.perception.sensation.features import attack_K_per_s, delay_s, peak_change_K

AREA, LIMIT, CONTACT = "contact.area_cm2", "driver.current_limit_A", "contact.resistance_m2K_per_W"
QUICK = ("--people", 4, "--intervals", 4)


def swept(two: Path, key: str, values: list[Any], rig: str = "thenar", **more: Any) -> pd.DataFrame:
    return sweep(read_cue(two), Rig.load(rig), key, values, **more)


def test_a_row_for_every_icon_and_value(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "sweep.csv"
    said = cli("sweep", two, "--vary", f"{AREA}=3:9:4", "-o", out)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr.splitlines() == [
        "cool-step: reached at 4 of 4 values, everywhere within 1 mK",
        "warm-step: reached at 4 of 4 values, everywhere within 1 mK",
        f"wrote {out}",
    ]
    frame = pd.read_csv(out)
    assert list(frame.columns[:4]) == ["icon", AREA, "duration_s", "reached"]
    assert list(frame["icon"]) == ["cool-step"] * 4 + ["warm-step"] * 4
    assert list(frame[AREA]) == [3, 5, 7, 9] * 2
    assert frame["reached"].all()
    assert frame["reason"].isna().all()


def test_every_number_is_that_of_the_run(two: Path) -> None:
    icons, rig = read_cue(two), Rig.load("thenar")
    frame = sweep(icons, rig, LIMIT, [0.7, 1.5], tail_s=1.0)
    assert len(frame) == 4
    for _, row in frame.iterrows():
        trace = simulate(icons[row["icon"]], rig.with_(**{LIMIT: row[LIMIT]}), tail_s=1.0)
        for name, value in summarise(trace).to_dict().items():
            assert row[name] == value or (value is None and pd.isna(row[name])), name
        for channel in ("cold", "warm"):
            assert row[f"{channel}_receptor_peak_change_K"] == peak_change_K(trace, channel)
            assert row[f"{channel}_receptor_attack_K_per_s"] == attack_K_per_s(trace, channel)
            assert row[f"{channel}_receptor_delay_s"] == delay_s(trace, channel)
    assert frame["reached"].tolist() == [False, True, True, True]


def test_colours_tell_cooling_from_warming(two: Path) -> None:
    figure = overview(swept(two, CONTACT, [3e-4, 1e-3, 3e-3]))
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["cool-step", "warm-step"]
    cool, warm = tuple(line.get_color() for line in figure.legends[0].get_lines())
    assert (cool, warm) == ("#2166ac", "#e08214")
    assert figure.get_supxlabel().startswith("contact resistance (m²·K/W)\nthe same at all values: ")
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.axes[-1].get_xticklabels()] == ["0.0003", "0.001", "0.003"]
    assert all("(" in ax.get_title(loc="right") for ax in figure.axes)
    assert figure.axes[0].get_xscale() == "log"


def test_the_table_and_its_summary(cli: Cli, two: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "m.csv", tmp_path / "m.png"
    asked = ("sweep", two, "--vary", f"{AREA}=1,9", *QUICK, "--measure")
    said = cli(*asked, "named,detected,onset,d_prime", "-o", out, "--figure", picture)
    assert said.exit_code == 0, said
    frame = pd.read_csv(out)
    assert list(frame["icon"].unique()) == ["cool-step", "warm-step", "all icons"]
    assert {"named_low", "detected_high", "onset_s", "d_prime_low", "skin_min_C", "reason"} <= set(frame.columns)
    whole = frame[frame["icon"] == "all icons"].set_index(AREA)
    assert (whole["named_low"] <= whole["named_high"]).all()
    assert "all icons: from" in said.stderr and "impossible" not in said.stderr
    assert picture.stat().st_size > 10_000
    table, _, following = cli(*asked, "felt-and-named,onset").stdout.partition("\nNext: ")
    assert "thermicon rank" in following
    rows = [line.split() for line in table.splitlines()[2:]]
    assert [row[:2] for row in rows][:2] == [["cool-step", "1"], ["cool-step", "9"]]
    assert rows[-1][:3] == ["all", "icons", "9"]
    assert int(rows[-1][3]) > int(rows[-2][3])


def test_curves_lie_over_one_another_and_the_table_is_printed(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **more: drawn.append(figure))
    said = cli.good("sweep", two, "--vary", f"{CONTACT}=1e-4,1e-3,-1", "--figure", tmp_path / "a.png").stdout
    rows = [line.split() for line in said.splitlines()[2:8]]
    assert [row[0] for row in rows] == ["cool-step"] * 3 + ["warm-step"] * 3
    assert [row[-1] for row in rows[:3]] == ["green", "green", "possible"]
    cool, warm, *_, bar = drawn[0].axes
    assert (cool.get_title(loc="right"), warm.get_title(loc="right")) == ("cool-step", "warm-step")
    assert cool.get_ylabel() == "skin (°C)"
    assert len(cool.lines) == len(warm.lines) == 2
    trace = simulate(read_cue(two)["cool-step"], Rig.load("thenar").with_(**{CONTACT: 1e-3}))
    np.testing.assert_allclose(np.asarray(cool.lines[1].get_ydata()), trace.skin_C)
    assert bar.get_ylabel() == "contact resistance (m²·K/W)"
    cli.good("sweep", two, "--vary", f"{AREA}=4,9", "--figure", tmp_path / "a.png")
    assert drawn[1].axes[0].get_ylabel() == "current (A)", "what the key changes is drawn"


def test_a_swept_value_is_what_rank_predicts(two: Path) -> None:
    icons, rig = read_cue(two), Rig.load("thenar")
    measured = Measured(icons, ("named", "detected"), people=4, intervals=4)
    frame = sweep(icons, rig, "site", ["fingertip"], measured=measured)
    document = json.loads(Rig.load("fingertip").document)
    moved = rig.with_(**{table: document[table] for table in ("skin", "contact", "blood")})
    ranking = rank(icons, moved, people=4, parameters=4)
    row = frame[frame["icon"] == "all icons"].iloc[0]
    assert row["named"] == ranking.proportion_correct and ranking.new_laboratory is not None
    assert (row["named_low"], row["named_high"]) == ranking.new_laboratory.proportion_correct
    first = frame.iloc[0]
    assert first["detected"] == ranking.icons[0].detected_probability
    assert (first["detected_low"], first["detected_high"]) == ranking.new_laboratory.detected[0]


def test_what_95_percent_of_people_reach_is_the_number_of_a_goal(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "m.csv"
    said = cli.good("sweep", two, "--vary", f"{AREA}=3,9", "--measure", "named_95", *QUICK, "-o", out)
    frame = pd.read_csv(out)
    ranking = rank(read_cue(two), Rig.load("thenar"), people=4, parameters=4)
    goal = judge_goal("named >= 1 % for 95 % of people", ranking)
    whole = frame[frame["icon"] == "all icons"].set_index(AREA)["named_95"]
    assert whole[9.0] == pytest.approx(goal.parts[0].value, rel=1e-8)
    assert frame[frame["icon"] != "all icons"]["named_95"].isna().all()
    assert f"{100 * whole[9.0]:.0f} % named for 95 % of people at {AREA} = 9" in said.stderr


def test_older_people_feel_less(two: Path) -> None:
    measured = Measured(read_cue(two), ("detected", "onset"), people=4, intervals=0)
    frame = swept(two, "people.age_years", [25.0, 80.0], "fingertip", measured=measured)
    cool = frame[frame["icon"] == "cool-step"]
    assert cool["detected"].iloc[1] < cool["detected"].iloc[0]
    assert cool["skin_min_C"].nunique() == 1
