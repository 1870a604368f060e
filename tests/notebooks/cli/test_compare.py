"""``thermicon compare``: rigs, icons, sets, traces or logs in one table with one figure."""

import json
import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import GreenVerdict
from tests.notebooks.conftest import Cli
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library
from thermicon.notebooks.files.trace_files import Curves, TraceFileError, align, differences
from thermicon.perception import rank


def row(said: Any, name: str) -> list[str]:
    """Words of the row of the table that begins with a name."""
    return list(next(line for line in said.stdout.splitlines() if line.startswith(f"{name} ")).split())


def test_two_rigs_play_the_cooling_step_unless_told(cli: Cli) -> None:
    said = cli.good("compare", "thenar", "shani2021")
    assert "warning: shani2021: skin at rest loses 1046 W/m²" in said.stderr
    lines = said.stdout.splitlines()
    assert lines[:2] == ["cooling-step", "A  thenar: 8 s, reached (everywhere within 1 mK)"]
    assert lines[2].startswith("B  shani2021: 8 s, NOT reached: misses its target by 0.42 K at 2.00 s")
    assert lines[5].split() == ["B", "−", "A", "largest", "at", "rms", "mean"]
    skin = row(said, "skin")
    assert skin[2::2] == ["K", "s", "K", "K"]
    assert float(skin[1]) == pytest.approx(0.993, abs=0.01)  # 0.763 with a current that reaches
    assert lines[-1] == "compared at 801 times, 0–8 s"
    assert max(map(len, lines)) <= 80


def test_two_icons_the_shorter_waits_at_its_baseline(cli: Cli, two: Path) -> None:
    said = cli.good("compare", f"{two}:cool-step", f"{two}:warm-step")
    lines = said.stdout.splitlines()
    assert lines[0] == "A  two.cue:cool-step: 8 s, reached (everywhere within 1 mK)"
    assert lines[1].startswith("B  two.cue:warm-step: 8 s, reached")
    assert row(said, "target")[1:5] == ["10", "K", "2.00", "s"]


def test_two_sets_without_a_common_name_are_compared_as_a_whole(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same icons under other names tie; against the easier set of two, six are named worse."""
    other = tmp_path / "other.cue"
    other.write_text(
        two.read_text(encoding="utf-8").replace("cool-step", "x").replace("warm-step", "y"), encoding="utf-8"
    )
    monkeypatch.setattr("thermicon.perception.rank", partial(rank, people=40, parameters=8))
    lines = cli.good("compare", two, other).stdout.splitlines()
    rows = {line[:22].strip(): line[22:].split() for line in lines[2:10]}
    assert rows["felt and named"][:2] == rows["felt and named"][2:]
    monkeypatch.setattr("thermicon.notebooks.cli.compare.MOST_ICONS", 6)  # as many as there may be
    assert "50 % of people feel and name" in " ".join(lines) and "by 0 points in the mean" in " ".join(lines)
    said = " ".join(cli.good("compare", "six-icons", other).stdout.split())
    assert (
        found := re.search(
            r"\d+ % of people feel and name other better, by ([\d.]+) points in the mean, with the", said
        )
    )
    assert (shares := re.search(r"felt and named (\d+) % (\d+) %", said))
    assert float(found[1]) == pytest.approx(float(shares[2]) - float(shares[1]), abs=1.0)
    other.write_text(other.read_text(encoding="utf-8").replace("thenar", "fingertip"), encoding="utf-8")
    said = cli.good("compare", two, other)
    assert ["rig", "thenar", "fingertip"] in [line.split() for line in said.stdout.splitlines()]  # each on its own
    assert "none in common" in cli("compare", two, other, "--figure", tmp_path / "a.png").stderr


def test_a_trace_and_a_log_are_compared_at_the_times_of_the_log(cli: Cli, two: Path, tmp_path: Path) -> None:
    """The log has other times, fewer columns, skin that is 0.2 K warmer, and one reading was lost."""
    trace, log = tmp_path / "trace.csv", tmp_path / "log.csv"
    cli.good("simulate", two, "--icon", "cool-step", "-o", trace)
    frame, times = pd.read_csv(trace), np.arange(0.5, 9.0, 0.25)
    display, skin = (np.interp(times, frame["time_s"], frame[column]) for column in ("display_C", "skin_C"))
    display[3] = np.nan
    logged = {"time_s": times, "note": "x", "display_C": display, "skin_C": skin + 0.2}
    pd.DataFrame(logged).to_csv(log, index=False)
    said = cli.good("compare", trace, log, "--figure", tmp_path / "a.png")
    assert said.stdout.splitlines()[:2] == ["A  trace.csv", "B  log.csv"]
    assert row(said, "skin")[-2:] == ["0.2", "K"]
    assert row(said, "display")[1:3] == ["0", "K"]
    for words in ("the 31 times of log.csv", "0.5–8 s", "trace.csv interpolated"):
        assert words in " ".join(said.stdout.split())
    assert "log.csv: ignored columns that no trace has: note" in said.stderr
    turned = cli("compare", log, trace)
    assert row(turned, "skin")[-2:] == ["−0.2", "K"]
    assert "the 31 times of log.csv" in turned.stdout


def test_a_log_with_a_clock_of_its_own_is_aligned(cli: Cli, tmp_path: Path) -> None:
    trace, log = tmp_path / "trace.csv", tmp_path / "log.csv"
    cli.good("simulate", "six-icons", "--icon", "double-dip", "--rate", "20", "-o", trace)
    frame = pd.read_csv(trace)[["time_s", "display_C"]]
    frame["time_s"] += 3600.25
    frame["display_C"] += 0.1
    frame.to_csv(log, index=False)
    assert "no two rows at a common time" in cli("compare", trace, log).stderr
    said = cli.good("compare", trace, log, "--align")
    assert "B was shifted by −3600.25 s, by the correlation of display (1)" in said.stdout
    assert row(said, "display")[1] == "0.1"
    frame.rename(columns={"display_C": "probe_a_C"}).to_csv(log, index=False)
    assert "no column in both trace.csv and log.csv to align them by" in cli("compare", trace, log, "--align").stderr


@pytest.mark.parametrize("form_name", ["setpoint-csv", "psychopy"])
def test_a_log_is_compared_with_the_predicted_display_and_not_with_set_points(
    cli: Cli, tmp_path: Path, form_name: str
) -> None:
    """Set-points are shaped for a loop, so that the display is where they are not."""
    icon, form = load_library("six-icons")["double-dip"], load_format(form_name)
    ready = prepare(icon, Rig.load("thenar"), Device.load("closed-loop-controller"), form, gate=GreenVerdict)
    for name, content in pack([ready], form).items():
        (tmp_path / name).write_bytes(content)
    drive, predicted = tmp_path / "double-dip.csv", tmp_path / "double-dip.predicted.csv"
    assert json.loads((tmp_path / "double-dip.json").read_text())["set_files"][predicted.name]
    levels = [float(line.split(",")[1]) for line in drive.read_text().splitlines()[1:]]
    displays = [float(line.split(",")[1]) for line in predicted.read_text().splitlines()[1:]]
    assert len(levels) == len(displays)
    assert max(abs(level - display) for level, display in zip(levels, displays, strict=True)) > 0.3
    log = tmp_path / "log.csv"
    log.write_bytes(predicted.read_bytes())
    done = cli.good("compare", drive, log)
    assert "holds set-points; what they are predicted to do is compared" in " ".join(done.stderr.split())
    assert "play alike: no difference in any curve" in " ".join(done.stdout.split())
    predicted.unlink()
    assert "alike" not in cli.good("compare", drive, log).stdout


def curves(name: str, time: list[float], whole: bool = False, **columns: list[float]) -> Curves:
    return Curves(name, np.array(time), {key: np.array(value) for key, value in columns.items()}, whole)


def test_differences_of_known_curves_leave_out_what_was_not_measured() -> None:
    a = curves("a", [0, 1, 2, 3], skin_C=[30.0, 30.0, 30.0, 30.0], display_C=[np.nan] * 4)
    b = curves("b", [0, 1, 2, 3], skin_C=[30.0, 33.0, 26.0, np.nan], display_C=[1.0] * 4)
    (row,) = differences(align(a, b)).to_dict("records")
    assert (row["column"], row["unit"], row["largest"], row["largest_s"], row["rows"]) == ("skin_C", "K", -4, 2, 3)
    assert row["rms"] == pytest.approx(np.sqrt(25 / 3))
    assert row["mean"] == pytest.approx(-1 / 3)
    with pytest.raises(TraceFileError, match="no column with values in both"):
        align(curves("a", [0, 1], skin_C=[np.nan] * 2), curves("b", [0, 1], skin_C=[1.0] * 2))


def test_a_held_current_is_not_interpolated_and_the_rest_is() -> None:
    trace = curves("t", [0, 1, 2], True, current_A=[1.0, 3.0, 3.0], skin_C=[30.0, 32.0, 32.0])
    log = curves("l", [0.25, 0.75, 1.0], current_A=[1.0, 1.0, 3.0], skin_C=[30.5, 31.5, 32.0])
    both = align(trace, log)
    assert list(both.time_s) == [0.25, 0.75, 1.0]
    assert differences(both)["largest"].tolist() == [0.0, 0.0]
