"""A substitute for nidaqmx that keeps the driver's rules and records its output at the pace of a given clock."""

from __future__ import annotations

import types
from collections.abc import Callable
from typing import Any

RESERVED, OUTSIDE, NO_TASK, NO_CHANNEL = -50103, -200077, -200088, -200478


class DaqError(Exception):
    """An error of the driver, with its number."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(f"{text}\n\nStatus Code: {code}")
        self.error_code = code


class Task:
    """A task of the driver.

    Rules, by the source of nidaqmx-python 1.7.0 (`task/_task.py`, `errors.py`, `constants.py`) and the NI-DAQmx help
    ("Task State Model", "Reserving resources", `Auto Start` of DAQmx Write):

    - a task that was started reserves its channels until `stop()` or `close()`, also when it is done; a second one that
      starts on them fails with -50103, and what is forgotten keeps its reservation, since nothing clears it;
    - `with` closes at its end; a closed task answers -200088 to everything;
    - a voltage outside `min_val` … `max_val` of its channel fails with -200077, and nothing of the write is put out;
    - a write starts a task only with `auto_start`; a buffered one needs a sample clock for as many samples;
    - a channel holds the last voltage that was put out, whatever becomes of the task;
    - a device runs one clocked task for its outputs, and no other one beside it (NI knowledge base, simultaneous tasks;
      cDAQ-9181 manual, 3-13): several channels on one clock are one task, which takes a list for each.
    """

    def __init__(self, daq: Daq) -> None:
        self._daq, self._channels, self._ends_s = daq, list[str](), 0.0
        self._range_V, self._clocked = (-10.0, 10.0), (0.0, 0)
        self.is_closed = self.is_started = False
        self.ao_channels = types.SimpleNamespace(add_ao_voltage_chan=self._add)
        self.timing = types.SimpleNamespace(cfg_samp_clk_timing=self._sample)
        daq.tasks.append(self)

    def __enter__(self) -> Task:
        return self

    def __exit__(self, *_: object) -> None:
        if not self.is_closed:
            self.close()

    def _check(self) -> None:
        if self.is_closed:
            raise DaqError(NO_TASK, "Task specified is invalid or does not exist.")

    def _add(self, channel: str, min_val: float = -10.0, max_val: float = 10.0) -> None:
        self._check()
        self._channels.append(channel)
        self._range_V = min_val, max_val

    def _sample(self, rate: float, sample_mode: str, samps_per_chan: int) -> None:
        self._check()
        assert sample_mode == "finite"
        assert rate > 0
        self._clocked = self._daq.rate, self._daq.count = rate, samps_per_chan

    def start(self) -> None:
        self._check()
        if not self._channels:
            raise DaqError(NO_CHANNEL, "The specified operation cannot be performed without channels in the task.")
        for task in [task for task in self._daq.tasks if task is not self and task.is_started]:
            is_clocked = bool(task._clocked[1] or self._clocked[1])
            if self._taken(is_clocked) & task._taken(is_clocked):
                raise DaqError(RESERVED, f"The specified resource is reserved: {', '.join(self._channels)}.")
        self.is_started = True

    def _taken(self, is_clocked: bool) -> set[str]:
        return {channel.partition("/")[0] if is_clocked else channel for channel in self._channels}

    def write(self, volts: Any, auto_start: bool = False) -> int:
        self._check()
        of_channels = volts if len(self._channels) > 1 else [volts]
        assert len(of_channels) == len(self._channels), "a task takes a list for each of its channels"
        low_V, high_V = self._range_V
        for block in [each if isinstance(each, list) else [each] for each in of_channels]:
            if not all(low_V <= at_V <= high_V for at_V in block):
                raise DaqError(OUTSIDE, f"Requested value is not between {low_V} and {high_V} V.")
            assert self._clocked[1] in (0, len(block)), "the clock is for another number of samples"
        clocked = isinstance(of_channels[0], list)
        assert clocked == bool(self._clocked[1]), "a block needs a sample clock, a voltage has none"
        if auto_start and not self.is_started:
            self.start()
        assert self.is_started, "a write without auto_start puts nothing out"
        self._daq.out.append(volts)
        self._daq.holds |= dict(zip(self._channels, of_channels, strict=True))
        if clocked:
            self._ends_s = self._daq.ends = self._daq.monotonic() + self._clocked[1] / self._clocked[0]
        return len(block)

    def is_task_done(self) -> bool:
        self._check()
        return self._daq.monotonic() >= self._ends_s

    def stop(self) -> None:
        self._check()
        self._daq.stopped += self.is_started and not self.is_task_done()
        self.is_started = False

    def close(self) -> None:
        if self.is_started:
            self.stop()
        self._check()
        self.is_closed = True


class Daq(types.ModuleType):
    """The module; `out` is what was put out, `holds` by channel, `stopped` how many blocks were ended too early."""

    def __init__(self, monotonic: Callable[[], float]) -> None:
        super().__init__("nidaqmx")
        self.monotonic, self.ends, self.stopped = monotonic, 0.0, 0
        self.AcquisitionType = types.SimpleNamespace(FINITE="finite")
        self.DaqError = DaqError
        self.rate, self.count = 0.0, 0
        self.out: list[Any] = []
        self.holds: dict[str, Any] = {}
        self.tasks: list[Task] = []

    def Task(self) -> Task:
        return Task(self)

    @property
    def open_tasks(self) -> int:
        """Tasks that nobody closed."""
        return sum(not task.is_closed for task in self.tasks)
