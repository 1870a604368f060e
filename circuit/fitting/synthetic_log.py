"""A synthetic laboratory: the noisy logs that a rig would give."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.icons import Icon, load_library

from ..rig.rig import Rig
from ..solver.simulate import simulate
from .identify import NOISE_K, NOISE_V, expected_sd, half_width, tellable, with_channels
from .keys import FitError, FitKey, free_keys, possible_keys
from .log import Log
from .problem import OFFSET_SD_K, FitProblem
from .runs import runs_of

CHOICES = (
    ("display_C",),
    ("display_C", "voltage_V"),
    ("display_C", "voltage_V", "hot_plate_C"),
    ("display_C", "skin_C"),
    ("display_C", "voltage_V", "hot_plate_C", "skin_C"),
)
"""Sets of sensors, the least first."""

PLAN_HZ = 10.0


def calibration_icon() -> Icon:
    """Return the shipped calibration drive: 60 s, designed so that a log of it identifies contact and module."""
    return load_library("calibration-drive")["calibration"]


def synthetic_log(
    rig: Rig,
    *,
    seed: int,
    columns: Sequence[str] = ("display_C", "voltage_V"),
    rate_Hz: float = 100.0,
    noise_K: float = NOISE_K,
    offset_sd_K: float = OFFSET_SD_K,
    name: str = "synthetic.csv",
) -> Log:
    """The log of the calibration drive on a rig, `rate_Hz` that of rows and updates, with SDs of noise and zeros."""
    trace = simulate(calibration_icon(), rig.with_(**{"driver.update_Hz": rate_Hz}), rate_Hz=rate_Hz)
    random = np.random.default_rng(seed)
    values = {"time_s": trace.time_s, "current_A": trace.current_A}
    for column in columns:
        exact = trace.probe(column[6:-2]) if column.startswith("probe_") else getattr(trace, column)
        temperature = column.endswith("_C")
        offset = random.normal(0.0, offset_sd_K) if temperature else 0.0
        values[column] = exact + offset + random.normal(0.0, noise_K if temperature else NOISE_V, len(exact))
    return Log.of(name, values)


def write_log(log: Log, path: str | Path) -> None:
    """Write a log as CSV, its times and columns with six digits behind the point; NaN is an empty cell."""
    import pandas as pd

    frame = pd.DataFrame({"time_s": log.time_s, **dict(log.columns)})
    frame.to_csv(path, index=False, float_format="%.6f")


@dataclass(frozen=True, slots=True)
class Forecast:
    """Half widths of the 95 % intervals to expect, one for each key, with some sensors."""

    columns: tuple[str, ...]
    keys: tuple[FitKey, ...]
    half_widths: tuple[float, ...]
    identified: tuple[bool, ...]


def plan(
    rig: Rig, free: Sequence[str] | None = None, *, offset_K: float = OFFSET_SD_K, fixed_skin: bool = False
) -> tuple[Forecast, ...]:
    """Predicted precision of keys for each choice of sensors, the fewest first, with a module's calibration drive.

    From the curvature of the sum of squares, with ten rows a second of white noise: what the rig lacks adds to it.
    """
    if rig.thermode is not None:
        raise FitError(f"rig {rig.name} is a thermode, and a plan is of the calibration drive of a module")
    rig = rig.with_(**{"driver.update_Hz": PLAN_HZ})  # so that the drive is known
    log = synthetic_log(rig, seed=0, columns=["display_C"], noise_K=0.0, offset_sd_K=0.0, rate_Hz=PLAN_HZ)
    runs = runs_of([log])
    if free is None:
        problem = FitProblem.of(rig, possible_keys(rig), runs, offset_K, fixed_skin)
        free = tellable(with_channels(problem, problem.first, CHOICES[-1], only=True))
    problem = FitProblem.of(rig, free_keys(free, rig), runs, offset_K, fixed_skin)
    found = []
    for columns in CHOICES:
        deviations = expected_sd(with_channels(problem, problem.first, columns, only=True), problem.first).tolist()
        widths = tuple(half_width(key.log, sd) for key, sd in zip(problem.keys, deviations, strict=True))
        known = tuple(width < key.usual for key, width in zip(problem.keys, widths, strict=True))
        found.append(Forecast(columns, problem.keys, widths, known))
    return tuple(found)
