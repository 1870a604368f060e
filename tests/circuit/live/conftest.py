"""Exports that are ready to be played, judged once."""

import os
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest

from thermicon.base.files.records import Record
from thermicon.circuit import Device, Export, Rig
from thermicon.circuit.live.ready import CONTROLLER, judged
from thermicon.icons import load_library, parse

README = """cue 1
set alerts { site thenar; control skin; baseline 32 °C }
icon arrived { cool by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
icon turn { repeat 2 { warm by 3 °C at 2 °C/s; hold for 1 s; return over 1.5 s; rest for 1 s } }
icon low-battery { cool by 3 °C at 0.8 °C/s; return at 2 °C/s }
"""
EVIDENCE = int(os.environ.get("THERMICON_EVIDENCE", "300"))
SEED = int(os.environ.get("THERMICON_SEED", "63"))
"""Plays of each slow test, and their seed."""


@cache
def made(name: str, rate_Hz: float) -> Export:
    icons, device = tuple(parse(README) if name == "readme" else load_library(name)), Device.load(CONTROLLER)
    records = [each for each in device.records if each.quantity != "update rate"]
    rate = Record("update rate", "Hz", "test", low=rate_Hz, high=rate_Hz)
    return judged(icons, Rig.load("thenar"), replace(device, records=(*records, rate)), None)


@pytest.fixture(scope="session")
def ready() -> Callable[[str, float], Export]:
    """A set by name, with set-points at a rate in Hz."""
    return made
