"""The hardware of a study.

Nothing here waits: drives are played in a thread, so that the keys are read all the time. Every play goes through
play_icons.py, which holds the rest, refuses a play before the pause is over, tests the polarity, and switches off
where the measured display leaves the cut-off. It needs measured_C() for that, from a file of your own (--bench), and a
controller's needs second_C() too, which reads a second sensor. Between plays the loop that reads the keys calls keep().
"""

from __future__ import annotations

import importlib.util
import inspect
import threading
import time
import types
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent


def load(path: Path, name: str) -> Any:
    """A Python file as a module."""
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def load_player() -> Any:
    """The player of this folder, which must be as new as this script."""
    player = load(HERE / "play_icons.py", "play_icons")
    if not hasattr(player, "keep"):
        raise SystemExit("play_icons.py is older than this script: export the study again")
    return player


class Display:
    """Plays drives through play_icons.py in a thread; `plays` is "ni", "tcs2" or "send".

    `own` holds what a bench offers: the functions measured_C, second_C, send, off, feed (the host is alive) and test
    (put out a current in A), and the text polarity_seen: who saw the display cool, and when, where nothing can test it.
    """

    def __init__(self, plays: str, own: Any = None, channel: str | None = None, port: str | None = None) -> None:
        self.player = load_player()
        self.own = types.SimpleNamespace() if own is None else own
        self.plays, self.port = plays, None
        self.error: BaseException | None = None
        self._thread: threading.Thread | None = None
        if plays == "send" and not (hasattr(own, "send") and hasattr(own, "off")):
            raise SystemExit("the controller needs --bench FILE.py with the functions send(display_C) and off()")
        if hasattr(own, "polarity_seen"):
            self.player.POLARITY_SEEN = own.polarity_seen
        if plays == "ni" and channel:
            self.player.CHANNEL = channel
        if plays == "tcs2":
            if port:
                self.player.PORT = port
            self.port = self.player.connect()

    def prepare(self, drive: str) -> None:
        """Begin to send what can be sent before a play."""
        if self.plays == "tcs2":
            self._begin(drive, self.player.prepare)

    def rest(self, drive: str) -> None:
        """Begin to hold the rest, as play_icons does before a first play."""
        if self.plays == "tcs2":
            self._begin(drive, self.player.prepare, self.player.rest)
        else:
            self._begin(drive, self.player.rest)

    def play(self, drive: str) -> None:
        """Begin a play; returns at once."""
        self._begin(drive, self.player.play)

    def _begin(self, drive: str, *functions: Callable[..., object]) -> None:
        self._thread = threading.Thread(target=self._do, args=(drive, functions), daemon=True)
        self._thread.start()

    def _do(self, drive: str, functions: tuple[Callable[..., object], ...]) -> None:
        """Call functions of the player with what they take of drive, port and bench."""
        offered = {**vars(self.own), "drive_file": drive, "port": self.port}
        try:
            for function in functions:
                taken = inspect.signature(function).parameters
                function(**{name: value for name, value in offered.items() if name in taken})
        except BaseException as problem:  # told by the thread that reads the keys
            self.error = problem

    @property
    def busy(self) -> bool:
        """Whether the player prepares, rests or plays; raises what ended it."""
        if self.error is not None:
            raise self.error
        return self._thread is not None and self._thread.is_alive()

    def keep(self) -> None:
        """Look at the sensors and feed the device where no play does; returns at once, raises what stopped."""
        if not self.busy:
            self.player.keep()

    def log_into(self, path: Path) -> None:
        """Only a device that reports its turns has a log."""

    def abort(self) -> None:
        """Switch off at once, whatever the thread waits for; nothing plays again in this run."""
        try:
            self.player.abort()  # puts the line off by itself
            if self._thread is not None:
                self._thread.join(timeout=2.0)
        finally:
            self.switch_off()

    def switch_off(self) -> None:
        """Leave the display without power, or its controller aborted."""
        if self.plays == "ni":
            self.player._off()
        elif self.plays == "tcs2":
            self.player._line(self.port).off()  # which ends a command that is half out before
        else:
            self.own.off()


class Screen:
    """Text and keys by PsychoPy."""

    def __init__(self, fullscreen: bool = True) -> None:
        from psychopy import event, visual

        self._event = event
        self._window = visual.Window(fullscr=fullscreen, color="black", units="height")
        self._text = visual.TextStim(self._window, height=0.04, wrapWidth=1.4)

    def now(self) -> float:
        """The time in s."""
        return time.monotonic()

    def show(self, text: str) -> None:
        """Have a text drawn from now on."""
        self._text.text = text

    def tick(self) -> list[str]:
        """Draw once, and return the keys pressed since the last time."""
        self._text.draw()
        self._window.flip()
        keys: list[str] = self._event.getKeys()
        return keys

    def expect(self, presented: str | None, choices: Mapping[str, str]) -> None:
        """A person needs no hint."""

    def close(self) -> None:
        """Close the window."""
        self._window.close()


class Marker:
    """Codes 1 to 255 on a line: none, serial:PORT, parallel:ADDRESS or ni:LINES."""

    PULSE_S = 0.01

    def __init__(self, line: str) -> None:
        kind, _, place = line.partition(":")
        kinds = {"none": self._nothing, "serial": self._serial, "parallel": self._parallel, "ni": self._ni}
        if kind not in kinds or bool(place) == (kind == "none"):
            raise SystemExit(f"--marker {line}: give none, serial:PORT, parallel:ADDRESS or ni:LINES")
        self._send = kinds[kind](place)

    def __call__(self, code: int) -> None:
        """Put out a code."""
        self._send(code)

    def _nothing(self, place: str) -> Callable[[int], object]:
        return lambda code: None

    def _serial(self, place: str) -> Callable[[int], object]:
        import serial

        port = serial.Serial(place, baudrate=115200)
        return lambda code: port.write(bytes([code]))

    def _pulse(self, put: Callable[[int], object]) -> Callable[[int], object]:
        def send(code: int) -> None:
            put(code)
            threading.Timer(self.PULSE_S, put, args=(0,)).start()

        return send

    def _parallel(self, place: str) -> Callable[[int], object]:
        from psychopy import parallel

        return self._pulse(parallel.ParallelPort(address=int(place, 0)).setData)

    def _ni(self, place: str) -> Callable[[int], object]:
        import nidaqmx

        task = nidaqmx.Task()
        task.do_channels.add_do_chan(place, line_grouping=nidaqmx.constants.LineGrouping.CHAN_FOR_ALL_LINES)
        return self._pulse(lambda code: task.write(code, auto_start=True))
