"""The line to a microcontroller that plays exported icons by itself.

The program on it is the exported thermicon_player.h behind thermicon_serial.h, which says how the lines look.
"""

from __future__ import annotations

import binascii
import math
import os
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any

from .logged_line import LineRow
from .watch import Refused, Stopped

BAUD, ANSWERS_S, WAKES_S, SILENT_S = 115_200, 0.5, 4.0, 1.0
"""An answer comes within so long, also from a board that a port's opening resets; rows are never farther apart."""
TESTING, RESTING, PLAYING, STOPPED, OFF, NOT_BEGUN = range(6)
FAULTS = (
    *("no fault", "the host stopped it", "the host was silent", "its loop was late", "a sensor is lost"),
    *("a sensor is frozen", "too cold", "too warm", "the display did not fall: swapped wires, or no current"),
    *("its clock stands still", "its sensors are apart", "its loop left the predicted course"),
    "the display was beyond the second cut-off for too long",
)
ANSWERS = (
    "ok",
    "it lacks a sensor",
    "it has not rested",
    "the pause is not over",
    "it plays",
    "it stopped",
    "no clock",
)
SETTINGS = ("watchdog", "low_A", "high_A", "low_C", "high_C", "held_low_C", "held_high_C", "held", "rest")


def sealed(text: str) -> bytes:
    """A line with its checksum."""
    return f"{text}*{binascii.crc_hqx(text.encode('ascii'), 0):04X}\n".encode("ascii")


def unsealed(line: bytes) -> list[str] | None:
    """The words of a line whose checksum is right."""
    text, _, seal = line.strip().rpartition(b"*")
    right = seal == b"%04X" % binascii.crc_hqx(text, 0)
    return text.decode("ascii").split() if right and text.isascii() else None


class Board:
    """A board at a serial port that was compiled from an export with this digest, and has its icons in this order.

    A time in s of this computer is that of the row that came with the least delay; `fell_K` has the fall of each sensor
    in the polarity test. Opened for this program alone.
    """

    def __init__(
        self, port: str, digest: str, names: Sequence[str], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._name, self._digest, self._names, self._clock = port, digest, list(names), clock
        self._port: Any = None
        self._unread, self._lost = b"", ""
        self._answers: list[list[str]] = []
        self._rows: list[LineRow] = []
        self._lock = threading.RLock()  # sensors are read in a thread of their own
        self._state, self._fault, self._last_s = NOT_BEGUN, 0, -math.inf
        self._last: LineRow | None = None
        self._is_past = True
        self._behind_s, self._heard_s = math.inf, -math.inf
        self._began_s, self._period_s = math.inf, 0.0
        self._test_from: tuple[float, float] | None = None
        self.fell_K: dict[str, float] = {}
        self.settings: dict[str, float] = {}

    def open(self) -> None:
        """Connect, unless that is done: the port for this program alone; Refused for a board of another export.

        What stopped the board before counts no more; it stays off until it begins.
        """
        self._is_past = True
        if self._port is not None:
            return
        self._port = _port(self._name)
        until_s = time.monotonic() + WAKES_S
        words: list[str] | None = None
        while words is None and time.monotonic() < until_s:
            words = self._ask("?", "I")
        if words is None or words[:3] != ["I", "thermicon", "2"]:
            self.close()
            raise Refused(f"{self._name}: no board answers with thermicon_serial.h; give its port, or compile it again")
        if words[3] != self._digest or int(words[4]) != len(self._names):
            self.close()
            raise Refused(
                f"{self._name}: the board was compiled from another export ({words[3]}, this one is {self._digest}); "
                "export to c-array, compile and upload it again"
            )
        self.settings = {name: 1e-3 * int(word) for name, word in zip(SETTINGS, words[5:], strict=True)}

    def close(self) -> None:
        """Let the port go."""
        port, self._port = self._port, None
        if port is not None:
            port.close()

    def send(self, row: tuple[str, int]) -> Callable[[], bool] | None:
        """Begin with the rest of an icon, ("B", place), or play it, ("P", place); Stopped where the board does not."""
        what, place = row
        words = self._ask(f"{what} {place}", "A", what)
        answer = "it is silent" if words is None else ANSWERS[int(words[2])]
        if answer != "ok":
            raise Stopped(f"the board did not {'begin' if what == 'B' else 'play'}: {answer}")
        if what == "B":
            self._test_from, self.fell_K = None, {}
            self._state, self._is_past = OFF, False
            return None
        self._began_s = math.inf
        return self._still

    def test(self, current_A: float) -> bool:
        """Begin, whatever the current: the board tests the polarity by itself, and puts nothing out by hand."""
        self.send(("B", 0))
        return False

    def feed(self) -> None:
        """Tell the board that this computer is alive."""
        self._write("F")

    def off(self) -> None:
        """Stop; a board that does not hear it stops by its watchdog."""
        if self._port is not None:
            with suppress(Stopped):
                self._ask("S", "A", "S")

    def read(self) -> float:
        """Return the °C of the loop's sensor."""
        return self._newest().loop_C

    def read_second(self) -> float:
        """Return the °C of the cut-off's sensor."""
        return self._newest().second_C

    def rows(self) -> list[LineRow]:
        """Return the turns since the last call."""
        with self._lock:
            self._take()
            rows, self._rows = self._rows, []
        return rows

    def status(self) -> Mapping[str, object]:
        """Return what the board says that it was compiled with, and why it stopped."""
        self._take()
        stopped = FAULTS[self._fault] if self._state == STOPPED else ""
        return {**self.settings, "identity": f"board {self._digest} at {self._name}", "stopped": stopped}

    def rest_row(self, name: str, level_C: float) -> tuple[str, int]:
        """The board holds the rest of an icon by itself."""
        return "B", self._names.index(name)

    def play_rows(self, name: str, rows: Sequence[tuple[float, float]]) -> list[tuple[float, Any]]:
        """The board plays an icon by itself."""
        self._period_s = rows[1][0] - rows[0][0]
        return [(0.0, ("P", self._names.index(name))), (rows[-1][0], None)]

    def began_s(self, host_s: float) -> float:
        """The time at which the icon began by its rows, of which each has the place in the icon; some may be lost."""
        return self._began_s - 1e-6 if math.isfinite(self._began_s) else host_s

    def _still(self) -> bool:
        self._take()
        return self._state == PLAYING

    def _newest(self) -> LineRow:
        """Return the last row; RuntimeError where the board switched off by itself, or was silent for a second."""
        with self._lock:
            self._take()
            if self._state == STOPPED and not self._is_past:
                raise RuntimeError(f"the board switched off by itself: {FAULTS[self._fault]}")
            if self._lost or self._last is None or time.monotonic() - self._heard_s > SILENT_S:
                raise RuntimeError(self._lost or f"the board has been silent for {SILENT_S:g} s")
            return self._last

    def _ask(self, text: str, *answer: str) -> list[str] | None:
        """Send a line until its answer comes, twice at most; None where it does not come."""
        for _ in range(2):
            with self._lock:
                self._answers.clear()
            self._write(text)
            until_s = time.monotonic() + ANSWERS_S
            while time.monotonic() < until_s:
                with self._lock:
                    self._take()
                    for words in self._answers:
                        if tuple(words[: len(answer)]) == answer:
                            return words
                time.sleep(0.001)
        return None

    def _write(self, text: str) -> None:
        try:
            self._port.write(sealed(text))
        except OSError as problem:
            self._lost = f"the port {self._name} is lost ({problem})"
            raise Stopped(self._lost) from None

    def _take(self) -> None:
        """Take what has come: rows, of which the last one is the newest, and answers."""
        with self._lock:
            try:
                came = self._port.read(65_536)
            except OSError as problem:
                self._lost = f"the port {self._name} is lost ({problem})"
                return
            *lines, self._unread = (self._unread + came).split(b"\n")
            for line in lines:
                words = unsealed(line)
                if words and words[0] == "D" and len(words) == 11:
                    self._take_row(words[1:])
                elif words:
                    self._answers.append(words)

    def _take_row(self, words: list[str]) -> None:
        turn, state, fault, _, place, *rest = words
        loop_C, second_C, goal_C = (1e-3 * int(word) for word in rest[:3])
        output_A = 1e-5 * int(rest[3])
        voltage_V = None if rest[4] == "-" else 1e-3 * int(rest[4])
        own_s = 1e-4 * int(turn)
        if own_s < self._last_s:  # it was reset: its clock begins again
            self._behind_s = math.inf
        self._last_s, self._heard_s = own_s, time.monotonic()
        self._behind_s = min(self._behind_s, self._clock() - own_s)
        was, self._state, self._fault = self._state, int(state), int(fault)
        on = self._state in (RESTING, PLAYING)
        row = LineRow(own_s + self._behind_s, goal_C if on else None, loop_C, second_C, output_A, voltage_V)
        levels = loop_C, second_C
        if was == OFF and self._state == TESTING:
            self._test_from = levels
        if was == TESTING and self._test_from is not None and self._state != TESTING:
            fell_K = (before - after for before, after in zip(self._test_from, levels, strict=True))
            self.fell_K = dict(zip(("sensor", "second sensor"), fell_K, strict=True))
        if self._state == PLAYING:
            self._began_s = min(self._began_s, row.time_s - int(place) * self._period_s)
        self._last = row
        self._rows.append(row)


def _port(name: str) -> Any:
    """Open a port for this program alone: locked before the first byte, and exclusively where the system knows that."""
    try:
        serial: Any = import_module("serial")
    except ImportError:
        raise Refused("a board needs pyserial, which is not installed: pip install pyserial") from None
    try:
        port = serial.Serial(name, baudrate=BAUD, timeout=0, write_timeout=SILENT_S, exclusive=True)
    except serial.SerialException as problem:
        taken = "lock" in str(problem).casefold() or "busy" in str(problem).casefold()
        there = ", ".join(port.device for port in import_module("serial.tools.list_ports").comports())
        cure = "another program has it; close that" if taken else f"there are: {there or 'none'}"
        raise Refused(f"the port {name} cannot be opened ({problem}); {cure}") from None
    if os.name == "posix":
        import fcntl
        import termios

        fcntl.ioctl(port.fileno(), termios.TIOCEXCL)
    return port
