"""``thermicon sweep``: the table as scripts read it, the summary lines and figures as people do."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.summary import summarise
from thermicon.icons import read_cue
from thermicon.notebooks import sweep
from thermicon.notebooks.figures.print_figure import restyle
from thermicon.notebooks.figures.sweep_figure import sweep_figure
from thermicon.perception.sensation.features import attack_K_per_s, delay_s, peak_change_K

Cli = Callable[..., Any]
AREA = "contact.area_cm2"


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_row_for_every_icon_and_value(cli: Cli, two: Path, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"sweep{suffix}"
    said = cli("sweep", two, "--vary", f"{AREA}=4:16:4", "-o", out)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr.splitlines() == [
        "cool-step: reached at 4 of 4 values, everywhere within 1 mK",
        "warm-step: reached at 4 of 4 values, everywhere within 1 mK",
        f"wrote {out}",
    ]
    frame = pd.read_csv(out) if suffix == ".csv" else pd.read_parquet(out)
    assert list(frame.columns[:4]) == ["icon", AREA, "duration_s", "reached"]
    assert list(frame["icon"]) == ["cool-step"] * 4 + ["warm-step"] * 4
    assert list(frame[AREA]) == [4, 8, 12, 16] * 2
    assert frame["reached"].all()
    assert frame["reason"].isna().all()
    assert not list(tmp_path.glob(".*"))


def test_every_number_is_that_of_the_run(two: Path) -> None:
    icons, rig = read_cue(two), Rig.load("thenar")
    frame = sweep(icons, rig, "driver.current_limit_A", [0.7, 1.5], tail_s=1.0)
    assert len(frame) == 4
    for _, row in frame.iterrows():
        limited = rig.with_(**{"driver.current_limit_A": row["driver.current_limit_A"]})
        trace = simulate(icons[row["icon"]], limited, tail_s=1.0)
        for name, value in summarise(trace).to_dict().items():
            assert row[name] == value or (value is None and pd.isna(row[name])), name
        for channel in ("cold", "warm"):
            assert row[f"{channel}_receptor_peak_change_K"] == peak_change_K(trace, channel)
            assert row[f"{channel}_receptor_attack_K_per_s"] == attack_K_per_s(trace, channel)
            assert row[f"{channel}_receptor_delay_s"] == delay_s(trace, channel)
    assert frame["reached"].tolist() == [False, True, True, True]


def test_equal_ratios(cli: Cli, two: Path) -> None:
    said = cli("sweep", two, "--icon", "cool-step", "--vary", "contact.resistance_m2K_per_W=1e-4:1e-2:3log", "-o", "-")
    frame = pd.read_csv(io.StringIO(said.stdout))
    assert list(frame["contact.resistance_m2K_per_W"]) == [1e-4, 1e-3, 1e-2]
    assert frame["cold_receptor_peak_change_K"].is_monotonic_increasing


@pytest.mark.slow
def test_two_keys_make_a_grid(cli: Cli, two: Path, tmp_path: Path) -> None:
    limit, out, figure = "driver.current_limit_A", tmp_path / "grid.csv", tmp_path / "grid.png"
    options = ("--vary", f"{AREA}=4:16:2", "--vary", f"{limit}=0.7:1.5:3", "--figure", figure)
    said = cli("sweep", two, *options, "-o", out)
    assert said.exit_code == 0, said.stderr
    frame = pd.read_csv(out)
    assert list(frame.columns[:3]) == ["icon", AREA, limit]
    one = frame[frame["icon"] == "cool-step"]
    assert list(zip(one[AREA], one[limit], strict=True)) == [(a, c) for a in (4, 16) for c in (0.7, 1.1, 1.5)]
    assert len(frame) == 12
    rig = Rig.load("thenar").with_(**{AREA: 16.0, limit: 0.7})
    alone = summarise(simulate(read_cue(two)["cool-step"], rig))
    row = one[(one[AREA] == 16) & (one[limit] == 0.7)].iloc[0]
    assert row["skin_min_C"] == pytest.approx(alone.skin_min_C, rel=1e-8)
    assert "of 6 combinations" in said.stderr
    assert figure.stat().st_size > 20_000


def test_more_than_two_keys_or_one_key_twice_are_refused(cli: Cli, two: Path) -> None:
    for keys, words in (
        ((AREA, "driver.current_limit_A", "skin.rest_C"), "3 keys are given; at most 2 can be varied"),
        ((AREA, AREA), f"{AREA} is given twice"),
    ):
        said = cli("sweep", two, *(word for key in keys for word in ("--vary", f"{key}=1:2:2")), "-o", "-")
        assert (said.exit_code, said.stdout) == (2, "")
        assert words in " ".join(said.stderr.split())


def test_a_layer_of_the_skin_can_be_swept(two: Path) -> None:
    frame = sweep(read_cue(two), Rig.load("thenar"), "skin.layer.stratum corneum.thickness_mm", [0.1, 0.4])
    peaks = frame.loc[frame["icon"] == "cool-step", "warm_receptor_peak_change_K"]
    assert len(peaks.unique()) == 2


@pytest.mark.slow
def test_an_impossible_value_is_a_row_with_the_reason(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "sweep.csv"
    said = cli("sweep", two, "--vary", f"{AREA}=-5:10:4", "-o", out, "--figure", tmp_path / "sweep.png")
    assert said.exit_code == 0
    assert said.stderr.splitlines()[:3] == [
        "cool-step: reached at 2 of 4 values, everywhere within 1 mK, impossible at 2",
        "warm-step: reached at 2 of 4 values, everywhere within 1 mK, impossible at 2",
        f"impossible, as at {AREA} = -5: rig thenar: {AREA} = -5.0 cm²: must be at least 0.01 cm²",
    ]
    frame = pd.read_csv(out)
    lost = frame[frame[AREA] <= 0]
    assert lost["reason"].str.contains("must be at least 0.01 cm²").all()
    assert lost[["reached", "safe", "duration_s", "skin_min_C"]].isna().all(axis=None)


def test_a_baseline_that_no_current_holds_is_a_row_with_the_reason(two: Path) -> None:
    frame = sweep(read_cue(two), Rig.load("thenar"), "driver.current_limit_A", [0.01, 1.5])
    reason = frame["reason"].iloc[0]
    assert "a baseline of 32 °C on the display cannot be held: it needs" in reason
    assert "choose a baseline nearer to rest or a wider current limit" in reason


def test_a_level_that_the_language_does_not_know_is_a_row_with_the_reason(tmp_path: Path) -> None:
    path = tmp_path / "free.cue"
    path.write_text("cue 1\nicon a { warm to 34 °C at 1 °C/s; return at 1 °C/s }\n", encoding="utf-8")
    frame = sweep(read_cue(path), Rig.load("thenar"), "skin.rest_C", [32.0, 38.0])
    assert frame["reason"].isna().tolist() == [True, False]


def test_all_impossible_is_an_error_and_leaves_no_file(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "sweep.csv"
    said = cli("sweep", two, "--vary", f"{AREA}=-3:-1:3", "-o", out)
    assert (said.exit_code, said.stdout) == (1, "")
    assert f"--vary {AREA}: none of the 3 values can be played; the first: rig thenar: {AREA} = -3.0 cm²" in said.stderr
    assert not out.exists()


def test_an_unsafe_run_is_counted(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "amps.cue"
    path.write_text(
        "cue 1\nset amps { control current }\nicon a { to -0.5 A at 1 A/s; hold for 60 s; return at 1 A/s }\n",
        encoding="utf-8",
    )
    said = cli("sweep", path, "--vary", "heat_sink.temperature_C=20:60:3", "-o", tmp_path / "a.csv")
    assert said.exit_code == 0, said.stderr
    assert "a: played at 3 of 3 values, NOT SAFE at " in said.stderr


def test_an_unknown_key_names_the_nearest(cli: Cli, two: Path) -> None:
    said = cli("sweep", two, "--vary", "contact.area=1:2:3", "-o", "-")
    assert (said.exit_code, said.stdout) == (1, "")
    assert "contact.area: unknown key; did you mean contact.area_cm2?" in said.stderr
    with pytest.raises(RigError, match="unknown key"):
        sweep(read_cue(two), Rig.load("thenar"), "contact.area", [1.0])


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("contact.area_cm2", "give KEY=LOW:HIGH:N, for example contact.area_cm2=4:16:7"),
        (f"{AREA}=4:9", "give KEY=LOW:HIGH:N"),
        ("=4:9:3", "give KEY=LOW:HIGH:N"),
        (f"{AREA}=four:9:3", "'four' is not a number"),
        (f"{AREA}=4:nan:3", "'nan' is not a number"),
        (f"{AREA}=4:9:2.5", "'2.5' is not a number of values"),
        (f"{AREA}=4:9:1", "1 values is outside 2 to 10000"),
        (f"{AREA}=4:9:1000000", "1000000 values is outside 2 to 10000"),
        (f"{AREA}=4:4:3", "both ends are 4; a sweep needs two different ends"),
        (f"{AREA}=0:4:3log", "equal ratios need both ends above 0; leave out log for equal steps"),
    ],
)
def test_a_range_that_is_none(cli: Cli, two: Path, vary: str, words: str) -> None:
    said = cli("sweep", two, "--vary", vary, "-o", "-")
    assert (said.exit_code, said.stdout) == (2, "")
    assert "--vary" in said.stderr
    assert words in " ".join(said.stderr.split())


@pytest.mark.parametrize(("option", "name", "words"), [
    ("-o", "out.txt", "a sweep is written as .csv or .parquet, not .txt"),
    ("--figure", "out.gif", "a figure is written as .png or .pdf or .svg, not .gif"),
])  # fmt: skip
def test_an_output_that_cannot_be(cli: Cli, two: Path, option: str, name: str, words: str) -> None:
    said = cli("sweep", two, "--vary", f"{AREA}=4:9:3", "-o", "-", option, name)
    assert (said.exit_code, said.stdout) == (1, "")
    assert words in said.stderr


def test_figure_colours_tell_cooling_from_warming(two: Path) -> None:
    key = "contact.resistance_m2K_per_W"
    frame = sweep(read_cue(two), Rig.load("thenar"), key, [3e-4, 1e-3, 3e-3])
    figure = sweep_figure(frame, key, log=True)
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["cool-step", "warm-step"]
    cool, warm = tuple(line.get_color() for line in figure.legends[0].get_lines())
    assert (cool, warm) == ("#2166ac", "#e08214")
    assert figure.get_supxlabel().startswith("contact resistance (m²·K/W)\nthe same at all values: ")
    figure.draw_without_rendering()
    assert [text.get_text() for text in figure.axes[-1].get_xticklabels()] == ["0.0003", "0.001", "0.003"]
    assert all("(" in ax.get_ylabel() for ax in figure.axes)
    assert figure.axes[0].get_xscale() == "log"


def test_a_figure_for_a_column_is_no_taller_than_a_fifth_more_than_it_is_wide(two: Path) -> None:
    icons, rig = read_cue(two), Rig.load("thenar")
    for key, values, count in (("contact.area_cm2", [4.0, 9.0], 2), ("contact.resistance_m2K_per_W", [3e-4, 3e-3], 7)):
        figure = sweep_figure(sweep(icons, rig, key, values), key, across=2)
        restyle(figure, 85.0)
        assert len(figure.axes) == count
        assert "the same at all values: largest miss; display" in " ".join(figure.get_supxlabel().split())
        assert float(figure.get_figheight()) <= 1.2 * float(figure.get_figwidth())
        figure.draw_without_rendering()
        boxes = [ax.yaxis.label.get_window_extent() for ax in figure.axes]
        assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])


def test_where_all_is_the_same_it_is_drawn_flat_and_not_as_its_last_digits(two: Path) -> None:
    frame = sweep(read_cue(two), Rig.load("thenar"), "contact.area_cm2", [4.0, 4.0 + 1e-9])
    figure = sweep_figure(frame, "contact.area_cm2")
    assert len(figure.axes) == 9
    low, high = figure.axes[5].get_ylim()
    assert high - low > 0.1
    figure.draw_without_rendering()
    assert figure.axes[5].yaxis.get_offset_text().get_text() == ""


@pytest.mark.slow
def test_figure_marks_what_was_missed_and_what_was_impossible(two: Path, tmp_path: Path) -> None:
    key = "driver.current_limit_A"
    frame = sweep(read_cue(two), Rig.load("thenar"), key, [0.0, 0.5, 1.0, 1.5])
    figure = sweep_figure(frame, key)
    assert [text.get_text() for text in figure.legends[0].get_texts()][2:] == ["not reached", "impossible"]
    figure.savefig(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 20_000


QUICK = ("--people", 4, "--intervals", 4)


def test_what_people_perceive_stands_beside_what_the_rig_does(cli: Cli, two: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "m.csv", tmp_path / "m.png"
    measures = ("--measure", "correct,detected,onset,d_prime")
    said = cli("sweep", two, "--vary", f"{AREA}=1,9", *measures, *QUICK, "-o", out, "--figure", picture)
    assert said.exit_code == 0, said
    frame = pd.read_csv(out)
    assert list(frame["icon"].unique()) == ["cool-step", "warm-step", "all icons"]
    assert {"correct_low", "detected_high", "onset_s", "d_prime_low", "skin_min_C", "reason"} <= set(frame.columns)
    whole = frame[frame["icon"] == "all icons"].set_index(AREA)
    assert (whole["correct_low"] <= whole["correct_high"]).all()
    assert "all icons: from" in said.stderr and "impossible" not in said.stderr
    assert picture.stat().st_size > 10_000


def test_a_swept_value_is_what_rank_predicts(two: Path) -> None:
    from thermicon.notebooks.cli.sweep import Measured
    from thermicon.perception import rank

    icons, rig = read_cue(two), Rig.load("thenar")
    measured = Measured(icons, ("correct", "detected"), people=4, intervals=4)
    frame = sweep(icons, rig, "site", ["fingertip"], measured=measured)
    moved = rig.with_(**_of("fingertip"))
    ranking = rank(icons, moved, people=4, parameters=4)
    row = frame[frame["icon"] == "all icons"].iloc[0]
    assert row["correct"] == ranking.proportion_correct and ranking.new_laboratory is not None
    assert (row["correct_low"], row["correct_high"]) == ranking.new_laboratory.proportion_correct
    first = frame.iloc[0]
    assert first["detected"] == ranking.icons[0].detected_probability
    assert (first["detected_low"], first["detected_high"]) == ranking.new_laboratory.detected[0]


def test_what_95_percent_of_people_reach_is_the_number_of_a_goal(cli: Cli, two: Path, tmp_path: Path) -> None:
    from thermicon.perception import rank
    from thermicon.perception.selection.goal_result import judge_goal

    said = cli(
        "sweep", two, "--vary", f"{AREA}=3,9", "--measure", "correct_95", *QUICK, "-o", tmp_path / "m.csv",
        "--figure", tmp_path / "m.png",
    )  # fmt: skip
    assert said.exit_code == 0, said.stderr
    frame = pd.read_csv(tmp_path / "m.csv")
    ranking = rank(read_cue(two), Rig.load("thenar"), people=4, parameters=4)
    goal = judge_goal("correct >= 1 % for 95 % of people", ranking)
    whole = frame[frame["icon"] == "all icons"].set_index(AREA)["correct_95"]
    assert whole[9.0] == pytest.approx(goal.parts[0].value, rel=1e-8)
    assert frame[frame["icon"] != "all icons"]["correct_95"].isna().all()
    assert f"{100 * whole[9.0]:.0f} % correct for 95 % of people at {AREA} = 9" in said.stderr
    printed = cli("sweep", two, "--vary", f"{AREA}=3,9", "--measure", "correct_95", *QUICK).stdout.splitlines()[2:]
    assert [row.split()[:3] for row in printed] == [["all", "icons", "3"], ["all", "icons", "9"]]


def _of(name: str) -> dict[str, Any]:
    import json

    document = json.loads(Rig.load(name).document)
    return {table: document[table] for table in ("skin", "contact", "blood")}


def test_older_people_feel_less(two: Path) -> None:
    from thermicon.notebooks.cli.sweep import Measured

    measured = Measured(read_cue(two), ("detected", "onset"), people=4, intervals=0)
    frame = sweep(read_cue(two), Rig.load("fingertip"), "people.age_years", [25.0, 80.0], measured=measured)
    cool = frame[frame["icon"] == "cool-step"]
    assert cool["detected"].iloc[1] < cool["detected"].iloc[0]
    assert cool["skin_min_C"].nunique() == 1


def test_two_keys_with_a_site_make_maps(cli: Cli, two: Path, tmp_path: Path) -> None:
    vary = ("--vary", "site=thenar,forearm", "--vary", f"{AREA}=4,9")
    said = cli("sweep", two, *vary, "--measure", "correct", *QUICK, "-o", "-", "--figure", tmp_path / "m.png")
    frame = pd.read_csv(io.StringIO(said.stdout))
    assert len(frame) == 3 * 4 and set(frame["site"]) == {"thenar", "forearm"}


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (
            ("--vary", f"{AREA}=1:9:2", "--measure", "fun"),
            2,
            "'fun' is not one of correct, correct_95, detected, onset, d_prime, bits",
        ),
        (("--vary", f"{AREA}=1:9:2", "--measure", "bits,bits"), 2, "the same quantity is given twice"),
        (("--vary", f"{AREA}=1:9:2", "--measure", "bits", "--intervals", 1), 2, "1 draw has no interval"),
        (("--vary", f"{AREA}=1:9:2", "--measure", "correct_95", "--intervals", 0), 2, "needs 2 draws or more"),
        (("--vary", "people.age_years=20:80:3"), 2, "changes what people perceive only; add --measure correct"),
        (("--vary", "people.age_years=8:80:3", "--measure", "bits"), 1, "an age of 8 years is not covered"),
        (("--vary", "site=thenar,nose"), 1, "site=nose: there is no such site; there are fingertip, forearm"),
        (("--vary", "site=1:3:2"), 2, "sites are names; give them as site=thenar,fingertip"),
        (("--vary", f"{AREA}=1,x"), 2, "'x' is not a number"),
        (("--vary", f"{AREA}=1,1"), 2, "the same value is given twice"),
    ],
)
def test_measures_and_values_that_cannot_be(cli: Cli, two: Path, options: Any, code: int, words: str) -> None:
    said = cli("sweep", two, *options, "-o", "-")
    assert said.exit_code == code and words in " ".join(said.stderr.replace("│", " ").split()), said


def test_without_an_output_what_people_perceive_is_printed(cli: Cli, two: Path) -> None:
    said = cli("sweep", two, "--vary", f"{AREA}=1,9", "--measure", "correct,onset", *QUICK)
    assert said.exit_code == 0, said.stderr
    rows = [line.split() for line in said.stdout.splitlines()[2:]]
    assert [row[:2] for row in rows][:2] == [["cool-step", "1"], ["cool-step", "9"]]
    assert rows[-1][:4] == ["all", "icons", "9", rows[-1][3]]
    assert int(rows[-1][3]) > int(rows[-2][3])


def test_a_sweep_without_any_output_is_a_usage_error(cli: Cli, two: Path) -> None:
    said = cli("sweep", two, "--vary", f"{AREA}=1,9")
    assert (said.exit_code, said.stdout) == (2, "")
    assert "give -o OUT for the table" in " ".join(said.stderr.split())
