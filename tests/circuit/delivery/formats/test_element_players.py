"""The exported player of several elements on simulated plates, each checked against the trace of its own rig."""

from __future__ import annotations

import ast
import csv
import hashlib
import io
import json
import re
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.daq import Daq, DaqError, Task
from tests.circuit.delivery.formats.world import exported
from tests.circuit.delivery.independent import Circuit
from tests.circuit.delivery.replay import Held, Player
from tests.circuit.live.thermostat import FAULTS, Thermostat
from tests.circuit.play.bench import Clock
from tests.circuit.serial_line import Serial
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Export, Layout, Rig, export
from thermicon.circuit.delivery.export import ExportChannel
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.formats.form import Played
from thermicon.circuit.delivery.formats.psychopy import elements_player
from thermicon.circuit.delivery.prepare import prepare_set
from thermicon.circuit.delivery.verify import verify
from thermicon.circuit.delivery.ways import worst_cases
from thermicon.circuit.live.ready import with_sensors
from thermicon.circuit.play.drives import judged
from thermicon.circuit.play.tcs2 import course_of
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import Icon, load_library
from thermicon.icons.model.statements import Rest

LOOP, CARD, STRIPS = "closed-loop-controller", "ni-analogue-output", "qst-tcs2"
FORM = load_format("psychopy")
Channels = dict[str, ExportChannel]


@cache
def channels(layout: str, icon: str, device: str, count: int = 5) -> Channels:
    """What the first elements of a layout play of a shipped icon; controllers are judged, others have a verdict."""
    library = {"wheel": "turns", "ring-four": "calls", "tcs2-strips": "bars"}[layout]
    spatial = next(each for each in load_library(library).spatial if each.name == icon)
    still = Icon(icon, (Rest(spatial.duration_s),), replace(spatial.context, elements=()))
    judge: Any = worst_cases if device == LOOP else lambda drives, _: tuple(map(GreenVerdict, drives))
    made = {}
    for element in Layout.of(layout).elements[:count]:
        # The independent circuit reads the numbers of a module, not its name.
        rig = Rig.load("fingertip").with_(**{"contact.area_cm2": 0.6}) if layout == "ring-four" else element.rig
        rig = with_sensors(rig) if device == LOOP else rig
        rig = rig.with_(**{"driver.transconductance_A_per_V": 0.1}) if device == CARD else rig
        track = spatial.tracks.get(element.name, still)
        tail_s = max(0.0, spatial.duration_s - duration_s(track, rig))
        made[element.name] = ExportChannel(
            rig, Device.load(device), prepare_set([track], rig, Device.load(device), FORM, judge=judge, tail_s=tail_s)
        )
    return made


def joined(made: Channels) -> bytes:
    """One file of all elements: a column for each behind its name, or a profile for the zone of each."""
    files = [FORM.write(channel.prepared[0].delivery).decode() for channel in made.values()]
    if not files[0].startswith("time_s"):
        commands, zones = [file.split() for file in files], "1" * len(files) + "0" * (5 - len(files))
        profiles = [own[2].replace("Uw11111", f"Uw{16 >> place:05b}") for place, own in enumerate(commands)]
        return "\n".join([*commands[0][:2], f"S{zones}", *profiles, f"Ue{zones}", "L", ""]).encode()
    tables = [list(csv.DictReader(io.StringIO(file))) for file in files]
    column = next(name for name in ("command_V", "display_C") if name in tables[0][0])
    text, longest = io.StringIO(), max(tables, key=len)
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["time_s", *(f"{name}_{column}" for name in made)])
    for place, row in enumerate(longest):
        rows.writerow([row["time_s"], *(table[min(place, len(table) - 1)][column] for table in tables)])
    return text.getvalue().encode()


class World:
    """A computer with a clock, the player of several elements, and the file of an icon."""

    def __init__(self, made: Channels, folder: Path, clock: Any, change: Callable[[bytes], bytes] = bytes) -> None:
        self.made, self.clock, content = made, clock, joined(made)
        name = "icon.csv" if content.startswith(b"time_s") else "icon.tcs2.txt"
        drives, demands = {}, {}
        for element, channel in made.items():
            (ready,) = channel.prepared
            drives[element] = [Played(ready.delivery, name, "icon.json", content=change(content))]
            demands[element] = ready.verdict.demands
        (folder / name).write_bytes(change(content))
        self.path, self.player = str(folder / name), dict[str, Any]()
        self.script = elements_player(drives, demands).decode()
        exec(compile(self.script, "play_icons.py", "exec"), self.player)
        self.player["atexit"].unregister(self.player["abort"])
        self.player |= {"time": clock, "POLARITY_SEEN": "A. Name, today"}

    @property
    def began_s(self) -> float:
        return float(self.player["_guard"].began_s)

    def off_K(self, name: str, time_s: Any, display_C: Any) -> float:
        """How far a display is from the trace of its rig at most, while its own track lasts."""
        trace = self.made[name].prepared[0].delivery.trace
        is_own = (time_s >= 0.0) & (time_s <= trace.time_s[-1])
        return float(np.abs(display_C - np.interp(time_s, trace.time_s, trace.display_C))[is_own].max())


class Thermostats:
    """Controllers with their plates on the independent circuit, by one clock."""

    def __init__(self, made: Channels) -> None:
        form, rng = load_format("setpoint-csv"), np.random.default_rng(0)
        self.of = {name: Thermostat(Export((channel,), form), rng, world=0) for name, channel in made.items()}
        self.seen: dict[str, list[tuple[float, float]]] = {name: [] for name in made}
        self.hangs: Callable[[], float] = lambda: 0.0
        self.sleep(0.1)  # a controller has read its sensors before anybody asks

    def monotonic(self) -> float:
        return next(iter(self.of.values())).now_s

    def sleep(self, seconds: float) -> None:
        longer_s = self.hangs()
        for name, each in self.of.items():
            each.sleep(seconds + longer_s)
            self.seen[name].append((each.now_s, each.display_C))

    def functions(self) -> list[dict[str, Any]]:
        verbs = ("send", "off", "read", "read_second", "test", "feed")
        return [{name: getattr(each, verb) for name, each in self.of.items()} for verb in verbs]


@pytest.mark.parametrize(
    ("layout", "icon", "count"), [("ring-four", "round", 1), ("wheel", "turn-left", 2), ("ring-four", "round", 3)]
)
def test_controllers_bring_each_plate_along_its_own_track(layout: str, icon: str, count: int, tmp_path: Path) -> None:
    made = channels(layout, icon, LOOP, count)
    world = World(made, tmp_path, Thermostats(made))
    world.player["play"](world.path, *world.clock.functions())
    for name in made:
        time_s, display_C = np.array(world.clock.seen[name]).T
        assert np.ptp(display_C) > 2.5
        assert world.off_K(name, time_s - world.began_s, display_C) < 0.05
    assert world.player["apart_s"]() == 0.0


@pytest.mark.parametrize("silent_s", [0.8, 1.1])
def test_four_controllers_switch_off_by_themselves_where_the_host_is_lost_for_a_second(
    silent_s: float, tmp_path: Path
) -> None:
    made = channels("ring-four", "round", LOOP)
    world = World(made, tmp_path, Thermostats(made))
    world.clock.hangs = lambda: silent_s * (world.clock.monotonic() - world.began_s - 1.0 > 0.0)
    with pytest.raises(RuntimeError, match=r"late by|switched off by itself"):
        world.player["play"](world.path, *world.clock.functions())
    for each in world.clock.of.values():
        assert not each.is_on
        assert (each.why == "the host was silent") == (silent_s > 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("fault", [each for each in FAULTS if each != "silent host"])
def test_a_fault_of_one_controller_switches_off_both_in_its_time(fault: str, tmp_path: Path) -> None:
    off_s = []
    for count in (1, 2):
        made = channels("wheel", "turn-left", LOOP, count)
        world = World(made, tmp_path, Thermostats(made))
        left = world.clock.of["left"]

        def strikes(world: World = world, left: Thermostat = left) -> float:
            if world.clock.monotonic() - world.began_s > 0.5:
                left.break_by(fault, 3.0, 0.5)
                world.clock.hangs = lambda: 0.0
            return 0.0

        world.clock.hangs = strikes
        with pytest.raises(RuntimeError):
            world.player["play"](world.path, *world.clock.functions())
        assert not any(each.is_on for each in world.clock.of.values())
        off_s.append(max(each.off_at_s for each in world.clock.of.values()) - world.began_s)
    # What switches off by itself is seen in the time to react.
    assert off_s[1] <= off_s[0] + world.player["REACT_S"]


class TestCard:
    """Elements on the channels of one NI device."""

    @pytest.fixture
    def card(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> World:
        clock = Clock()
        self.daq = Daq(clock.monotonic)
        for module in ("nidaqmx", "nidaqmx.constants"):
            monkeypatch.setitem(sys.modules, module, self.daq)
        return World(channels("wheel", "turn-left", CARD), tmp_path, clock)

    def test_each_channel_plays_its_own_track_by_the_clock_of_the_card(self, card: World) -> None:
        for _ in range(2):
            card.player["play"](card.path)
            card.clock.passes(60.0)
        assert self.daq.open_tasks == 0
        for place, (name, channel) in enumerate(card.made.items()):
            document = json.loads(channel.rig.document)
            plate = Player(document, np.random.default_rng(0), 0)
            plate.circuit = Circuit.of(document, plate.circuit.worlds[:1])
            ampere = 0.1 * np.array([*self.daq.holds[f"Dev1/ao{place}"], 0.0])
            held = Held.of(np.arange(len(ampere)) / self.daq.rate, ampere, ampere**2)
            rows, steps_s, _ = plate.play(held, plate.rest(held))
            assert card.off_K(name, np.append(0.0, np.cumsum(steps_s)), rows[:, 0, 2, 0]) < 1e-3

    def test_a_command_that_was_not_judged_for_its_element_is_refused(self, card: World) -> None:
        of_right = card.player["COMMANDS"]["icon.csv"]["right"]
        card.player["COMMANDS"]["icon.csv"]["right"] = (of_right[0], of_right[1] - 0.01)
        with pytest.raises(RuntimeError, match=r"a command of .* judged were"):
            card.player["play"](card.path)
        assert not self.daq.out

    def test_one_channel_that_stays_on_keeps_no_other_on(self, card: World, monkeypatch: pytest.MonkeyPatch) -> None:
        card.clock.at(132.0, card.player["abort"])
        write = Task.write

        def lost(task: Task, volts: Any, auto_start: bool = False) -> int:
            if task._channels == ["Dev1/ao0"]:
                raise DaqError(-200088, "lost")
            return write(task, volts, auto_start)

        monkeypatch.setattr(Task, "write", lost)
        with pytest.raises(RuntimeError, match=r"(?s)abort\(\) was called; left did not switch off \(lost.*cut the"):
            card.player["play"](card.path)
        assert (self.daq.stopped, self.daq.open_tasks) == (1, 0)
        assert [self.daq.holds[f"Dev1/ao{place}"] == 0.0 for place in range(2)] == [False, True]


class Strips(World):
    """A TCS II at a port; its zones follow their profiles without a lag."""

    def __init__(self, icon: str, folder: Path, change: Callable[[bytes], bytes] = bytes, count: int = 5) -> None:
        clock = Clock()
        self.port = Serial(clock.passes)
        super().__init__(channels("tcs2-strips", icon, STRIPS, count), folder, clock, change)

    def profile(self, zone: int) -> Any:
        """Times in s and °C of what a zone plays."""
        return np.array(course_of(["N320", self.port.device.started[zone].decode(), "L"])).T

    def play(self, order: Sequence[int]) -> None:
        """Prepare and play, watched by a sensor of each element on the zones of this order."""

        def read(zone: int) -> float:
            since_s, noise_K = self.clock.true_s - self.began_s, 1e-3 * float(np.sin(1e3 * self.clock.true_s))
            return noise_K + (float(np.interp(since_s, *self.profile(zone))) if self.port.device.is_playing else 32.0)

        self.player["prepare"](self.port, self.path)
        sensors = {name: lambda zone=zone: read(zone) for name, zone in zip(self.made, order, strict=False)}
        self.player["play"](self.port, sensors)


@pytest.mark.parametrize(
    ("icon", "count"), [("upward", 5), ("downward", 5), ("level-three", 5), ("level-one", 5), ("upward", 3)]
)
def test_zones_of_one_thermode_play_their_own_tracks(icon: str, count: int, tmp_path: Path) -> None:
    strips = Strips(icon, tmp_path, count=count)
    strips.play(range(5))
    assert not strips.port.device.garbled
    assert len(strips.port.device.started) == count
    for zone, name in enumerate(strips.made):
        display_C = [32.0]
        for level_C in np.interp(np.arange(0.0, 8.0, 0.001), *strips.profile(zone)):
            display_C.append(display_C[-1] + (level_C - display_C[-1]) * -np.expm1(-0.001 / 0.21))
        assert strips.off_K(name, 0.001 * np.arange(len(display_C)), np.array(display_C)) < 0.05


def test_exchanged_or_missing_zones_do_not_play(tmp_path: Path) -> None:
    strips = Strips("upward", tmp_path)
    with pytest.raises(RuntimeError, match=r"s[1-5]: the display is at .* from its prediction"):
        strips.play([4, 1, 2, 3, 0])
    assert strips.port.commands[-1] == b"A"
    own = (b"Ue11111", b"Ue11101"), (b"Uw00010", b"Uw00011"), (b"S11111", b"S11101"), (b"Uw00010", b"Uw00000")
    for old, new in own:
        strips = Strips("upward", tmp_path, lambda content, old=old, new=new: content.replace(old, new))
        with pytest.raises(ValueError, match=r"Ue and S must enable these|for zones of its own"):
            strips.play(range(5))
        assert not strips.port.commands
    with pytest.raises(ValueError, match="profiles are for the zones 11100"):
        Strips("upward", tmp_path, lambda content: content.replace(b"S11100\n", b""), 3).play(range(3))


@pytest.mark.parametrize(("library", "layout", "device"), [("turns", "wheel", LOOP), ("bars", "tcs2-strips", STRIPS)])
def test_an_exported_folder_plays(library: str, layout: str, device: str, tmp_path: Path) -> None:
    made = export(library, layout, device, "psychopy", folder=tmp_path)
    assert verify({path.name: path.read_bytes() for path in tmp_path.iterdir()}).well
    of = {channel.element: channel for channel in made.channels}
    clock: Any = Clock() if device == STRIPS else Thermostats(of)
    port, player = Serial(), dict[str, Any]()
    exec(compile((tmp_path / "play_icons.py").read_text(), "play_icons.py", "exec"), player)
    player["atexit"].unregister(player["abort"])
    player["time"] = clock
    rows = list(csv.DictReader(io.StringIO((tmp_path / "conditions.csv").read_text())))
    for place, row in enumerate(rows if device == STRIPS else rows[:1]):
        drive, traces = str(tmp_path / row["drive_file"]), [each.prepared[place].delivery.trace for each in of.values()]
        if device == STRIPS:
            player["prepare"](port, drive)
            player["play"](port)
            clock.passes(float(row["duration_s"]) + player["PAUSE_S"])
            for profile, trace in zip(port.device.started.values(), traces, strict=True):
                course = np.array(course_of(["N320", profile.decode(), "L"])).T
                assert np.abs(np.interp(trace.time_s, *course) - trace.target_C).max() < 0.06
        else:
            player["play"](drive, *clock.functions())
            for seen, trace in zip(clock.seen.values(), traces, strict=True):
                since_s, display_C = np.array(seen).T - np.array([[player["_guard"].began_s], [0.0]])
                off_K = np.abs(display_C - np.interp(since_s, trace.time_s, trace.display_C))
                assert off_K[since_s >= 0.0].max() < 0.05


@pytest.mark.parametrize("device", [CARD, STRIPS, LOOP])
def test_no_number_of_a_script_is_given_twice(device: str) -> None:
    layout, icons = ("tcs2-strips", "bars") if device == STRIPS else ("wheel", "turns")
    for files in (exported(device)[0], export(icons, layout, device, "psychopy").files):
        statements = ast.parse(files["play_icons.py"].decode()).body
        targets = [target for each in statements if isinstance(each, ast.Assign) for target in each.targets]
        names = [name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)]
        assert len(names) == len(set(names)), Counter(names).most_common(1)


def test_a_table_with_an_element_in_any_script_is_read(tmp_path: Path) -> None:
    content = "time_s,links_C,rücken_C\n".encode()
    (tmp_path / "a.csv").write_bytes(content)
    assert "rücken_C" in judged(str(tmp_path / "a.csv"), {"a.csv": hashlib.sha256(content).hexdigest()})


def test_a_player_of_one_element_has_nothing_of_several(tmp_path: Path) -> None:
    for device in (CARD, STRIPS, LOOP):
        assert not re.search("[Ee]lement|ELEMENT|zone", exported(device)[0]["play_icons.py"].decode())
    assert "class ElementsGuard" in Strips("upward", tmp_path).script
