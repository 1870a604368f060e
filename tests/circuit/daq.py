"""A substitute for nidaqmx that records its output at the pace of a given clock."""

from __future__ import annotations

import types
from collections.abc import Callable
from typing import Any


class Daq(types.ModuleType):
    """The module with its names and the arguments that players use; `out` is what was put out, in order."""

    def __init__(self, monotonic: Callable[[], float]) -> None:
        super().__init__("nidaqmx")
        self.monotonic, self.ends, self.stopped = monotonic, 0.0, 0
        self.AcquisitionType = types.SimpleNamespace(FINITE="finite")
        self.ao_channels = types.SimpleNamespace(add_ao_voltage_chan=lambda *_, **__: None)
        self.timing = types.SimpleNamespace(cfg_samp_clk_timing=self.sampled)
        self.rate, self.count = 0.0, 0
        self.out: list[Any] = []

    def Task(self) -> Daq:
        return self

    def __enter__(self) -> Daq:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def sampled(self, rate: float, sample_mode: str, samps_per_chan: int) -> None:
        self.rate, self.count = rate, samps_per_chan

    def write(self, volts: Any, auto_start: bool) -> None:
        self.out.append(volts)
        if isinstance(volts, list):
            self.ends = self.monotonic() + len(volts) / self.rate

    def is_task_done(self) -> bool:
        return self.monotonic() >= self.ends

    def stop(self) -> None:
        self.stopped += 1
