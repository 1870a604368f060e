"""What a log will identify, before it is measured: expected intervals for each choice of sensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thermicon.icons import Icon

from ..rig.rig import Rig
from .identify import NOISE_K, NOISE_V, SHORT, expected_sd, half_width, is_identified, with_channels
from .keys import FitKey, free_keys
from .laboratory import calibration_icon, synthetic_log
from .problem import OFFSET_SD_K, Problem
from .runs import runs_of

if TYPE_CHECKING:
    import pandas as pd

CHOICES = (
    ("display_C",),
    ("display_C", "voltage_V"),
    ("display_C", "voltage_V", "hot_plate_C"),
    ("display_C", "skin_C"),
    ("display_C", "voltage_V", "hot_plate_C", "skin_C"),
)
"""Sets of sensors, the least first."""

THERMODE_CHOICES = (("display_C",), ("display_C", "skin_C"))


@dataclass(frozen=True, slots=True)
class Expected:
    """Half widths of the 95 % intervals to expect, one for each key, with some sensors."""

    columns: tuple[str, ...]
    keys: tuple[FitKey, ...]
    half_widths: tuple[float, ...]
    identified: tuple[bool, ...]

    @property
    def sensors(self) -> str:
        """The sensors as people say them."""
        return " + ".join(SHORT[column] for column in self.columns)


def plan(
    rig: Rig,
    free: Sequence[str],
    *,
    icon: Icon | None = None,
    rate_Hz: float = 10.0,
    noise_K: float = NOISE_K,
    noise_V: float = NOISE_V,
    offset_K: float = OFFSET_SD_K,
    fixed_skin: bool = False,
) -> tuple[Expected, ...]:
    """Return how well each choice of sensors will identify parameters of a rig.

    Parameters
    ----------
    rig
        The rig as far as it is known.
    free
        Keys to fit.
    icon
        The cue to be played; None: the shipped calibration drive.
    rate_Hz
        Rows of the log per second.
    noise_K, noise_V
        Standard deviation of a reading.
    offset_K
        Standard deviation of a temperature sensor's offset.
    fixed_skin
        Take the layers of the skin as known, instead of spread as between people.

    Returns
    -------
    tuple of Expected
        One for each choice of sensors, the least first.

    Raises
    ------
    FitError
        For a key that cannot be fitted.

    Notes
    -----
    From the curvature of the sum of squares at the rig as given, with white noise: what is left out of the rig adds to
    it.

    Examples
    --------
    >>> expected = plan(Rig.load("thenar"), ["contact.resistance_m2K_per_W"])
    >>> expected[0].half_widths[0] > expected[1].half_widths[0]
    True
    """
    keys = free_keys(free, rig)
    log = synthetic_log(
        rig, seed=0, icon=icon or calibration_icon(), columns=["display_C"], noise_K=0.0, offset_sd_K=0.0,
        rate_Hz=rate_Hz,
    )  # fmt: skip
    problem = Problem.of(rig, keys, runs_of([log], rig, False), offset_sd_K=offset_K, fixed_skin=fixed_skin)
    choices = CHOICES if rig.thermode is None else THERMODE_CHOICES
    return tuple(_expected(problem, columns, noise_K, noise_V) for columns in choices)


def _expected(problem: Problem, columns: tuple[str, ...], noise_K: float, noise_V: float) -> Expected:
    sd = expected_sd(with_channels(problem, problem.first, columns, only=True), problem.first, noise_K, noise_V)
    return Expected(
        columns, problem.keys,
        tuple(half_width(key.log, float(value)) for key, value in zip(problem.keys, sd, strict=True)),
        tuple(is_identified(key.log, float(value), key.usual) for key, value in zip(problem.keys, sd, strict=True)),
    )  # fmt: skip


def plan_frame(expected: Sequence[Expected]) -> pd.DataFrame:
    """Return a plan as a table: a row per choice of sensors, a column per key with half widths."""
    import pandas as pd

    rows = [
        {"sensors": each.sensors, **{key.key: w for key, w in zip(each.keys, each.half_widths, strict=True)}}
        for each in expected
    ]
    return pd.DataFrame(rows)
