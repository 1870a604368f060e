"""A player of drives on a simulated clock, NI card or serial line."""

import csv
import hashlib
import io
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.circuit.daq import Daq
from tests.circuit.delivery.one_drive import prepare
from tests.circuit.play.bench import Clock
from tests.circuit.serial_line import Serial
from tests.circuit.verdicts import MADE_UP, GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import Icon, load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]


class Bench:
    """A player of drives on a device, with its clock and its folder."""

    def __init__(
        self, device: Device, folder: Path, monkeypatch: pytest.MonkeyPatch, icon: Icon = ICON, **demands: Any
    ) -> None:
        form = load_format("psychopy")
        verdict = type("Verdict", (GreenVerdict,), {"demands": replace(MADE_UP, **demands)})
        ready = self.ready = prepare(icon, RIG, device, form, gate=verdict)
        self.files = pack([ready], form)
        self.drive = form.file_name(ready.delivery)
        (folder / self.drive).write_bytes(self.files[self.drive])
        self.path = str(folder / self.drive)
        self.clock = Clock()
        self.daq = Daq(self.clock.monotonic)
        monkeypatch.setitem(sys.modules, "nidaqmx", self.daq)
        monkeypatch.setitem(sys.modules, "nidaqmx.constants", self.daq)
        self.player: dict[str, Any] = {}
        exec(compile(self.files["play_icons.py"], "play_icons.py", "exec"), self.player)
        self.player["time"] = self.clock
        self.player["POLARITY_SEEN"] = "A. Name, today"
        self.reading = 32.0
        self.noise = 0.001
        self.port = Serial(self.clock.passes)
        self.sent = self.port.commands

    def measured(self) -> float:
        """A live reading: its last digit moves."""
        self.noise = -self.noise
        return self.reading + self.noise

    def rows(self) -> list[dict[str, str]]:
        return list(csv.DictReader(io.StringIO(self.files[self.drive].decode())))

    def play(self, *arguments: object) -> None:
        self.player["play"](self.path, *arguments)

    def stops(self, words: str, *arguments: object) -> None:
        with pytest.raises(RuntimeError, match=words):
            self.play(*arguments)

    def rejudge(self) -> None:
        """What is in the folder now counts as judged."""
        self.player["DRIVES"][self.drive] = hashlib.sha256(Path(self.path).read_bytes()).hexdigest()

    def follows(self, later_s: float = 0.0) -> float:
        """A display that goes where it is predicted to go, after the rest of 30 s."""
        display = self.ready.delivery.trace
        return (
            float(np.interp(self.clock.true_s - 130.0 - later_s, display.time_s, display.display_C))
            + self.measured()
            - 32.0
        )

    def cools(self, sign: float = 1.0) -> None:
        """The display goes with the last voltage: above rest it cools."""

        def moves() -> None:
            if self.daq.out and isinstance(self.daq.out[-1], float) and self.daq.out[-1] > 1.0:
                self.reading -= sign * 0.1

        self.clock.events.append(moves)
