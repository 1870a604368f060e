"""TDMS: waveform channels of one clock as columns of a log, read by npTDMS."""

from __future__ import annotations

import io

import numpy as np

from ..arrays import Array
from .keys import FitError

INCREMENT, OFFSET = "wf_increment", "wf_start_offset"


def read_tdms(data: bytes, name: str) -> dict[str, Array]:
    """Return the columns of a TDMS file by channel name; times come from a channel `time_s` or from `wf_increment`.

    Raises FitError where npTDMS is not installed, and for a file without one common clock.
    """
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise FitError(
            f'{name}: TDMS needs npTDMS, which is not installed: pip install "thermicon[hardware]"'
        ) from None
    try:
        file = TdmsFile.read(io.BytesIO(data))
        channels = {channel.name: channel for group in file.groups() for channel in group.channels()}
        columns = {
            key: np.asarray(channel[:], dtype=np.float64)
            for key, channel in channels.items()
            if np.issubdtype(channel.dtype, np.number)
        }
    except Exception as problem:  # npTDMS raises whatever a broken file leads it to
        raise FitError(f"{name}: cannot be read as TDMS ({str(problem) or type(problem).__name__})") from None
    if not channels:
        raise FitError(f"{name}: cannot be read as TDMS (no channel in it); save the log again")
    if not columns:
        raise FitError(f"{name}: no channel with numbers; found {', '.join(channels) or 'no channel'}")
    lengths = {key: len(column) for key, column in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} {count}" for key, count in lengths.items())
        raise FitError(f"{name}: channels of unequal lengths ({listed} samples); save each clock as a file of its own")
    if "time_s" in columns:
        return columns
    clocks = {
        key: (channels[key].properties.get(INCREMENT), channels[key].properties.get(OFFSET, 0.0)) for key in columns
    }
    missing = [key for key, (step, _) in clocks.items() if not step]
    if missing:
        raise FitError(f"{name}: channel {missing[0]} has neither {INCREMENT} nor a channel time_s beside it")
    if len({(round(float(step), 12), float(start)) for step, start in clocks.values()}) > 1:
        raise FitError(f"{name}: channels with different {INCREMENT}; save each clock as a file of its own")
    step, start = next(iter(clocks.values()))
    count = next(iter(lengths.values()))
    return {"time_s": float(start) + float(step) * np.arange(count, dtype=np.float64), **columns}
