"""Thermode and PsychoPy files, read back by parsers written from public sources."""

import ast
import csv
import io
import json
import re
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from tests.circuit.delivery.one_drive import icon_of, prepare
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.ways import deliver
from thermicon.icons import load_library

RIG = Rig.load("thenar")
THERMODE = Device.load("qst-tcs2")


def written(way: str, rate: float) -> list[tuple[float, float]]:
    icon = icon_of(f"{way} by 6 °C at {rate} °C/s; hold for 2 s; return at {rate} °C/s", baseline=30)
    return read_profile(load_format("tcs2-serial").write(deliver(icon, RIG, THERMODE)).decode("ascii"))[1]


def read_profile(text: str) -> tuple[float, list[tuple[float, float]]]:
    """Baseline in °C and the (duration s, level °C) of a `Uw` command, by the list of commands in pytcsii's header."""
    commands = text.split("\n")
    assert commands.pop() == ""
    neutral, most, profile, enabled, start = commands
    assert re.fullmatch(r"N\d{3} Om\d{3}", f"{neutral} {most}")
    assert (enabled, start) == ("Ue11111", "L")
    head = re.match(r"Uw11111(\d{3})", profile)
    body = profile[len(head[0]) :]
    assert len(body) == 6 * int(head[1])
    pairs = [(int(body[k : k + 3]) / 100, int(body[k + 3 : k + 6]) / 10) for k in range(0, len(body), 6)]
    assert all(0.01 <= duration <= 9.99 for duration, _ in pairs)
    assert int(most[2:]) / 10 >= max(level for _, level in pairs)
    return int(neutral[1:]) / 10, pairs


class TestSerial:
    """Commands of the serial line."""

    @pytest.mark.parametrize("name", ["cooling-step", "cold-to-warm", "double-dip"])
    def test_a_profile_read_back_is_the_icon(self, name: str) -> None:
        icon = load_library("six-icons")[name]
        found = deliver(icon, RIG, THERMODE)
        baseline, pairs = read_profile(load_format("tcs2-serial").write(found).decode("ascii"))
        times = np.cumsum([0.0, *(duration for duration, _ in pairs)])
        levels = [baseline, *(level for _, level in pairs)]
        corners = icon.corners()
        grid = np.linspace(0, corners.duration_s, 200)
        cue = np.interp(grid, corners.time_s, corners.value)
        assert np.abs(np.interp(grid, times, levels) - cue).max() <= 0.05 + 1e-9
        assert times[-1] == pytest.approx(corners.duration_s, abs=0.005)

    def test_cooling_is_timed_as_warming_is_and_a_quarter_of_a_degree_a_second_is_no_fifth(self) -> None:
        assert [duration for way in ("cool", "warm") for duration, _ in written(way, 3.0)] == [2.0] * 6
        assert sum(duration for duration, _ in written("warm", 0.25)[:3]) == pytest.approx(6 / 0.25)


class TestPsychopy:
    """Conditions, drives and player."""

    def test_a_minute_of_rows_at_16_khz_is_written_and_at_17_khz_is_not(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("thermicon.circuit.delivery.formats.psychopy.write_rows", lambda _, rows: bytes(len(rows)))
        found = deliver(load_library("six-icons")["cooling-step"], RIG, Device.load("dac-16"))

        def written_at(hertz: int) -> bytes:
            played = replace(found.played, codes=np.zeros(60 * hertz, np.int64))
            return load_format("psychopy").write(replace(found, rate_Hz=hertz, played=played))

        assert len(written_at(16_000)) == 960_000
        with pytest.raises(FormatError, match=r"at most 1,000,000; there are 1,020,000 at 17000 Hz: use a device"):
            written_at(17_000)

    @staticmethod
    @cache
    def packed(device: str) -> dict[str, bytes]:
        form = load_format("psychopy")
        icons = [load_library("six-icons")[name] for name in ("warming-step", "double-dip")]
        return pack([prepare(icon, sure_rig(), Device.load(device), form) for icon in icons], form)

    @pytest.mark.parametrize(
        ("device", "suffix", "lead"), [("ni-analogue-output", ".csv", 0.01), ("qst-tcs2", ".tcs2.txt", 0.0)]
    )
    def test_conditions_are_what_psychopy_reads(self, device: str, suffix: str, lead: float) -> None:
        files = self.packed(device)
        table = pd.read_csv(io.BytesIO(files["conditions.csv"]))
        assert all(name.isidentifier() for name in table.columns)
        assert table["icon"].tolist() == ["warming-step", "double-dip"]
        assert set(files) == {*table["drive_file"], *table["sidecar_file"], "conditions.csv", "play_icons.py"}
        assert table["drive_file"].tolist() == [f"warming-step{suffix}", f"double-dip{suffix}"]
        assert table["ramp_start_s"].tolist() == [lead, lead]
        assert table["target_reached_s"].tolist() == pytest.approx([1 + lead, 1 + lead])
        assert table["return_start_s"].tolist() == pytest.approx([6 + lead, 2 + lead])

    @pytest.mark.parametrize("device", ["ni-analogue-output", "qst-tcs2"])
    def test_every_event_of_the_sidecar_has_a_column(self, device: str) -> None:
        files = self.packed(device)
        rows = list(csv.DictReader(io.StringIO(files["conditions.csv"].decode())))
        events = ["ramp_start", "target_reached", "return_start", "baseline_reached"]
        timed = ["duration_s", *(f"{event}_s" for event in events), *(f"{event}_2_s" for event in events)]
        about = ["safety", "recovery_s", "shortest_pause_s"]
        assert list(rows[0]) == ["icon", "drive_file", "sidecar_file", *timed, *about]
        warming, dips = rows
        assert {warming[column] for column in timed if "_2_" in column} == {""}
        for row in rows:
            happened = json.loads(files[row["sidecar_file"]])["events"]
            told = sorted(float(row[column]) for column in timed if row[column])
            assert told == pytest.approx(sorted(event["time_s"] for event in happened))
        _, second = (event["time_s"] for event in happened if event["name"] == "ramp start")
        assert float(dips["ramp_start_2_s"]) == pytest.approx(second)
        assert second > float(dips["ramp_start_s"]) + 1

    def test_players_need_nothing_to_be_imported(self) -> None:
        for device in ("ni-analogue-output", "qst-tcs2", "closed-loop-controller"):
            tree = ast.parse(self.packed(device)["play_icons.py"], feature_version=(3, 8))  # of PsychoPy
            imported = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
            names = {getattr(node, "module", None) or name.name for node in imported for name in node.names}
            assert {name.partition(".")[0] for name in names} <= sys.stdlib_module_names
