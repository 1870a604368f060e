"""An NI analogue output as a line: single voltages, or blocks clocked by the hardware."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any


class NiLine:
    """A channel of NI-DAQmx; `off_V` leaves the display without power, `measured_C` returns its temperature in °C."""

    def __init__(self, channel: str, off_V: float = 0.0, measured_C: Callable[[], float] | None = None) -> None:
        self._channel, self._off_V, self._measured_C = channel, off_V, measured_C
        self._block = ExitStack()
        self._daq: Any = None

    def open(self) -> None:
        """Load the driver."""
        import nidaqmx

        self._daq = nidaqmx

    def send(self, row: float | tuple[list[float], float]) -> Callable[[], bool] | None:
        """Put out a voltage, or a block of voltages with its rate in Hz."""
        self._block.close()
        with ExitStack() as tasks:
            task: Any = tasks.enter_context(self._daq.Task())
            task.ao_channels.add_ao_voltage_chan(self._channel, min_val=-10.0, max_val=10.0)
            if not isinstance(row, tuple):
                task.write(row, auto_start=True)
                return None
            from nidaqmx.constants import AcquisitionType

            volts, rate_Hz = row
            task.timing.cfg_samp_clk_timing(rate_Hz, sample_mode=AcquisitionType.FINITE, samps_per_chan=len(volts))
            task.write(volts, auto_start=True)
            tasks.callback(task.stop)
            self._block = tasks.pop_all()
        return lambda: not task.is_task_done()

    def read(self) -> float | None:
        """Ask the function of the user."""
        return None if self._measured_C is None else float(self._measured_C())

    def off(self) -> None:
        """Stop a block, and put out what leaves the display without power."""
        try:
            self._block.close()
        finally:
            self.send(self._off_V)
