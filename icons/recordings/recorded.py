"""A recording of temperature in a CSV file as an icon: its corner points, fitted within a tolerance, as statements."""

import math
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Literal

from ..model.context import Context, name_fault
from ..model.errors import whole_file
from ..model.icon import Icon
from ..model.statements import Hold, Ramp, Rest, Return, Statement, Step
from ..model.units import fault
from .readings import CONTROL_OF, read_readings


def from_csv(
    path: str | Path,
    *,
    name: str | None = None,
    column: str | None = None,
    control: Literal["display", "skin"] = "display",
    tolerance_K: float = 0.05,
    baseline_C: float | None = None,
) -> Icon:
    r"""Return an icon that stays within a tolerance of every reading of a CSV file.

    Parameters
    ----------
    path
        A file with a column ``time_s`` (s, from any start) and one of ``temperature_C``, ``target_C``, ``setpoint_C``,
        ``display_C`` and ``skin_C`` (°C), separated by commas, semicolons or tabs. A time that occurs twice is a step.
    name
        Name of the icon; None: the name of the file.
    column
        Column to read in place of those above.
    control
        What the icon controls, unless the column is ``display_C`` or ``skin_C``.
    tolerance_K
        Largest deviation from any reading, in K.
    baseline_C
        Baseline in °C, within the tolerance of the first reading; None: the first reading.

    Returns
    -------
    Icon
        The icon, with ramps and holds in place of the readings.

    Raises
    ------
    CueErrors
        For a fault of the file, with its row.
    ValueError
        For any other argument.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "dip.csv"
    ...     _ = path.write_text("time_s,skin_C\n0,32\n2,26\n4,26.02\n6,25.98\n8,32\n")
    ...     from_csv(path).corners().value
    (32.0, 26.0, 26.0, 32.0)
    """
    if control not in ("display", "skin"):
        raise ValueError(f'control must be "display" or "skin" for a recorded temperature, not {control!r}')
    if isinstance(tolerance_K, bool) or not isinstance(tolerance_K, int | float) or not 0 < tolerance_K < math.inf:
        what = "tolerance_K (--tolerance) must be a positive temperature difference in K"
        raise ValueError(f"{what}, such as 0.05, not {tolerance_K!r}")
    if name is not None and (wrong := name_fault(name)):
        raise ValueError(f"name: {wrong}")
    if baseline_C is not None and (found := fault(float(baseline_C), "absolute")):
        raise ValueError(f"baseline_C: {found[1]}")
    read = read_readings(path, column)
    first = read.level_C[0]
    if baseline_C is not None and abs(baseline_C - first) > tolerance_K:
        what = f"the recording begins at {first:g} °C, baseline_C is {baseline_C:g} °C"
        help = f"an icon begins at baseline, here within {tolerance_K:g} K; leave baseline_C out, or cut the file"
        raise whole_file("E016", f"{read.file}:{read.first_row}", what, help)
    from .polyline import fit_corners

    try:
        corners = fit_corners(read.time_s, read.level_C, tolerance_K, baseline_C)
    except ValueError as problem:
        help = "give a larger tolerance (--tolerance, in Python tolerance_K), or smooth or cut the recording"
        raise whole_file("E220", read.file, str(problem), help) from None
    context = Context(CONTROL_OF.get(read.column) or control, corners[1][0])
    return Icon(name or _name(Path(path)), tuple(_statements(*corners)), context)


def _statements(times: Sequence[float], levels: Sequence[float]) -> Iterator[Statement]:
    baseline = levels[0]
    for (start, before), (end, after) in pairwise(zip(times, levels, strict=True)):
        duration = round(end - start, 9)
        if duration == 0:
            yield _at_once(before, after)
        elif before == after:
            yield Rest(duration) if after == baseline else Hold(duration)
        elif after == baseline:
            yield Return(duration_s=duration)
        else:
            yield Ramp("warm" if after > before else "cool", to_C=after, duration_s=duration)


def _at_once(before: float, after: float) -> Statement:
    """What a step of the recording becomes: two readings at one time. Here, and only here, that is decided."""
    return Step("warm" if after > before else "cool", to_C=after)


def _name(path: Path) -> str:
    name = re.sub(r"[\W_]+", "-", path.stem).strip("-")
    return name if not name_fault(name) else f"recorded-{name}".rstrip("-")
