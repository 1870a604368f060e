"""An NI analogue output as a line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


class NiLine:
    """A channel of NI-DAQmx; `off_V` leaves the display without power.

    `V_per_A` is the voltage for 1 A of current, 0 where a voltage does not stand for a current. The driver keeps a
    channel for a task that was started, also when it is done, until that is closed: use one line for each channel.
    """

    def __init__(self, channel: str, off_V: float = 0.0, V_per_A: float = 0.0) -> None:
        self._channel, self._off_V, self._V_per_A = channel, off_V, V_per_A
        self._daq: Any = None
        self._task: Any = None

    def open(self) -> None:
        """Load the driver."""
        import nidaqmx

        self._daq = nidaqmx

    def send(self, row: float | tuple[list[float], float]) -> Callable[[], bool] | None:
        """Put out a voltage, or a block of voltages with its rate in Hz."""
        self._close()
        self._task = task = self._daq.Task()
        try:
            task.ao_channels.add_ao_voltage_chan(self._channel, min_val=-10.0, max_val=10.0)
            if not isinstance(row, tuple):
                task.write(row, auto_start=True)
                self._close()  # the channel holds the voltage
                return None
            from nidaqmx.constants import AcquisitionType

            volts, rate_Hz = row
            task.timing.cfg_samp_clk_timing(rate_Hz, sample_mode=AcquisitionType.FINITE, samps_per_chan=len(volts))
            task.write(volts, auto_start=True)
        except BaseException:
            self._close()
            raise
        return self._is_playing

    def test(self, current_A: float) -> bool:
        """Put out the voltage for a current."""
        if self._V_per_A:
            self.send(current_A * self._V_per_A)
        return bool(self._V_per_A)

    def feed(self) -> None:
        """Nothing to do: an analogue output has no watchdog."""

    def status(self) -> Mapping[str, object]:
        """An analogue output says nothing."""
        return {}

    def off(self) -> None:
        """Stop a block, and put out what leaves the display without power."""
        try:
            self._close()
        finally:
            self.send(self._off_V)

    def _is_playing(self) -> bool:
        """Whether a block goes on; one that is done is closed."""
        task = self._task
        if task is None or task.is_task_done():
            self._close()
            return False
        return True

    def _close(self) -> None:
        task, self._task = self._task, None
        if task is not None:
            task.close()
