"""Logs from CSV and from TDMS."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nptdms import ChannelObject, RootObject, TdmsFile, TdmsWriter

from thermicon.circuit.fitting.keys import FitError
from thermicon.circuit.fitting.log import Log, LogError, read_log

ROWS = [(k / 10, 0.1, 32.0 + k / 100) for k in range(40)]
HEAD = ("time_s", "current_A", "display_C")


def text_of(mark: str = ",", head: tuple[str, ...] = HEAD, comma: bool = False) -> str:
    lines = [mark.join(head), *(mark.join(f"{value:g}" for value in row) for row in ROWS)]
    text = "\n".join(lines) + "\n"
    return text.replace(".", ",") if comma else text


@pytest.fixture
def saved(tmp_path: Path) -> Callable[[str | bytes, str], Path]:
    def save(content: str | bytes, name: str = "rig.csv") -> Path:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return save


@pytest.mark.parametrize(
    "text",
    [
        text_of(), text_of(";", comma=True), text_of("\t"), "\ufeff" + text_of(), text_of().replace("\n", "\r\n"),
        "# logged on Monday\nsep=,\n" + text_of(), text_of() + "\n\n",
    ],
)  # fmt: skip
def test_a_table_is_read_whatever_separates_its_cells(text: str, saved: Callable[..., Path]) -> None:
    log = read_log(saved(text))
    assert (len(log.time_s), log.time_s[-1], log.column("display_C")[3]) == (40, 3.9, 32.03)
    assert len(log.sha256) == 64


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty; a log was expected"),
        ("# nothing\n# but this\n", "no line names the columns; the first line is such as: time_s,current_A"),
        ("time_s,current_A\n", "0 rows; a fit needs at least 20"),
        ("time_s\0", "this is a binary file, not a log .*; save it as UTF-8 text"),
        ("0,0.1,32\n1,0.1,32\n", "1: this line holds numbers, not the names of columns; put time_s,current_A"),
        (text_of(head=("time_s", "current_A", "current_A")), "the column current_A appears twice; rename or remove"),
        (text_of(head=("time_ms", "current_A", "display_C")), "missing: time_s .*time_ms should be time_s: divide"),
        (text_of(head=("time_s", "amps", "volts")), "missing: one of current_A, command_V.*found time_s, amps, volts"),
        (text_of(head=("time_s", "curent_A", "display_K")), "display_K should be display_C: subtract 273.15; curent_A: "
         "did you mean current_A"),
        (text_of().replace("32.05", "warm"), ":7: display_C is 'warm', not a finite number; leave the cell empty"),
        (text_of().replace("32.05", "32,05"), ":7: 4 cells, where the first line names 3; write decimal points"),
        (text_of().replace("\n0.5,", "\n0.2,"), ":7: time_s 0.2 s does not come after 0.4 s"),
    ],
)  # fmt: skip
def test_a_table_that_is_no_log_is_refused_with_its_line(text: str, message: str, saved: Callable[..., Path]) -> None:
    with pytest.raises(LogError, match=f"rig.csv.*{message}"):
        read_log(saved(text))


def test_gaps_are_empty_cells_or_nan_or_missing_cells(saved: Callable[..., Path]) -> None:
    text = text_of().replace(",32.05", ",").replace("32.06", "NaN").replace(",32.07", "")
    assert np.isnan(read_log(saved(text)).column("display_C")).sum() == 3


def test_a_file_that_is_too_large_is_refused(saved: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thermicon.circuit.fitting.log.MOST_MB", 1e-4)
    with pytest.raises(LogError, match=r"0 MB is too large for a log; the limit is 0.0001 MB"):
        read_log(saved(text_of()))
    with pytest.raises(LogError, match=r"nothing.csv: no such log"):
        read_log("nothing.csv")


def tdms(**channels: Any) -> bytes:
    file = io.BytesIO()
    clock = {"wf_increment": 0.1, "wf_start_offset": 2.0}
    objects = [
        ChannelObject("log", name, np.asarray(values, dtype=float), {} if name == "bare" else clock)
        for name, values in channels.items()
    ]
    with TdmsWriter(file) as writer:
        writer.write_segment([RootObject(), *objects])
    return file.getvalue()


def test_a_reader_that_fails_without_a_word_is_named(
    saved: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_: io.BytesIO) -> TdmsFile:
        raise IndexError

    monkeypatch.setattr(TdmsFile, "read", fails)
    with pytest.raises(FitError, match=r"rig\.tdms: cannot be read as TDMS \(IndexError\)"):
        read_log(saved(tdms(current_A=np.zeros(40)), "rig.tdms"))


def test_waveforms_of_tdms_share_a_clock(saved: Callable[..., Path]) -> None:
    current, display = np.full(40, 0.1), np.linspace(30, 32, 40)
    log = read_log(saved(tdms(current_A=current, display_C=display), "rig.tdms"))
    assert (round(float(log.time_s[0]), 9), round(float(log.time_s[-1]), 9)) == (2.0, 5.9)
    for content, message in (
        (
            tdms(current_A=current, display_C=display[:30]),
            r"different clocks \(current_A 40 samples, display_C 30 samples\)",
        ),
        (tdms(bare=current), "channel bare has neither wf_increment nor a channel time_s beside it"),
        (b"TDSm and then nothing that TDMS would have", "cannot be read as TDMS"),
        (tdms(pressure=current), "no column of a log"),
    ):
        with pytest.raises(FitError, match=f"rig.tdms: .*{message}"):
            read_log(saved(content, "rig.tdms"))


def test_a_written_log_is_read_back(log: Log, tmp_path: Path) -> None:
    from thermicon.circuit.fitting.laboratory import write_log

    write_log(log, tmp_path / "a.csv")
    assert np.allclose(read_log(tmp_path / "a.csv").column("display_C"), log.column("display_C"), atol=1e-6)
