"""Files made to harm: endless, steering the terminal, or wrapping a number."""

import os
import sys
import time
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from tests.notebooks.readers import KINDS
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import FormatError, c_array, load_format
from thermicon.circuit.delivery.formats.form import check_name
from thermicon.circuit.delivery.samples import rate_of
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.solver.drive import DriveError, read_drive
from thermicon.icons import CueErrors, load_library, parse

Cli = Callable[..., Any]
POSIX = sys.platform != "win32"
DEVICE = """format = 1
name = "{name}"
title = "t"
driven_by = "volts"
record = [
  {{quantity = "output range", unit = "V", source = "s", low = -10, high = 10}},
  {{quantity = "resolution", unit = "bit", source = "s", value = {bits}}},
  {{quantity = "update rate", unit = "Hz", source = "s", low = {low}, high = {high}}},
  {{quantity = "buffer length", unit = "samples", source = "s", low = {least}, high = 1e12}},
]
"""


def device(path: Path, **given: object) -> Device:
    values = {"name": "d", "bits": 12, "low": 0.01, "high": 100, "least": 1, **given}
    path.write_text(DEVICE.format(**values), encoding="utf-8")
    return Device.load(path)


@pytest.mark.skipif(not POSIX, reason="devices and pipes work differently there")
@pytest.mark.parametrize("kind", ["device", "pipe"])
@pytest.mark.parametrize(
    "words",
    [
        ("check", "{}"),
        ("simulate", "six-icons", "--rig", "{}"),
        ("simulate", "--current", "{}"),
        ("export", "six-icons", "--to", "csv", "-o", "out", "--device", "{}"),
        ("convert", "{}", "-o", "out.json"),
    ],
)
def test_only_files_are_read(cli: Cli, tmp_path: Path, kind: str, words: tuple[str, ...]) -> None:
    path = Path("/dev/zero") if kind == "device" else tmp_path / "pipe"
    if kind == "pipe":
        os.mkfifo(path)
    begin = time.monotonic()
    said = cli(*(word.format(path) for word in words))
    assert said.exit_code == 1, said
    assert f"this is a {kind}, not a file" in said.stderr
    assert time.monotonic() - begin < 20


@pytest.mark.parametrize("name", ["\\u001b[2J", "a\\nb", "a\\u202eb", "a\\u2028b", "a\\u0007"])
def test_a_name_that_acts_is_refused_and_shown_harmless(tmp_path: Path, name: str) -> None:
    with pytest.raises(DeviceError, match=r"name = .*: holds the control character U\+[0-9A-F]{4}; remove it") as found:
        device(tmp_path / "d.toml", name=name)
    assert str(found.value).isprintable()
    rig = {"title": name.encode().decode("unicode_escape")}
    with pytest.raises(Exception, match=r"title = .*: holds the control character"):
        Rig.load("thenar").with_(**rig)
    with pytest.raises(CueErrors, match="the text holds the control character"):
        parse('cue 1\nicon a means "x\u202e" { hold for 1 s }')


def test_a_header_that_steers_the_terminal_is_shown_harmless(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "e.csv").write_text("x\x1b]0;own\x07,current_A\n0,1\n")
    said = cli("simulate", "--current", tmp_path / "e.csv")
    assert said.exit_code == 1
    assert "found x�]0;own�, current_A;" in said.stderr
    assert "\x1b" not in said.stderr


DRIVES = [
    ("time_s,current_A\n0,0.1\n1e-300,0.1\n", r":? row 2: time 1e-300 s comes 1e-300 s after the row before"),
    ("time_s,current_A\n0," + "0" * 200_000 + "\n", r":2: this row cannot be read \(field larger"),
    ("time_s,current_A\n0,0.1\n1,1e9\n", r"d.csv: current_A reaches 1e\+09 A, above 50 A: it looks like milliamperes"),
]


@pytest.mark.parametrize(("text", "words"), DRIVES, ids=["tiny", "long", "large"])
def test_a_drive_that_no_driver_plays(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "d.csv").write_text(text)
    with pytest.raises(DriveError, match=words):
        read_drive(tmp_path / "d.csv")


def shipped(package: str, place: str) -> str:
    return (files(package) / place).read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", KINDS)
def test_every_file_is_read_alike_whatever_ends_its_lines(tmp_path: Path, kind: str) -> None:
    held, found = KINDS[kind], []
    for end in ("\n", "\r\n", "\r"):
        (tmp_path / held.file).write_bytes(held.texts[0].replace("\n", end).encode())
        found.append(held.read(tmp_path / held.file))
    assert found[0] == found[1] == found[2]


BOUNDS = [
    ({"bits": 12.5}, "must be a whole number of bits"),
    ({"low": 5e-324}, r"low = 4\.94066e−324 Hz: must be 0\.001 to 1e\+12 Hz"),
    ({"high": 1e308}, r"high = 1e\+308 Hz: must be"),
]


@pytest.mark.parametrize(("given", "words"), BOUNDS)
def test_numbers_that_no_device_has(tmp_path: Path, given: dict[str, object], words: str) -> None:
    with pytest.raises(DeviceError, match=words):
        device(tmp_path / "d.toml", **given)


def test_a_device_that_would_fill_the_memory_is_refused(tmp_path: Path) -> None:
    fast = device(tmp_path / "d.toml", low=1e8, high=1e9)
    with pytest.raises(DeviceError, match="are 800,000,000 samples, at most 10,000,000 are computed; shorten the icon"):
        rate_of(fast, 100.0, 8.0)
    wide = device(tmp_path / "d.toml", least=1e9)
    with pytest.raises(DeviceError, match="the minimum that it plays are 999,999,999 samples"):
        deliver(load_library("six-icons")["cooling-step"], Rig.load("thenar"), wide)


def test_a_period_that_wraps_is_refused(tmp_path: Path) -> None:
    assert c_array.period_ns(1 / 4.29) == 4_290_000_000
    with pytest.raises(FormatError, match=r"at most 4\.29 s .* is one of 5\.63 s: use a device with a higher rate"):
        c_array.period_ns(1 / 5.63)
    with pytest.raises(FormatError, match=r"is one of 0\.3333 ns, which it would round"):
        c_array.period_ns(3e9)


@pytest.mark.parametrize(("name", "words"), [("con.csv", "Windows keeps the name con"), ("é" * 101, "has at most 200")])
def test_a_file_name_that_no_disk_takes(name: str, words: str) -> None:
    with pytest.raises(FormatError, match=words):
        check_name(name)


def test_commands_of_a_thermode_count_in_its_own_ticks(tmp_path: Path) -> None:
    text = shipped("thermicon.circuit", "devices/qst-tcs2.toml")
    (tmp_path / "d.toml").write_text(text.replace("value = 0.01\n", "value = 0.02\n"), encoding="utf-8")
    thermode = Device.load(tmp_path / "d.toml")
    assert thermode.most("tick") == 0.02
    played = deliver(load_library("six-icons")["cooling-step"], Rig.load("thenar"), thermode)
    with pytest.raises(FormatError, match=r"counts ticks of 10 ms .* has 20 ms"):
        load_format("tcs2-serial").write(played)


@pytest.mark.skipif(not POSIX, reason="links work differently there")
def test_an_output_whose_links_lead_in_a_circle(cli: Cli, two: Path, tmp_path: Path) -> None:
    (tmp_path / "a.csv").symlink_to(tmp_path / "b.csv")
    (tmp_path / "b.csv").symlink_to(tmp_path / "a.csv")
    said = cli("simulate", two, "--icon", "cool-step", "-o", tmp_path / "a.csv")
    assert said.exit_code == 1
    assert "circle" in said.stderr or "symbolic links" in said.stderr
