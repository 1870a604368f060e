"""A measured log in the design view, without a browser: how it lies over the curves, and what is said of bad ones."""

from __future__ import annotations

import re
from datetime import UTC, datetime
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from tests.builders import missing
from tests.notebooks.workbench.openbench import SAID, said
from thermicon.circuit import Rig, simulate
from thermicon.circuit.fitting.log import LogError
from thermicon.icons import parse
from thermicon.notebooks import Workbench
from thermicon.notebooks.files.outputs import PAGE_FOLDER
from thermicon.notebooks.timeline.measured import read_measured, read_uploaded
from thermicon.notebooks.workbench.document_bar import DocumentBar
from thermicon.notebooks.workbench.panels import LogPanel

TEXT = "cue 1\nicon dip { cool by 4 K at 2 K/s; hold for 2 s; return at 2 K/s }\nicon none { hold for 9 s }\n"
LATE_S, HIGHER_K = 1.5, 0.2


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """What a display 0.2 K too warm would have logged, on a clock that runs 1.5 s behind."""
    monkeypatch.chdir(tmp_path)
    trace = simulate(parse(TEXT)["dip"], Rig.load("thenar"), tail_s=5.0, rate_Hz=20.0)
    rows = np.column_stack([trace.time_s - LATE_S, trace.display_C + HIGHER_K, trace.skin_C])
    path = tmp_path / "rig.csv"
    np.savetxt(path, rows, fmt="%.4f", delimiter=",", header="time_s,display_C,skin_C", comments="")
    return path


def opened() -> tuple[Workbench, DocumentBar, LogPanel]:
    bench = Workbench(TEXT)
    assert bench.page is not None
    assert bench.bar is not None
    bench.bar.buttons["Log"].click()
    return bench, bench.bar, bench.bar.log


def load(panel: LogPanel, path: object) -> None:
    panel.path.value = str(path)
    panel.load.click()


def test_a_log_is_aligned_and_drawn_over_display_and_skin_with_its_misses(log: Path) -> None:
    bench, bar, panel = opened()
    load(panel, log)
    assert said(bar) == ""
    frame = bench._design.frame()
    words = frame.meta["measured"]
    assert re.search(r"display rms 0\.2 K, largest \+0\.\d\d K at [\d.]+ s; skin rms 0(\.0\d)? K", words), words
    assert "shifted by 1.5 s (by correlation)" in words
    series = {one["key"]: one for one in frame.meta["panels"][0]["series"]}
    drawn, simulated = (frame.buffers[series[key]["buffer"]] for key in ("measured display_C", "display"))
    there = np.isfinite(drawn)
    assert there.sum() > 1000
    assert not there[-1]
    assert drawn[there] == pytest.approx(simulated[there] + HIGHER_K, abs=0.1)
    assert panel.shift.value == pytest.approx(LATE_S, abs=0.02)


def test_a_shift_by_hand_stays_through_an_edit_until_it_is_aligned_again(log: Path) -> None:
    bench, _, panel = opened()
    load(panel, log)
    panel.shift.value = 0.5
    bench.text = TEXT.replace("4 K", "3 K")
    assert "shifted by 0.5 s (set by hand)" in bench._design.frame().meta["measured"]
    bench.text = TEXT
    panel.align.click()
    assert panel.shift.value == pytest.approx(LATE_S, abs=0.1)
    panel.remove.click()
    assert "measured" not in bench._design.frame().meta
    assert panel.align.disabled


def test_an_upload_is_read_by_the_same_reader_and_another_icon_keeps_the_log(log: Path) -> None:
    bench, _, panel = opened()
    data = log.read_bytes()
    file = {"name": "rig.csv", "type": "text/csv", "size": len(data), "last_modified": datetime.now(tz=UTC)}
    panel.upload.value = ({**file, "content": memoryview(data)},)
    assert panel.upload.value == ()
    assert bench._design.measured is not None
    bench._design.receive({"type": "icon", "name": "none"})
    assert "display rms" in bench._design.frame().meta["measured"]
    bench._design.receive({"type": "text", "text": TEXT.replace("4 K", "4")})
    assert bench._design.scene.stale
    assert "display rms" in bench._design.frame().meta["measured"]


@pytest.mark.parametrize(("short", "words"), SAID["logs"].items())
def test_a_bad_log_says_where_what_and_the_cure_and_changes_nothing(log: Path, short: str, words: str) -> None:
    bench, bar, panel = opened()
    text = re.sub(r"{(.*)}", lambda found: "".join(f"{k},{found[1]}\n" for k in range(30)), short)
    bad = log.with_name("bad") / "rig.csv"
    bad.parent.mkdir()
    bad.write_text(text, encoding="utf-8")
    load(panel, "bad/rig.csv")
    assert missing(words, unescape(said(bar))) == []
    assert bench._design.measured is None
    assert bench.text == TEXT
    with pytest.raises(LogError) as raised:
        read_uploaded({"rig.csv": text.encode()})
    assert missing(words, str(raised.value)) == []
    assert "/tmp" not in str(raised.value)


def test_what_is_no_single_log_or_outside_the_page_is_refused(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, bar, panel = opened()
    with pytest.raises(LogError, match=r"one log at a time; got a\.csv, b\.csv"):
        read_uploaded({"a.csv": b"", "b.csv": b""})
    panel.load.click()
    assert said(bar) == "give the path of a log, or upload one"
    monkeypatch.setenv(PAGE_FOLDER, str(log.parent / "page"))
    (log.parent / "page").mkdir()
    load(panel, log)
    assert "outside the folder of this page" in said(bar)


def test_a_workbench_is_made_with_a_log(log: Path) -> None:
    bench = Workbench(TEXT, measured=log)
    assert bench._design.measured is not None
    assert bench._design.measured.shift_s == pytest.approx(LATE_S, abs=0.02)
    with pytest.raises(LogError, match=r"missing\.csv"):
        Workbench(TEXT, measured="missing.csv")
    long = log.with_name("long.csv")
    long.write_text("time_s,display_C\n" + "".join(f"{k / 100:.2f},32\n" for k in range(40_001)), encoding="utf-8")
    assert read_measured(long).notes[-1] == "long.csv: one row in 3 of 40,001 is shown"
