"""Devices: the shipped profiles, what their numbers mean, and what the door says of a file that is wrong."""

from dataclasses import replace
from pathlib import Path

import pytest

from thermicon.circuit import Device
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.delivery.devicefile import DeviceError

GOOD = """
format = 1
name = "mine"
title = "my own source"
driven_by = "amperes"

[[record]]
quantity = "output range"
unit = "A"
low = -2.0
high = 2.0
source = "label"

[[record]]
quantity = "resolution"
unit = "bit"
value = 12
source = "data sheet"

[[record]]
quantity = "update rate"
unit = "Hz"
high = 500
source = "data sheet"
"""


@pytest.mark.parametrize("name", device_names())
def test_every_number_of_a_shipped_device_has_a_source_and_none_was_played(name: str) -> None:
    device = Device.load(name)
    assert device.name == name
    assert device.records
    assert all(record.source and record.confidence for record in device.records)
    assert not device.played
    assert device.note
    assert repr(device) == f"Device({name!r}, {device.driven_by}, never played)"


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


def test_a_device_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(GOOD)
    device = Device.load(path)
    assert repr(device) == "Device('mine', amperes, never played)"
    assert device.interval("update rate") == (0.0, 500.0)
    assert device.record("slew rate") is None
    assert device.most("slew rate") == float("inf")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("driven_by", "drivn_by"), r"mine\.toml: drivn_by: unknown key; did you mean driven_by\?"),
        (('title = "my own source"', ""), r"mine\.toml: title is missing; add it"),
        (
            ('"amperes"', '"watts"'),
            r"driven_by = 'watts': must be 'volts', 'amperes', 'duty', 'set-points' or 'temperatures'",
        ),
        (('"data sheet"', '" "'), r"record\.1 \(resolution\): the record has no source: add source"),
        (("value = 12", 'value = "12"'), r"record\.1\.value = '12': must be a number, without quotes"),
        (("value = 12", "bits = 12"), r"record\.1\.bits: unknown key; known: "),
        (("value = 12", "value = 1"), r"record\.1 \(resolution\): value = 1 bit: must be 2 to 32 bit"),
        (('unit = "Hz"', 'unit = "kHz"'), r"record\.2 \(update rate\): unit = 'kHz': must be Hz"),
        (('"update rate"', '"updat rate"'), r"record\.2 \(updat rate\): no such quantity; did you mean update rate"),
        (('"update rate"', '"slew rate"'), r"a device driven by amperes needs a record of its update rate, in Hz"),
        (('"update rate"\nunit = "Hz"', '"resolution"\nunit = "bit"'), r"record\.2 \(resolution\): appears twice"),
        (("low = -2.0", "low = 2.5"), r"^[^\n]*output range\): low = 2\.5 A is not below high = 2 A; swap them$"),
        (("low = -2.0", "low = 2"), r"low = 2 A is not below high = 2 A; leave some room between them"),
        (("low = -2.0\n", ""), r"record\.0 \(output range\): needs both low and high; low is missing, add it in A"),
        (("high = 500", "low = 9\nhigh = 5"), r"record\.2 .*: low = 9\.0 and high = 5\.0 are not in rising order"),
        (("format = 1", "format = 1\nplayed = 1"), r"played = 1: must be true or false"),
        (("format = 1", "format = 2"), r"format = 2: must be 1"),
        (("format = 1", "format = "), r"mine\.toml: not a valid TOML file"),
    ],
)
def test_a_wrong_device_file_says_what_and_where(tmp_path: Path, change: tuple[str, str], words: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(GOOD.replace(*change))
    with pytest.raises(DeviceError, match=words):
        Device.load(path)


SLEW = '\n[[record]]\nquantity = "slew rate"\nunit = "{}"\nvalue = 5\nsource = "manual"\n'


@pytest.mark.parametrize(
    ("driven_by", "unit", "slew", "words"),
    [
        ("amperes", "V", "A/s", r'\(output range\): unit = .V.: must be A .*driven_by to "volts" if V is what'),
        ("volts", "A", "V/s", r'unit = .A.: must be V .*driven_by to "amperes" or "duty" if A is what it puts out$'),
        ("volts", "mV", "V/s", r"record\.0 \(output range\): unit = 'mV': must be V; state it in V$"),
        ("volts", "V", "A/s", r'record\.3 \(slew rate\): unit = .A/s.: must be V/s .*"volts"; state it in V/s'),
        ("amperes", "A", "V/s", r"record\.3 \(slew rate\): unit = 'V/s': must be A/s for a device"),
        ("duty", "A", "A/s", r"does not apply to a device driven by duty, only to one driven by volts or amperes"),
    ],
)  # fmt: skip
def test_units_are_those_of_what_drives_it(tmp_path: Path, driven_by: str, unit: str, slew: str, words: str) -> None:
    path = tmp_path / "mine.toml"
    carrier = GOOD.replace("update rate", "carrier frequency") if driven_by == "duty" else GOOD
    path.write_text(
        carrier.replace('"amperes"', f'"{driven_by}"').replace('unit = "A"', f'unit = "{unit}"') + SLEW.format(slew)
    )
    with pytest.raises(DeviceError, match=words):
        Device.load(path)


def test_only_what_is_said_to_be_dc_coupled_is() -> None:
    """A claim needs a source: a record of the profile says so in words."""
    coupled = [device for device in map(Device.load, device_names()) if device.dc_coupled]
    assert [device.name for device in coupled] == ["dc-coupled-audio"]
    for device in coupled:
        assert any("DC-coupled" in record.conditions for record in device.records)
        assert "DC-coupled" in device.title


def test_an_unknown_device_is_named_with_the_nearest() -> None:
    with pytest.raises(DeviceError, match=r"dac-61: no such device; did you mean dac-16"):
        Device.load("dac-61")


def test_a_folder_does_not_hide_a_shipped_device(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dac-16").mkdir()
    assert Device.load("dac-16").name == "dac-16"
