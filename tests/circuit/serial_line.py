"""A substitute for pyserial's Serial with a TCS II at its other end."""

from __future__ import annotations

import threading
from collections.abc import Callable

BYTES_PER_S = 11_520.0
DIGITS = {b"N": 3, b"Om": 3, b"Ue": 5, b"S": 5}
BEFORE = b"Uw11111001100450"


class Thermode:
    """A TCS II by its list of commands (pytcsii of mpcoll): N, Om, S, Ue and Uw are followed by digits, L, A are alone.

    A command that was begun takes what follows as its digits, whatever that is: an `A` among them aborts nothing. The
    masks of S (areas that stimulate, at first all), Uw (whose profile it is) and Ue (whose profile is played, at first
    none) are of the zones 1 to 5; a zone that stimulates without a profile plays what was set before.
    """

    def __init__(self, commands: list[bytes]) -> None:
        self.commands, self._begun, self.is_playing, self.garbled = commands, b"", False, list[bytes]()
        self.masks, self.profiles = {b"S": b"11111", b"Ue": b"00000"}, dict.fromkeys(range(5), BEFORE)
        self.started: dict[int, bytes] = {}

    def take(self, data: bytes) -> None:
        for place in range(len(data)):
            self._begun += data[place : place + 1]
            if self._is_whole():
                command, self._begun = self._begun, b""
                self.commands.append(command)
                self.is_playing = command == b"L" or (self.is_playing and command != b"A")
                if command[:2] == b"Uw":
                    self.profiles |= {zone: command for zone, bit in enumerate(command[2:7]) if bit == ord("1")}
                elif command[:-5] in self.masks:
                    self.masks[command[:-5]] = command[-5:]
                elif command == b"L":
                    zones = [zone for zone in range(5) if self.masks[b"S"][zone : zone + 1] == b"1"]
                    played = {zone: self.masks[b"Ue"][zone : zone + 1] == b"1" for zone in zones}
                    self.started = {zone: self.profiles[zone] if played[zone] else BEFORE for zone in zones}
                if not command.lstrip(b"NOmUweLAS").isdigit() and command not in (b"L", b"A"):
                    self.garbled.append(command)

    def _is_whole(self) -> bool:
        begun = self._begun
        if begun in (b"L", b"A"):
            return True
        if begun[:2] == b"Uw":
            return len(begun) >= 10 and len(begun) == 10 + 6 * int(begun[7:10])
        name = begun[:1] if begun[:1] in (b"N", b"S") else begun[:2]
        return len(begun) == len(name) + DIGITS.get(name, 99)


class Serial:
    """A port of pyserial.

    Rules, by the source of pyserial 3.5 (`serialposix.py`, `serialwin32.py`): `write` blocks until the bytes are with
    the line (115,200 baud: 87 µs each) and returns how many, fewer where `cancel_write` of another thread ended it; a
    port that was opened with `exclusive=True` is opened by no other; a port that is closed takes nothing.
    """

    def __init__(self, takes: Callable[[float], None] = lambda seconds: None, name: str = "COM3") -> None:
        self.commands: list[bytes] = []
        self.device = Thermode(self.commands)
        self.takes, self.name = takes, name
        self.hang_after: int | None = None
        self.hangs, self._cancelled = threading.Event(), threading.Event()

    def write(self, data: bytes) -> int:
        count = len(data) if self.hang_after is None else min(self.hang_after, len(data))
        self.takes(count / BYTES_PER_S)
        self.device.take(data[:count])
        if count < len(data):
            self.hang_after = None
            self.hangs.set()
            assert self._cancelled.wait(5.0), "a write that hangs is cancelled by nobody"
        return count

    def cancel_write(self) -> None:
        self._cancelled.set()


class Ports:
    """The module `serial` of a computer: what was opened exclusively is opened by no other."""

    def __init__(self) -> None:
        self.open: set[str] = set()

    def Serial(self, name: str, baudrate: int, timeout: float, exclusive: bool | None = None) -> Serial:
        assert (baudrate, timeout) == (115_200, 0.1)
        if name in self.open:
            raise OSError(f"[Errno 11] Could not exclusively lock port {name}: Resource temporarily unavailable")
        if exclusive:
            self.open.add(name)
        return Serial(name=name)
