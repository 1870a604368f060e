"""The exported player of several elements on simulated plates, each checked against the trace of its own rig."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
import sys
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.daq import Daq, DaqError, Task
from tests.circuit.delivery.formats.world import exported
from tests.circuit.delivery.independent import Circuit
from tests.circuit.delivery.one_drive import icon_of
from tests.circuit.delivery.replay import Held, Player
from tests.circuit.live.thermostat import Thermostat
from tests.circuit.play.bench import Clock
from tests.circuit.serial_line import Serial
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Export, Layout, Rig
from thermicon.circuit.delivery.export import ExportChannel
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.formats.form import Played
from thermicon.circuit.delivery.formats.psychopy import elements_player
from thermicon.circuit.delivery.prepare import prepare_set
from thermicon.circuit.delivery.ways import worst_cases
from thermicon.circuit.live.ready import with_sensors
from thermicon.circuit.play.tcs2 import course_of

Channels = dict[str, ExportChannel]


def track(place: int, baseline_C: float) -> Any:
    """What the element at a place plays: one after the other, each as far as no other one."""
    shape = f"rest for {300 * place + 100} ms; cool by {2 + place} °C at 3 °C/s; hold for 300 ms; return at 3 °C/s"
    return icon_of(f"{shape}; rest for {1500 - 300 * place} ms", baseline=baseline_C, name="along")


@cache
def channels(layout: str, count: int, device: str) -> Channels:
    """A channel for each of the first elements of a layout."""
    elements = Layout.of(layout).elements[:count] if layout in ("ring-four", "tcs2-strips") else ()
    rigs = [each.rig for each in elements] or [
        Rig.load(layout).with_(**{"driver.transconductance_A_per_V": 0.1})
    ] * count
    names, form = [each.name for each in elements] or list("abcd"[:count]), load_format("psychopy")
    made = {}
    for place, (name, rig) in enumerate(zip(names, rigs, strict=True)):
        judge: Any = (
            worst_cases if device == "closed-loop-controller" else lambda found, _: tuple(map(GreenVerdict, found))
        )
        rig = with_sensors(rig) if judge is worst_cases else rig
        ready = prepare_set(
            [track(place, 31 if layout == "ring-four" else 32)], rig, Device.load(device), form, judge=judge
        )
        made[name] = ExportChannel(rig, Device.load(device), ready)
    return made


def joined(made: Channels) -> bytes:
    """One file of all elements: a column for each behind its name, or a profile for the zone of each."""
    files = {
        name: load_format("psychopy").write(channel.prepared[0].delivery).decode() for name, channel in made.items()
    }
    if not next(iter(files.values())).startswith("time_s"):
        commands = [file.split() for file in files.values()]
        masks = [f"{1 << 4 - place:05b}" for place in range(len(commands))]
        profiles = [own[2].replace("Uw11111", f"Uw{mask}") for own, mask in zip(commands, masks, strict=True)]
        zones = "1" * len(commands) + "0" * (5 - len(commands))
        return "\n".join([*commands[0][:2], f"S{zones}", *profiles, f"Ue{zones}", "L", ""]).encode()
    tables = {name: list(csv.DictReader(io.StringIO(file))) for name, file in files.items()}
    text, longest = io.StringIO(), max(tables.values(), key=len)
    rows = csv.writer(text, lineterminator="\n")
    columns = [column for column in ("command_V", "display_C") if column in longest[0]]
    rows.writerow(["time_s", *(f"{name}_{column}" for name in tables for column in columns)])
    for place, row in enumerate(longest):
        own = [table[min(place, len(table) - 1)] for table in tables.values()]
        rows.writerow([row["time_s"], *(each[column] for each in own for column in columns)])
    return text.getvalue().encode()


class World:
    """A computer with the player of several elements and the file of an icon."""

    def __init__(self, made: Channels, folder: Path, clock: Any) -> None:
        self.made, self.content = made, joined(made)
        self.path = folder / ("along.csv" if self.content.startswith(b"time") else "along.tcs2.txt")
        self.path.write_bytes(self.content)
        drives = {
            name: [Played(channel.prepared[0].delivery, self.path.name, "along.json", content=self.content)]
            for name, channel in made.items()
        }
        demands = {name: channel.prepared[0].verdict.demands for name, channel in made.items()}
        self.script = elements_player(drives, demands).decode()
        self.player: dict[str, Any] = {}
        exec(compile(self.script, "play_icons.py", "exec"), self.player)
        self.player["atexit"].unregister(self.player["abort"])
        self.player["time"] = clock
        self.player["POLARITY_SEEN"] = "A. Name, today"

    def trace(self, name: str) -> Any:
        return self.made[name].prepared[0].delivery.trace

    def due_C(self, name: str, times: Any) -> Any:
        trace = self.trace(name)
        return np.interp(times, trace.time_s, trace.display_C)


class Thermostats:
    """Controllers with their plates, on the independent circuit, as one clock."""

    def __init__(self, made: Channels) -> None:
        self.of = {}
        for place, (name, channel) in enumerate(made.items()):
            export = Export((channel,), load_format("setpoint-csv"))
            self.of[name] = Thermostat(export, np.random.default_rng(place), world=0)
        self.seen: dict[str, list[tuple[float, float]]] = {name: [] for name in made}
        self.sleep(0.1)  # a controller has read its sensors before anybody asks

    def monotonic(self) -> float:
        return next(iter(self.of.values())).now_s

    def sleep(self, seconds: float) -> None:
        for name, each in self.of.items():
            each.sleep(seconds)
            self.seen[name].append((each.now_s, each.display_C))

    def functions(self) -> list[dict[str, Any]]:
        verbs = ("send", "off", "read", "read_second", "test", "feed")
        return [{name: getattr(each, verb) for name, each in self.of.items()} for verb in verbs]


@pytest.mark.parametrize("count", [2, 3, 4])
def test_controllers_bring_each_plate_along_its_own_track(count: int, tmp_path: Path) -> None:
    made = channels("ring-four", count, "closed-loop-controller")
    plates = Thermostats(made)
    world = World(made, tmp_path, plates)
    world.player["play"](world.path, *plates.functions())
    began_s = world.player["_guard"].began_s
    for name in made:
        times, display_C = np.array([each for each in plates.seen[name] if each[0] >= began_s]).T
        off_K = np.abs(display_C - world.due_C(name, times - began_s))
        assert off_K.max() < 0.05
    assert world.player["apart_s"]() == 0.0


@pytest.mark.parametrize("silent_s", [0.9, 1.1])
def test_a_host_that_is_lost_leaves_every_controller_to_its_own_watchdog(silent_s: float, tmp_path: Path) -> None:
    made = channels("ring-four", 4, "closed-loop-controller")
    plates = Thermostats(made)
    world, asleep = World(made, tmp_path, plates), plates.sleep

    def sleep(seconds: float) -> None:
        is_playing = world.player["_guard"].began_s < plates.monotonic() - 1.0
        asleep(seconds + (silent_s if is_playing else 0.0))

    plates.sleep = sleep  # type: ignore[method-assign]
    world.player["time"] = plates
    with pytest.raises(RuntimeError, match=r"late by|did not switch off|switched off by itself"):
        world.player["play"](world.path, *plates.functions())
    for each in plates.of.values():
        assert not each.is_on
        assert (each.why == "the host was silent") == (silent_s > 1.0)


class Card(World):
    """The computer with an NI card."""

    def __init__(self, made: Channels, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock = Clock()
        self.daq = Daq(self.clock.monotonic)
        for module in ("nidaqmx", "nidaqmx.constants"):
            monkeypatch.setitem(sys.modules, module, self.daq)
        super().__init__(made, folder, self.clock)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_an_ni_card_plays_every_element_on_one_clock(
    count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    card = Card(channels("thenar", count, "ni-analogue-output"), tmp_path, monkeypatch)
    for _ in range(2):
        card.player["play"](str(card.path))
        card.clock.passes(60.0)
    assert card.daq.open_tasks == 0
    for place, (name, channel) in enumerate(card.made.items()):
        document = json.loads(channel.rig.document)
        plate = Player(document, np.random.default_rng(0), 0)
        plate.circuit = Circuit.of(document, plate.circuit.worlds[:1])
        ampere = 0.1 * np.array([*card.daq.holds[f"Dev1/ao{place}"], 0.0])
        held = Held.of(np.arange(len(ampere)) / card.daq.rate, ampere, ampere**2)
        rows, steps_s, _ = plate.play(held, plate.rest(held))
        times = np.append(0.0, np.cumsum(steps_s))
        is_own = times <= card.trace(name).time_s[-1]  # then an open loop rests, and is not predicted
        off_K = np.abs(rows[:, 0, 2, 0] - card.due_C(name, times))[is_own]
        assert off_K.max() < 1e-3


def test_an_ni_card_that_is_stopped_is_off_on_every_channel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    card = Card(channels("thenar", 4, "ni-analogue-output"), tmp_path, monkeypatch)
    card.clock.at(132.0, card.player["abort"])
    write = Task.write

    def broken(task: Task, volts: Any, auto_start: bool = False) -> int:
        if task._channels == ["Dev1/ao1"]:
            raise DaqError(-200088, "lost")
        return write(task, volts, auto_start)

    monkeypatch.setattr(Task, "write", broken)
    with pytest.raises(RuntimeError, match=r"(?s)abort\(\) was called; b did not switch off \(lost.*cut the power"):
        card.player["play"](str(card.path))
    assert card.daq.stopped == 1
    assert card.daq.open_tasks == 0
    assert [card.daq.holds[f"Dev1/ao{place}"] == 0.0 for place in range(4)] == [True, False, True, True]


class Strips(World):
    """The computer with a TCS II at a port."""

    def __init__(self, count: int, folder: Path, change: Callable[[bytes], bytes] = bytes) -> None:
        self.clock = Clock()
        self.port = Serial(self.clock.passes)
        super().__init__(channels("tcs2-strips", count, "qst-tcs2"), folder, self.clock)
        self.path.write_bytes(change(self.content))
        self.player["DRIVES"][self.path.name] = hashlib.sha256(self.path.read_bytes()).hexdigest()

    def play(self, **sensors: Any) -> None:
        self.player["prepare"](self.port, str(self.path))
        self.player["play"](self.port, **sensors)

    def profile(self, zone: int) -> Any:
        """Times in s and °C of what a zone plays."""
        return np.array(course_of(["N320", self.port.device.started[zone].decode(), "L"])).T

    def sensors(self, order: Sequence[int]) -> dict[str, Callable[[], float]]:
        """The sensor of each element, on the zones of this order."""

        def read(zone: int) -> float:
            noise_K = 1e-3 * float(np.sin(1e3 * self.clock.true_s))
            since_s = self.clock.true_s - self.player["_guard"].began_s
            return noise_K + (float(np.interp(since_s, *self.profile(zone))) if self.port.device.is_playing else 32.0)

        return {name: lambda zone=zone: read(zone) for name, zone in zip(self.made, order, strict=True)}


@pytest.mark.parametrize("count", [1, 3, 5])
def test_zones_of_one_thermode_play_their_own_tracks(count: int, tmp_path: Path) -> None:
    strips = Strips(count, tmp_path)
    strips.play(measured_C=strips.sensors(range(count)))
    assert not strips.port.device.garbled
    assert len(strips.port.device.started) == count
    for zone, name in enumerate(strips.made):
        trace = strips.trace(name)
        display_C = [32.0]  # follows its profile as a first-order lag
        for level_C in np.interp(np.arange(0.0, trace.time_s[-1], 0.001), *strips.profile(zone)):
            display_C.append(display_C[-1] + (level_C - display_C[-1]) * -np.expm1(-0.001 / 0.21))
        off_K = np.abs(np.interp(trace.time_s, 0.001 * np.arange(len(display_C)), display_C) - trace.display_C)
        assert off_K.max() < 0.03


def test_exchanged_or_missing_zones_do_not_play(tmp_path: Path) -> None:
    strips = Strips(5, tmp_path)
    with pytest.raises(RuntimeError, match=r"s[1-5]: the display is at .* from its prediction"):
        strips.play(measured_C=strips.sensors([4, 1, 2, 3, 0]))
    assert strips.port.commands[-1] == b"A"
    for old, new in (
        (b"Ue11111", b"Ue11101"),
        (b"Uw00010", b"Uw00011"),
        (b"S11111", b"S11101"),
        (b"Uw00010", b"Uw00000"),
    ):
        strips = Strips(5, tmp_path, lambda content, old=old, new=new: content.replace(old, new))
        with pytest.raises(ValueError, match=r"Ue and S must enable these|for zones of its own"):
            strips.play()
        assert not strips.port.commands
    with pytest.raises(ValueError, match="profiles are for the zones 11100"):
        Strips(3, tmp_path, lambda content: content.replace(b"S11100\n", b"")).play()


def test_a_player_of_one_element_has_nothing_of_several(tmp_path: Path) -> None:
    for device in ("ni-analogue-output", "qst-tcs2", "closed-loop-controller"):
        files, _, _ = exported(device)
        assert not re.search("[Ee]lement|ELEMENTS|[Zz]one_courses", files["play_icons.py"].decode())
    made = channels("tcs2-strips", 5, "qst-tcs2")
    assert "class Guard" in World(made, tmp_path, Clock()).script
