"""``thermicon compare``: rigs, icons, sets, traces and logs; one table of differences, one figure."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from thermicon.notebooks.figures.compare_figure import compare_figure
from thermicon.notebooks.figures.differences import align, differences
from thermicon.notebooks.files.trace_files import Curves, LogError, read_curves

Cli = Callable[..., Any]


def test_two_rigs_play_the_cooling_step_unless_told(cli: Cli) -> None:
    said = cli("compare", "thenar", "shani2021")
    assert said.exit_code == 0
    assert "1046 W/m²" in said.stderr
    lines = said.stdout.splitlines()
    assert lines[:4] == [
        "cooling-step",
        "A  thenar: 8 s, reached (everywhere within 1 mK)",
        "B  shani2021: 8 s, NOT reached: misses its target by 0.42 K at 2.00 s, limited",
        "by the current limit from 0.92 s",
    ]
    assert lines[5].split() == ["B", "−", "A", "largest", "at", "rms", "mean"]
    row = next(line for line in lines if line.startswith("skin ")).split()
    assert row[2::2] == ["K", "s", "K", "K"]
    assert float(row[1]) == pytest.approx(0.993, abs=0.01)  # 0.763 with a current that reaches
    assert lines[-1] == "compared at 801 times, 0–8 s"
    assert max(map(len, lines)) <= 80


def test_two_rigs_a_file_and_a_change(cli: Cli, two: Path, tmp_path: Path) -> None:
    from importlib.resources import files

    mine = tmp_path / "mine.toml"
    shipped = (files("thermicon.circuit") / "rigs" / "thenar.toml").read_text(encoding="utf-8")
    mine.write_text(shipped.replace("area_cm2 = 9.0", "area_cm2 = 4.0"), encoding="utf-8")
    said = cli("compare", "thenar", mine, "--file", two, "--figure", tmp_path / "a.png")
    assert said.exit_code == 0, said.stderr
    assert said.stdout.startswith("cool-step\nA  thenar: 8 s, reached")
    assert "\nwarm-step\n" in said.stdout
    assert said.stderr == f"wrote {tmp_path / 'a.png'}\n"
    assert (tmp_path / "a.png").stat().st_size > 20_000
    same = cli("compare", "thenar", mine, "--file", two, "--icon", "warm-step", "--set", "contact.area_cm2=4")
    skin = next(line for line in same.stdout.splitlines() if line.startswith("skin "))
    assert skin.split()[1:3] == ["0", "K"]


def test_two_icons_the_shorter_waits_at_its_baseline(cli: Cli, two: Path) -> None:
    said = cli("compare", f"{two}:cool-step", f"{two}:warm-step")
    assert said.exit_code == 0, said.stderr
    lines = said.stdout.splitlines()
    assert lines[0] == "A  two.cue:cool-step: 8 s, reached (everywhere within 1 mK)"
    assert lines[1].startswith("B  two.cue:warm-step: 8 s, reached")
    target = next(line for line in lines if line.startswith("target "))
    assert target.split()[1:5] == ["10", "K", "2.00", "s"]


@pytest.mark.slow
def test_two_sets_are_paired_by_name(cli: Cli, two: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.cue"
    text = two.read_text(encoding="utf-8").replace("cool by 6", "cool by 5").replace("icon warm-step", "icon hot-step")
    other.write_text(text, encoding="utf-8")
    said = cli("compare", two, other)
    assert said.exit_code == 0, said.stderr
    assert said.stdout.startswith("cool-step\nA  two.cue: 8 s")
    assert f"only in one of the two sets: warm-step ({two}), hot-step ({other})" in said.stderr
    tables, _, duel = said.stdout.partition("\npredicted: ")
    assert "draws of person, contact, room and rig" in " ".join(duel.split())
    assert cli("compare", two, other, "--icon", "cool-step").stdout == tables
    assert cli("compare", two, other, "--icon", "warm-step").exit_code == 1


@pytest.mark.slow
def test_the_better_of_two_sets_is_told(cli: Cli, two: Path, tmp_path: Path) -> None:
    worse = tmp_path / "worse.cue"
    body = "{ cool by 3 °C at 3 °C/s; hold for 2 s; return at 3 °C/s }"
    alike = body.replace("by 3 ", "by 3.3 ")
    worse.write_text(f"cue 1\nset s {{ control display; baseline 32 °C }}\nicon cool-step {body}\nicon b {alike}\n")
    forth, back = (cli("compare", *sides).stdout.partition("predicted: ")[2] for sides in ((two, worse), (worse, two)))
    assert forth.startswith("the icons of A are easier to distinguish than those of B in 100 %")
    assert back == forth.replace("of A are", "of ? are").replace("those of B", "those of A").replace("of ?", "of B")
    warned = cli("compare", two, worse, "--set", "safety.skin_highest_C=38").stderr
    assert warned.count("warning:") == len({line for line in warned.splitlines() if line.startswith("warning:")}) > 0


def test_two_sets_without_a_common_name_are_scored(cli: Cli, two: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.cue"
    other.write_text(two.read_text(encoding="utf-8").replace("cool-step", "dip").replace("warm-step", "glow"))
    said = cli("compare", two, other)
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    assert "set rig icons correct d′ bits worst pair" in words
    assert f"A {two.name}, B other.cue predicted: no difference between A and B" in words
    rows = [line.split() for line in said.stdout.splitlines() if " thenar " in line]
    assert [row[0] for row in rows] == [two.name, "other.cue"]
    assert rows[0][2:6] == rows[1][2:6]


@pytest.mark.slow
def test_sets_on_several_rigs_are_a_table(cli: Cli, two: Path) -> None:
    said = cli("compare", two, "six-icons", "--rigs", "thenar, fingertip")
    assert said.exit_code == 0, said.stderr
    rows = [line.split()[:3] for line in said.stdout.splitlines() if " thenar " in line or " fingertip " in line]
    assert rows == [
        [two.name, "thenar", "2"],
        [two.name, "fingertip", "2"],
        ["six-icons", "thenar", "6"],
        ["six-icons", "fingertip", "6"],
    ]


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("six-icons", "wave-shapes", "--rigs", "thenr"), 1, "did you mean thenar"),
        (("six-icons", "wave-shapes", "--rigs", "thenar", "--rig", "thenar"), 2, "the rigs are those of --rigs"),
        (("six-icons", "wave-shapes", "--figure", "a.png", "--rigs", "thenar"), 2, "leave it out"),
        (("thenar", "fingertip", "--rigs", "thenar"), 2, "belongs to two sets"),
        (("six-icons", "search-space", "--rigs", "thenar"), 1, "sets of 2 to 30 icons are compared"),
    ],
)
def test_bad_comparisons_of_sets(cli: Cli, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("compare", *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())


def measured(folder: Path, cli: Cli, two: Path) -> tuple[Path, Path]:
    """A trace, and a log made from it: other times, fewer columns, skin 0.2 K warmer, one reading lost."""
    trace = folder / "trace.csv"
    assert cli("simulate", two, "--icon", "cool-step", "-o", trace).exit_code == 0
    frame = pd.read_csv(trace)
    times = np.arange(0.5, 9.0, 0.25)
    log = pd.DataFrame({"time_s": times, "note": "x"})
    for column, more in (("display_C", 0.0), ("skin_C", 0.2)):
        log[column] = np.interp(times, frame["time_s"], frame[column]) + more
    log.loc[3, "display_C"] = np.nan
    path = folder / "log.csv"
    log.to_csv(path, index=False)
    return trace, path


def test_a_trace_and_a_log_are_compared_at_the_times_of_the_log(cli: Cli, two: Path, tmp_path: Path) -> None:
    trace, log = measured(tmp_path, cli, two)
    said = cli("compare", trace, log, "--figure", tmp_path / "a.png")
    assert said.exit_code == 0, said.stderr
    lines = said.stdout.splitlines()
    assert lines[:2] == ["A  trace.csv", "B  log.csv"]
    assert next(line for line in lines if line.startswith("skin ")).split()[-2:] == ["0.2", "K"]
    assert next(line for line in lines if line.startswith("display ")).split()[1:3] == ["0", "K"]
    assert " ".join(lines[-2:]).split("compared")[1] == (
        " at the 31 times of log.csv in the common span, 0.5–8 s; trace.csv interpolated between its rows"
    )
    assert "log.csv: ignored columns that no trace has: note" in said.stderr
    turned = cli("compare", log, trace)
    assert next(line for line in turned.stdout.splitlines() if line.startswith("skin ")).split()[-2:] == ["−0.2", "K"]
    assert "the 31 times of log.csv" in turned.stdout


def test_a_trace_file_with_several_icons_needs_a_name(cli: Cli, two: Path, tmp_path: Path) -> None:
    _, log = measured(tmp_path, cli, two)
    both = tmp_path / "both.parquet"
    assert cli("simulate", two, "-o", both).exit_code == 0
    said = cli("compare", both, log)
    assert said.exit_code == 2
    assert "has traces of 2 icons; name one of cool-step, warm-step" in " ".join(said.stderr.split())
    assert cli("compare", both, log, "--icon", "cool-step").exit_code == 0
    wrong = cli("compare", both, log, "--icon", "cool-stp")
    assert wrong.exit_code == 1
    assert "no trace of cool-stp; did you mean cool-step?" in wrong.stderr


GOOD = "time_s,skin_C\n0,30\n1,31\n2,32\n"
LOGS = [
    ("", "the file is empty; a trace or log was expected"),
    ("skin_C\n30\n31\n", "the column time_s (time in s) is missing; found skin_C"),
    ("time_s,skin\n0,30\n1,31\n", "none of its columns is one of a trace, such as display_C or skin_C; found time_s"),
    ("time_s,skin\n0,30\n1,31\n", "skin: did you mean skin_C"),
    ("time_s;skin_C\n0;30,5\n", "1 rows; at least two are needed"),
    ("time_s,skin_C\n0,30\n1,warm\n", ":3: skin_C is 'warm', not a finite number"),
    ("time_s,skin_C\n0,30\n1,inf\n", ":3: skin_C is 'inf', not a finite number"),
    ("time_s,skin_C\n0,30\n\n2,31\n1,31\n", ":5: time_s 1 s does not come after 2 s; times must increase"),
    ("time_s,skin_C\n0,30\n,31\n", ":3: time_s is empty"),
    ("time_s,skin_C\n0,30\n", "1 rows; at least two are needed"),
    ("time_s,skin_C,skin_C\n0,30,1\n1,30,1\n", ":1: the column skin_C appears twice; rename or remove one of them"),
    ("time_s,display_C\n0,30\n1,30\n", "no column with values in both: bad.csv has display_C; good.csv has skin_C"),
    ("time_s,skin_C\n5,30\n9,30\n", "no two rows at a common time: bad.csv 5–9 s and good.csv 0–2 s; shift time_s"),
    ("time_s,skin_C\n0,30,5\n1,30,5\n", ":2: 3 cells, where the first line names 2; write decimal points"),
    ("time_s,skin_C\n0,30\n1,1e308\n", ":3: skin_C is '1e308', not a finite number of at most 1e+09; correct it, or"),
    ("time_s," + "x" * 200_000 + "\n0,30\n1,30\n", ":1: this row cannot be read (field larger than"),
]


@pytest.mark.parametrize(("text", "words"), LOGS)
def test_a_log_that_cannot_be(cli: Cli, tmp_path: Path, text: str, words: str) -> None:
    bad, good = tmp_path / "bad.csv", tmp_path / "good.csv"
    bad.write_text(text, encoding="utf-8")
    good.write_text(GOOD, encoding="utf-8")
    said = cli("compare", bad, good)
    assert (said.exit_code, said.stdout) == (1, "")
    assert words in said.stderr


def test_lines_that_end_as_on_an_old_macintosh(cli: Cli, tmp_path: Path) -> None:
    old, good = tmp_path / "old.csv", tmp_path / "good.csv"
    old.write_bytes(GOOD.replace("\n", "\r").encode())
    good.write_text(GOOD, encoding="utf-8")
    assert cli("compare", old, good).stdout.replace("old.csv", "good.csv") == cli("compare", good, good).stdout


def test_a_column_without_a_number_cannot_be_aligned(cli: Cli, tmp_path: Path) -> None:
    empty, good = tmp_path / "empty.csv", tmp_path / "good.csv"
    empty.write_text("time_s,skin_C\n0,\n1,\n2,\n", encoding="utf-8")
    good.write_text(GOOD, encoding="utf-8")
    said = cli("compare", good, empty, "--align")
    assert (said.exit_code, said.stdout) == (1, "")
    assert "no shift makes its skin_C like that of good.csv; leave out --align" in said.stderr


def test_a_file_that_is_missing_or_no_parquet(cli: Cli, tmp_path: Path) -> None:
    good, odd = tmp_path / "good.csv", tmp_path / "odd.parquet"
    good.write_text(GOOD, encoding="utf-8")
    odd.write_bytes(b"odd")
    assert "no such trace or log" in cli("compare", good, tmp_path / "absent.csv").stderr
    assert "no such trace or log" in cli("compare", good, tmp_path / "absent.parquet").stderr
    assert "not a Parquet file that can be read" in cli("compare", good, odd).stderr


def test_a_parquet_file_without_pyarrow(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    good, packed = tmp_path / "good.csv", tmp_path / "packed.parquet"
    good.write_text(GOOD, encoding="utf-8")
    packed.write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    said = cli("compare", good, packed)
    assert (said.exit_code, said.stdout) == (1, "")
    assert 'pip install "thermicon[parquet]"' in " ".join(said.stderr.split())


USAGE = [
    (
        ("thenar", "six-icons"),
        "thenar is a rig and six-icons is an icon set; both must be of the same kind (a rig",
    ),
    (
        ("six-icons", "six-icons:double-dip"),
        "both must be of the same kind: write the one icon of the set as FILE:ICON",
    ),
    (("six-icons:double-dip", "log.csv"), "write a trace first with thermicon simulate FILE --icon NAME -o trace.csv"),
    (("thenr", "thenar"), "thenr cannot be compared; did you mean thenar? (a rig is a name or a .toml file"),
    (("odd", "thenar"), "odd: its name does not show what it is; a rig is a name or a .toml file, an icon FILE:ICON"),
    (("thenar", "shani2021", "--rig", "thenar"), "'--rig': the two rigs are A and B"),
    (("six-icons", "six-icons", "--file", "a.cue"), "'--file': belongs to two rigs"),
    (("six-icons:double-dip", "six-icons:double-dip", "--icon", "a"), "'--icon': the two icons are A and B"),
    (("six-icons:", "six-icons:double-dip"), "six-icons: ends with a colon; put the name of an icon behind it"),
    (("a.csv", "b.csv", "--set", "contact.area_cm2=4"), "'--set': traces and logs are compared as they are"),
    (("a.csv", "b.csv", "--set", "contact.area_cm2"), "is not of the form KEY=VALUE"),
    (("thenar",), "Missing argument"),
]


@pytest.mark.parametrize(("arguments", "words"), USAGE)
def test_what_makes_no_sense_is_a_usage_error(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("odd").write_text("x", encoding="utf-8")
    said = cli("compare", *arguments)
    assert (said.exit_code, said.stdout) == (2, "")
    assert words in " ".join(said.stderr.split())


def test_a_figure_that_cannot_be_is_told_first(cli: Cli) -> None:
    said = cli("compare", "thenar", "shani2021", "--figure", "a.gif")
    assert (said.exit_code, said.stdout) == (1, "")
    assert ".png or .pdf or .svg, not .gif" in said.stderr


def curves(name: str, time: list[float], whole: bool = False, **columns: list[float]) -> Curves:
    return Curves(name, np.array(time), {key: np.array(value) for key, value in columns.items()}, whole)


def test_differences_of_known_curves() -> None:
    a = curves("a", [0, 1, 2], skin_C=[30.0, 30.0, 30.0])
    b = curves("b", [0, 1, 2], skin_C=[30.0, 33.0, 26.0])
    (row,) = differences(align(a, b)).to_dict("records")
    assert (row["column"], row["unit"], row["largest"], row["largest_s"], row["rows"]) == ("skin_C", "K", -4, 2, 3)
    assert row["rms"] == pytest.approx(np.sqrt(25 / 3))
    assert row["mean"] == pytest.approx(-1 / 3)


def test_a_held_current_is_not_interpolated_and_the_rest_is() -> None:
    trace = curves("t", [0, 1, 2], True, current_A=[1.0, 3.0, 3.0], skin_C=[30.0, 32.0, 32.0])
    log = curves("l", [0.25, 0.75, 1.0], current_A=[1.0, 1.0, 3.0], skin_C=[30.5, 31.5, 32.0])
    both = align(trace, log)
    assert list(both.time_s) == [0.25, 0.75, 1.0]
    assert differences(both)["largest"].tolist() == [0.0, 0.0]


def test_what_was_not_measured_is_left_out() -> None:
    a = curves("a", [0, 1, 2, 3], skin_C=[30.0, 30.0, 30.0, 30.0], display_C=[np.nan] * 4)
    b = curves("b", [0, 1, 2, 3], skin_C=[31.0, np.nan, 31.0, np.nan], display_C=[1.0] * 4)
    (row,) = differences(align(a, b)).to_dict("records")
    assert (row["rows"], row["mean"]) == (2, 1.0)
    with pytest.raises(LogError, match="no column with values in both"):
        align(curves("a", [0, 1], skin_C=[np.nan] * 2), curves("b", [0, 1], skin_C=[1.0] * 2))


def test_the_columns_of_further_probes_are_read(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time_s, probe_finger_C, room\n0, 30, 1\n1, 31, 1\n\n", encoding="utf-8")
    found = read_curves(str(path))
    assert (list(found.columns), found.ignored, found.whole) == (["probe_finger_C"], ("room",), False)


def test_the_figure_has_a_panel_of_differences_below_each_of_curves() -> None:
    a = curves("a", [0, 1], skin_C=[30.0, 31.0], warm_receptor_C=[32.0, 32.0], heat_flow_skin_W_per_m2=[0.0, 500.0])
    b = curves("b", [0, 1], skin_C=[30.0, 32.0], warm_receptor_C=[32.0, 32.0], heat_flow_skin_W_per_m2=[0.0, 900.0])
    figure = compare_figure([("", align(a, b))])
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert labels == ["°C", "°C", "kW/m²", "B − A (K)", "B − A (K)", "B − A (kW/m²)"]
    assert [ax.get_title() for ax in figure.axes[:3]] == ["skin", "warm receptor", "heat flow, skin"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["A  a", "B  b"]
    assert figure.axes[5].get_lines()[-1].get_ydata()[-1] == pytest.approx(0.4)
    assert figure.axes[1].get_lines()[-1].get_color() == "#e08214"
    assert np.ptp(figure.axes[4].get_ylim()) >= 0.01  # equal curves do not fill the panel with rounding


def test_a_log_with_a_clock_of_its_own_is_aligned(cli: Cli, tmp_path: Path) -> None:
    trace, log = tmp_path / "trace.csv", tmp_path / "log.csv"
    assert cli("simulate", "six-icons", "--icon", "double-dip", "--rate", "20", "-o", trace).exit_code == 0
    frame = pd.read_csv(trace)[["time_s", "display_C"]]
    frame["time_s"] += 3600.25
    frame["display_C"] += 0.1
    frame.to_csv(log, index=False)
    assert "no two rows at a common time" in cli("compare", trace, log).stderr
    said = cli("compare", trace, log, "--align")
    assert said.exit_code == 0, said.stderr
    assert "B was shifted by −3600.25 s, by the correlation of display (1)" in said.stdout
    assert next(line for line in said.stdout.splitlines() if line.startswith("display ")).split()[1] == "0.1"
    misplaced = cli("compare", "thenar", "shani2021", "--align")
    assert misplaced.exit_code == 2 and "clocks of their own" in misplaced.stderr
    frame.rename(columns={"display_C": "probe_a_C"}).to_csv(log, index=False)
    assert "no column in both trace.csv and log.csv to align them by" in cli("compare", trace, log, "--align").stderr
