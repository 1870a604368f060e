"""Analogue outputs of one NI device as the line of several elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .element_lines import ElementLines
from .ni import NiLine


class NiElements(ElementLines):
    """A channel for each element, all in one task: an NI device has one clock for outputs, and takes no second task.

    A row is the voltage of each element, or a block of such rows with its rate in Hz. Off, each channel goes by itself.
    """

    def __init__(
        self,
        channels: Mapping[str, str],
        off_V: Mapping[str, float],
        V_per_A: Mapping[str, float],
        clock: Callable[[], float],
    ) -> None:
        super().__init__({name: NiLine(at, off_V[name], V_per_A[name]) for name, at in channels.items()}, clock)
        self._channels = tuple(channels.values())
        self._task: Any = None

    def send(self, row: Any) -> Callable[[], bool] | None:
        """Put out voltages, or a block of them."""
        import nidaqmx

        self._close()
        self._task = task = nidaqmx.Task()
        try:
            for channel in self._channels:
                task.ao_channels.add_ao_voltage_chan(channel, min_val=-10.0, max_val=10.0)
            if not isinstance(row, tuple):
                task.write([row[name] for name in self._lines], auto_start=True)
                self._close()  # the channels hold their voltages
                return None
            from nidaqmx.constants import AcquisitionType

            rows, rate_Hz = row
            task.timing.cfg_samp_clk_timing(rate_Hz, sample_mode=AcquisitionType.FINITE, samps_per_chan=len(rows))
            task.write([[each[name] for each in rows] for name in self._lines], auto_start=True)
        except BaseException:
            self._close()
            raise
        return self._is_playing

    def off(self) -> None:
        """Stop a block, and put out on each channel what leaves its display without power."""
        try:
            self._close()
        finally:
            super().off()

    def _is_playing(self) -> bool:
        """Whether a block goes on; one that is done is closed."""
        if self._task is None or self._task.is_task_done():
            self._close()
            return False
        return True

    def _close(self) -> None:
        task, self._task = self._task, None
        if task is not None:
            task.close()
