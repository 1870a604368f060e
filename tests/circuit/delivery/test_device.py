"""Devices and the errors of their files."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.builders import messages
from thermicon.circuit import Device
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.delivery.devicefile import DeviceError

TOLD = messages(__file__)
GOOD: str = TOLD["device"]


@pytest.mark.parametrize("name", device_names())
def test_every_number_of_a_shipped_device_has_a_source_and_none_was_played(name: str) -> None:
    device = Device.load(name)
    assert device.records and all(record.source and record.confidence for record in device.records)
    assert (device.name, device.played) == (name, False)
    assert device.note
    # a claim needs a source: a record of the profile says so in words
    coupled = any("DC-coupled" in record.conditions for record in device.records) and "DC-coupled" in device.title
    assert device.dc_coupled == coupled == (name == "dc-coupled-audio")


@pytest.mark.parametrize(
    ("name", "milliamperes"),
    [("dac-12", 0.732422), ("dac-14", 0.183105), ("dac-16", 0.0457764), ("pwm-h-bridge-10", 1.46484)],
)
def test_steps_are_as_large_as_arithmetic_says(name: str, milliamperes: float) -> None:
    device = Device.load(name)
    per_unit = 0.15 if device.driven_by == "volts" else 1.5
    assert device.scale(1.0).step * per_unit * 1e3 == pytest.approx(milliamperes, rel=1e-3)


def test_levels_follow_the_waveform_where_the_instrument_sets_them() -> None:
    fixed = Device.load("dac-16")
    even = replace(fixed, codes="symmetric", levels="waveform")
    from_zero = replace(fixed, codes="from zero", levels="waveform").scale(7.1234)
    scale = even.scale(7.1234)
    assert (scale.lowest, scale.highest, from_zero.lowest, from_zero.highest) == (-32767, 32767, 0, 65535)
    assert scale.step * 32767 == pytest.approx(7.124)
    assert (from_zero.offset, from_zero.offset + 65535 * from_zero.step) == pytest.approx((-7.124, 7.124))
    assert even.scale(70.0).step * 32767 == pytest.approx(10.0)


def loaded(folder: Path, text: str) -> Device:
    path = folder / "mine.toml"
    path.write_text(text, "utf-8")
    return Device.load(path)


def test_a_device_of_ones_own(tmp_path: Path) -> None:
    device = loaded(tmp_path, GOOD)
    assert repr(device) == "Device('mine', amperes, never played)"
    assert device.interval("update rate") == (0.0, 500.0)
    assert device.record("slew rate") is None
    assert device.most("slew rate") == float("inf")


@pytest.mark.parametrize(("change", "words"), TOLD["faults"].items())
def test_a_wrong_device_file_says_what_and_where(tmp_path: Path, change: str, words: str) -> None:
    old, new = change.split(" -> ")
    assert old in GOOD
    with pytest.raises(DeviceError, match=words):
        loaded(tmp_path, GOOD.replace(old, new))


SLEW = '\n[[record]]\nquantity = "slew rate"\nunit = "{}"\nvalue = 5\nsource = "manual"\n'


@pytest.mark.parametrize(("case", "words"), TOLD["units"].items())
def test_units_are_those_of_what_drives_it(tmp_path: Path, case: str, words: str) -> None:
    driven_by, unit, slew = case.split()
    text = GOOD.replace("update rate", "carrier frequency") if driven_by == "duty" else GOOD
    text = text.replace('"amperes"', f'"{driven_by}"').replace('unit = "A"', f'unit = "{unit}"')
    with pytest.raises(DeviceError, match=words):
        loaded(tmp_path, text + SLEW.format(slew))


def test_a_folder_does_not_hide_a_shipped_device(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dac-16").mkdir()
    assert Device.load("dac-16").name == "dac-16"
