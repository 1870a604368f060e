"""A synthetic laboratory: logs that a rig would give, with the noise and the offsets of real instruments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from thermicon.icons import Icon, load_library

from ..rig.rig import Rig
from ..solver.simulate import simulate
from .identify import NOISE_K, NOISE_V
from .log import Log
from .problem import OFFSET_SD_K

COLUMNS = ("display_C", "voltage_V")
DRIVE_SET, DRIVE_ICON = "calibration-drive", "calibration"


def calibration_icon() -> Icon:
    """Return the shipped calibration drive: 60 s, designed so that a log of it identifies contact and module."""
    return load_library(DRIVE_SET)[DRIVE_ICON]


def synthetic_log(
    rig: Rig,
    *,
    seed: int,
    icon: Icon | None = None,
    columns: Sequence[str] = COLUMNS,
    rate_Hz: float = 100.0,
    noise_K: float = NOISE_K,
    noise_V: float = NOISE_V,
    offset_sd_K: float = OFFSET_SD_K,
    tail_s: float = 0.0,
    name: str = "synthetic.csv",
) -> Log:
    """Return the log of a cue played on a rig, with noise; the same seed gives the same log.

    Parameters
    ----------
    rig
        The rig that stands in the laboratory.
    seed
        Seed of noise and offsets.
    icon
        The cue; None: the shipped calibration drive.
    columns
        What is measured beside the current.
    rate_Hz
        Rows per second, and updates of the driver: a log that is slower than its driver does not hold the whole drive.
    noise_K, noise_V
        Standard deviation of a reading.
    offset_sd_K
        Standard deviation of the offset of each temperature sensor, drawn once.
    tail_s
        Time in s that the log continues after the cue.
    name
        Name of the log.

    Returns
    -------
    Log
        Rows at `rate_Hz`, each with the current of its instant.

    Examples
    --------
    >>> synthetic_log(Rig.load("thenar"), seed=1)
    Log('synthetic.csv', 6001 rows, 60 s: current_A, display_C, voltage_V)
    """
    if rig.thermode is None:
        rig = rig.with_(**{"driver.update_Hz": rate_Hz})
    trace = simulate(icon or calibration_icon(), rig, rate_Hz=rate_Hz, tail_s=tail_s)
    random = np.random.default_rng(seed)
    values = {"time_s": trace.time_s, ("current_A" if trace.has_current else "setpoint_C"): (
        trace.current_A if trace.has_current else trace.target_C)}  # fmt: skip
    for column in columns:
        exact = trace.probe(column[6:-2]) if column.startswith("probe_") else getattr(trace, column)
        temperature = column.endswith("_C")
        offset = random.normal(0.0, offset_sd_K) if temperature else 0.0
        values[column] = exact + offset + random.normal(0.0, noise_K if temperature else noise_V, len(exact))
    return Log.of(name, values)


def write_log(log: Log, path: str | Path) -> None:
    """Write a log as CSV, its times and columns with six digits behind the point; NaN is an empty cell."""
    import pandas as pd

    frame = pd.DataFrame({"time_s": log.time_s, **dict(log.columns)})
    frame.to_csv(path, index=False, float_format="%.6f")
