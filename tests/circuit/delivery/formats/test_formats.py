"""Files of samples through independent readers."""

import csv
import io
import shutil
import subprocess
import wave
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.circuit.delivery.one_drive import changed, icon_of
from thermicon.circuit import Device, Rig, read_drive, simulate_current
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.formats.c_array import identifier
from thermicon.circuit.delivery.samples import Samples
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.solver.drive import DriveError
from thermicon.icons import load_library

RIG = Rig.load("thenar")
ICON = load_library("six-icons")["cooling-step"]


def played(format_name: str, device: str | None = None) -> tuple[DeliveredDrive, Samples]:
    found = deliver(ICON, RIG, Device.load(device or load_format(format_name).device))
    return found, found.played


@pytest.mark.parametrize(
    ("name", "device"), [("tcs2-serial", "dac-16"), ("csv", "qst-tcs2"), ("wav", "pwm-h-bridge-10")]
)
def test_a_format_for_another_kind_of_device_is_refused(name: str, device: str) -> None:
    form, other = load_format(name), Device.load(device)
    with pytest.raises(
        FormatError, match=rf"{name} is for devices driven by .*; {device} is driven by {other.driven_by}"
    ):
        form.check(other)


class TestCsv:
    """The table, by pandas and by the replay of `simulate --current --hold`."""

    def test_pandas_reads_the_samples(self) -> None:
        found, samples = played("csv")
        table = pd.read_csv(io.BytesIO(load_format("csv").write(found)))
        assert list(table.columns) == [column.name for column in load_format("csv").columns(found)]
        assert np.array_equal(table["time_s"], samples.time_s)
        assert np.array_equal(table["code"], samples.codes)
        assert np.array_equal(table["command_V"], samples.command)
        assert table["event"].dropna().to_dict() == {
            0: "rest", 1: "ramp start", 201: "target reached", 601: "return start", 801: "baseline reached; end",
        }  # fmt: skip

    @pytest.mark.parametrize(
        ("device", "update"), [("dac-12", 30), ("dac-16", 100), ("ni-analogue-output", 30), ("dc-coupled-audio", 100)]
    )
    def test_a_replay_is_the_realised_trace(self, device: str, update: int, tmp_path: Path) -> None:
        rig = RIG.with_(**{"driver.update_Hz": update})
        found = deliver(ICON, rig, Device.load(device))
        path = tmp_path / "drive.csv"
        path.write_bytes(load_format("csv").write(found))
        again = simulate_current(read_drive(path, hold=True), rig)
        assert np.abs(again.time_s - found.trace.time_s).max() < 1e-12
        for column in ("current_A", "hot_plate_C", "display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
            assert np.abs(getattr(again, column) - getattr(found.trace, column)).max() < 1e-9, column

    def test_a_bridge_has_duties_and_no_current_to_replay(self, tmp_path: Path) -> None:
        found, samples = played("csv", "pwm-h-bridge-10")
        rows = list(csv.DictReader(io.StringIO(load_format("csv").write(found).decode())))
        assert [float(row["duty"]) for row in rows] == samples.command.tolist()
        assert "current_A" not in rows[0]
        path = tmp_path / "bridge.csv"
        path.write_bytes(load_format("csv").write(found))
        with pytest.raises(DriveError, match=r"bridge\.csv:1: these are duties of a bridge, .* in the sidecar beside"):
            read_drive(path, hold=True)


def test_nptdms_reads_the_waveform() -> None:
    nptdms = pytest.importorskip("nptdms")
    found, samples = played("tdms")
    file = nptdms.TdmsFile.read(io.BytesIO(load_format("tdms").write(found)))
    channel = file["thermicon"]["command_V"]
    assert np.array_equal(channel[:], samples.command)
    assert np.array_equal(file["thermicon"]["code"][:], samples.codes)
    assert channel.properties["unit_string"] == "V"
    assert channel.time_track() == pytest.approx(samples.time_s)
    assert file.properties["name"] == "cooling-step"


def test_without_nptdms_the_cure_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "nptdms", None)
    with pytest.raises(FormatError, match=r"npTDMS, which is not installed: .*pip install .*npTDMS"):
        load_format("tdms").check(played("tdms")[0].device)


@pytest.mark.parametrize(
    ("name", "device", "scale", "words"),
    [
        ("wav", {"dc_coupled": False}, {}, r"wav: dc-coupled-audio is not said to be DC-coupled .* every held level"),
        ("psychopy", {"dc_coupled": True}, {}, r"nor a study plays on a sound interface such as ni-.* use .*qst-tcs2"),
        ("wav", {"levels": "waveform"}, {}, "wav has no levels of its own; dc-coupled-audio sets its levels by the"),
        ("c-array", {}, {"lowest": -32769}, r"c-array holds int16_t; dac-12 has codes of -32769 … 2047"),
        ("c-array", {}, {"lowest": 0, "highest": 65535}, r"c-array holds int16_t; dac-12 has codes of 0 … 65535"),
        ("tdms", {}, {"highest": 2**31}, r"tdms: codes are written in 32 bits, up to 2,147,483,647; ni-analogue-out"),
    ],
)
def test_what_a_format_cannot_hold_is_refused(
    name: str, device: dict[str, object], scale: dict[str, int], words: str
) -> None:
    found, samples = played(name)
    wide = replace(samples, scale=replace(samples.scale, **scale))  # type: ignore[arg-type]
    with pytest.raises(FormatError, match=words):
        other = replace(found.device, **device)  # type: ignore[arg-type]
        load_format(name).check(other)
        load_format(name).write(replace(found, device=other, played=wide))


class TestWav:
    """Sound files."""

    @pytest.mark.parametrize(
        ("rate", "update", "frame_rate", "each"),
        [
            ((100, 100), 100, 48000, 480), ((1, 10000), 100, 8000, 80), ((1, 500), 62.5, 48000, 768),
            ((1, 500), 315, 44100, 140), ((1, 500), 33.0, 176400, 0),
        ],
    )  # fmt: skip
    def test_slow_updates_are_held_over_frames_that_sound_interfaces_play(
        self, rate: tuple[float, float], update: float, frame_rate: int, each: int
    ) -> None:
        sound = Device.load("dc-coupled-audio")
        (quantity,) = (record.quantity for record in sound.records if record.unit == "Hz")
        slow = changed(sound, quantity, "Hz", low=rate[0], high=rate[1])
        found = deliver(ICON, RIG.with_(**{"driver.update_Hz": update}), slow)
        if not each:
            words = r"no rate that sound interfaces play \(8,000 to 192,000 frames a second"
            with pytest.raises(FormatError, match=words):
                load_format("wav").write(found)
            return
        form = load_format("wav")
        with wave.open(io.BytesIO(form.write(found))) as sound:
            assert sound.getframerate() == frame_rate
            pcm = np.frombuffer(sound.readframes(sound.getnframes()), dtype="<i2").reshape(-1, each)
            assert sound.getnframes() / frame_rate == pytest.approx(len(found.played.codes) / found.played.rate_Hz)
        assert (pcm == pcm[:, :1]).all(), "held, not resampled"
        assert pcm[:, 0] / 32768 * 10.0 == pytest.approx(found.played.command, abs=1e-12)
        assert form.facts(found) == {"frames_per_second": frame_rate, "frames_per_update": each}


class TestCArray:
    """Header files."""

    @pytest.mark.parametrize("device", ["dac-12", "pwm-h-bridge-10"])
    def test_a_compiler_reads_the_codes(self, device: str, tool: Callable[[str], str], tmp_path: Path) -> None:
        found, samples = played("c-array", device)
        form = load_format("c-array")
        (tmp_path / form.file_name(found)).write_bytes(form.write(found))
        shutil.copy(Path(__file__).with_name("codes_main.c"), tmp_path / "main.c")
        command = [tool("gcc"), "-std=c99", "-Wall", "-Werror", "-o", "play", "main.c"]
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
        said = subprocess.run([tmp_path / "play"], capture_output=True, text=True, check=True).stdout.split()
        assert int(said[0]) == round(1e9 / samples.rate_Hz)
        assert [int(word) for word in said[1:]] == samples.codes.tolist()

    def test_names_are_those_of_c(self) -> None:
        assert identifier("ramp_amount=-6_rate=0.25") == "ramp_amount__6_rate_0_25"
        assert identifier("été") == "icon__t_"


def test_an_icon_in_amperes_has_levels_in_amperes() -> None:
    found = deliver(icon_of("to 0.6 A at 1 A/s; return at 1 A/s", "current"), RIG, Device.load("dac-16"))
    events = pd.read_csv(io.BytesIO(load_format("csv").write(found)))["event"].dropna()
    assert ", ".join(events) == "rest, ramp start, target reached; return start, baseline reached; end"
