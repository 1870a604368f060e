"""Stand-ins for person and hardware of a study on a clock that only counts."""

from __future__ import annotations

import random
import sys
import types
from collections.abc import Callable, Iterable, Mapping, Sequence

from .study_bench import Display, load_player

TICK_S = 0.01
Person = Callable[[str, Sequence[str]], tuple[str, float]]
"""What a person answers to what is presented, of some choices, and after how many s."""


class SimulatedClock:
    """Time that passes only in sleep(); stands in for `time` in play_icons.py too."""

    def __init__(self, keys: Iterable[tuple[float, str]]) -> None:
        self.s = 0.0
        self.due = sorted(keys)
        self.pressed: list[str] = []
        self.on_key: Callable[[str], object] = lambda key: None

    def monotonic(self) -> float:
        """The time in s."""
        return self.s

    def sleep(self, seconds: float) -> None:
        """Let time pass, and press the keys that are due."""
        until = self.s + max(0.0, seconds)
        while self.due and self.due[0][0] <= until:
            at, key = self.due.pop(0)
            self.s = max(self.s, at)
            self.pressed.append(key)
            self.on_key(key)
        self.s = until


class SimulatedScreen:
    """Presses the start key when asked to, and answers as a virtual person does."""

    def __init__(self, clock: SimulatedClock, person: Person, start_key: str, quiet: bool = True) -> None:
        self.clock, self.person, self.start_key, self.quiet = clock, person, start_key, quiet
        self._waiting: tuple[float, str] | None = None
        self._shown = ""

    def now(self) -> float:
        """The time in s."""
        return self.clock.s

    def show(self, text: str) -> None:
        """Print a text that is new."""
        if text != self._shown and not self.quiet:
            print(f"[{self.clock.s:8.1f} s] {' / '.join(line for line in text.splitlines() if line)}")
        self._shown = text

    def tick(self) -> list[str]:
        """Let a tick pass, and return the keys pressed in it."""
        if self._waiting is not None and self.clock.s >= self._waiting[0]:
            self.clock.pressed.append(self._waiting[1])
            self._waiting = None
        self.clock.sleep(TICK_S)
        pressed, self.clock.pressed = self.clock.pressed, []
        return pressed

    def expect(self, presented: str | None, choices: Mapping[str, str]) -> None:
        """The virtual person will press one of the keys (choices: key by answer), or the start key for None."""
        if presented is None:
            self._waiting = (self.clock.s + 1.0, self.start_key)
        else:
            answer, after_s = self.person(presented, list(choices))
            self._waiting = (self.clock.s + after_s, choices[answer])

    def close(self) -> None:
        """There is no window."""


class SimulatedDisplay(Display):
    """The same player with a stand-in for the hardware, without a thread: the clock jumps over a play."""

    def __init__(self, plays: str, clock: SimulatedClock) -> None:
        self.out: list[object] = []
        self.device = SimulatedNi(clock, self.out)
        sys.modules["nidaqmx"] = sys.modules["nidaqmx.constants"] = self.device
        self.player = load_player()
        self.player.time = clock
        self.player.POLARITY_SEEN, self.player.SECOND_SENSOR = "simulated: there is no display", False
        self.own = types.SimpleNamespace(send=self.out.append, off=lambda: self.out.append("off"))
        self.plays, self.error, self._thread = plays, None, None
        self.port = types.SimpleNamespace(write=self.out.append)

    def _begin(self, drive: str, *functions: Callable[..., object]) -> None:
        self._do(drive, functions)

    def switch_off(self) -> None:
        """As on hardware; a task that is still open then is an error, since it keeps its channel."""
        super().switch_off()
        if self.device.tasks:
            raise SimulatedNi.DaqError(f"tasks that nobody closed: {len(self.device.tasks)}")


class SimulatedNi(types.ModuleType):
    """A stand-in for nidaqmx that keeps the rules of the driver.

    By the source of nidaqmx-python 1.7.0 and the NI-DAQmx help ("Task State Model", "Reserving resources"): a task that
    was started keeps its channel until stop() or close(), and another one that starts on it fails with -50103; a task
    that is dropped without close() stays as it is (there with a ResourceWarning), `tasks` holds those that are open; a
    voltage outside min_val to max_val fails with -200077; a write puts nothing out before the task is started.
    """

    AcquisitionType = types.SimpleNamespace(FINITE="finite")

    class DaqError(Exception):
        """What the driver refuses."""

    def __init__(self, clock: SimulatedClock, out: list[object]) -> None:
        super().__init__("nidaqmx")
        self.clock, self.out = clock, out
        self.tasks: list[SimulatedTask] = []

    def Task(self) -> SimulatedTask:
        """A new task, which is open until close()."""
        self.tasks.append(SimulatedTask(self))
        return self.tasks[-1]


class SimulatedTask:
    """A task of SimulatedNi, on one channel."""

    def __init__(self, driver: SimulatedNi) -> None:
        self.driver, self.channel, self.range_V = driver, "", (0.0, 0.0)
        self.plays_s = self.ends_s = 0.0
        self.started = False
        self.ao_channels = self.timing = self

    def __enter__(self) -> SimulatedTask:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def add_ao_voltage_chan(self, channel: str, min_val: float = -10.0, max_val: float = 10.0) -> None:
        """Take a channel and its range in V."""
        self.channel, self.range_V = channel, (min_val, max_val)

    def cfg_samp_clk_timing(self, rate: float, sample_mode: str, samps_per_chan: int) -> None:
        """Play a block of samples at a rate in Hz."""
        self.plays_s = samps_per_chan / rate

    def start(self) -> None:
        """Keep the channel from now on."""
        if any(other.started and other.channel == self.channel for other in self.driver.tasks if other is not self):
            raise SimulatedNi.DaqError(f"-50103: the specified resource is reserved: {self.channel}")
        self.started = True

    def write(self, volts: float | list[float], auto_start: bool = False) -> None:
        """Put out a voltage, or a block of them by the clock of the device."""
        block = volts if isinstance(volts, list) else [volts]
        low_V, high_V = self.range_V
        if not all(low_V <= at_V <= high_V for at_V in block):
            raise SimulatedNi.DaqError(f"-200077: a voltage is outside {low_V} to {high_V} V")
        if auto_start and not self.started:
            self.start()
        assert self.started, "a write puts nothing out before start()"
        self.driver.out.append(len(block) if isinstance(volts, list) else volts)
        self.ends_s = self.driver.clock.s + self.plays_s

    def is_task_done(self) -> bool:
        """Whether a block has ended."""
        return self.driver.clock.s >= self.ends_s

    def stop(self) -> None:
        """Let the channel go."""
        self.started = False

    def close(self) -> None:
        """Stop, and be no task any more."""
        self.stop()
        if self in self.driver.tasks:
            self.driver.tasks.remove(self)


def virtual_person(seed: str, correct: float) -> Person:
    """Names what was presented with a probability, else anything else; answers after about a second."""
    rng = random.Random(seed)

    def answers(presented: str, choices: Sequence[str]) -> tuple[str, float]:
        others = [choice for choice in choices if choice != presented]
        right = presented in choices and (not others or rng.random() < correct)
        return (presented if right else rng.choice(others)), rng.lognormvariate(0.2, 0.4)

    return answers
