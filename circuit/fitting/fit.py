"""Fit rig parameters to measured logs."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.cores import quiet_blas

from ..rig.faults import PARAMETERS
from ..rig.rig import AnyRig, Rig
from .forward import started
from .identify import identified, tellable
from .keys import CONTACT, FitError, FitKey, free_keys, possible_keys
from .log import Log, LogError, read_logs
from .notes import Noticed, beyond_noise, closing, disagreement, failed, far_off, late_column, remarks, unsteady
from .overlay import aligned, check_clocks, check_sensors
from .problem import OFFSET_SD_K, FitProblem, changed_layers
from .rig_fit import RigFit, channel_fits, reason_of, uncertainties
from .runs import DISPLAY, runs_of
from .solve import Solution, solve

if TYPE_CHECKING:
    import pandas as pd

LAYER_DIGITS = 5
"""Significant digits of the layers in the fitted rig."""

MOST_OFFSET_K = 10.0
"""A sensor that is off by more is broken."""


@quiet_blas()
@checked
def fit(
    logs: Log | str | Path | pd.DataFrame | Sequence[Log | str | Path | pd.DataFrame],
    rig: AnyRig = "thenar",
    *,
    free: str | Sequence[str] | None = None,
    offset_K: float = OFFSET_SD_K,
    fixed_skin: bool = False,
) -> RigFit:
    """Fit named parameters of a rig to one or several measured logs.

    Parameters
    ----------
    logs
        A log or several: a `Log`, the name of its file (see `read_logs`), or a table of pandas with the same columns. A
        log without a drive has a clock of its own and belongs to the log before it.
    rig
        The rig to begin with, or its name or file; what is not free stays as it is.
    free
        A dotted key to fit, such as `contact.resistance_m2K_per_W`, or several; None for those that logs tell together.
    offset_K
        Standard deviation in K of what every temperature sensor may read off; 0 for calibrated sensors.
    fixed_skin
        Take the layers of the skin as the rig has them, instead of fitting them along within the spread between people.

    Returns
    -------
    RigFit
        Values with 95 % intervals, correlations, what was not identified, residuals, and the fitted rig.

    Raises
    ------
    FitError
        For logs or keys that cannot be used, with file, row or column, and the cure.

    Notes
    -----
    The rig is taken as steady at the first row, under its first drive or, where the display's first reading contradicts
    that, at a level that is fitted along; its current lasts until the next row. Robust least squares (Huber, beyond
    three standard deviations) with bounds, by `scipy.optimize.least_squares`. The noise of each channel comes
    from its residuals; where neighbouring residuals are alike, because the model leaves something out, intervals are
    widened accordingly, as by the error of the skin's mesh. Intervals allow for skin that differs as it does between
    people, and hold if what else is not free is right.

    Examples
    --------
    >>> from thermicon.circuit.fitting.synthetic_log import synthetic_log
    >>> rig = Rig.load("thenar")
    >>> log = synthetic_log(rig.with_(**{"contact.resistance_m2K_per_W": 7e-4}), seed=1)
    >>> fitted = fit(log, rig, free=["contact.resistance_m2K_per_W", "module.resistance_ohm"])
    >>> fitted["contact.resistance_m2K_per_W"].identified
    True
    """
    if not (math.isfinite(offset_K) and 0 <= offset_K <= MOST_OFFSET_K):
        raise FitError(f"an offset of {offset_K:g} K is not possible for a sensor; give 0 to {MOST_OFFSET_K:g} K")
    rig, read = Rig.of(rig), _logs(logs)
    runs = runs_of(read, rig)
    alone = all(run.driven_by == DISPLAY for run in runs)
    notes = [*chain.from_iterable(log.notes for log in read), *chain.from_iterable(run.notes for run in runs)]
    runs = aligned(rig, runs)
    if free is None:
        possible = possible_keys(rig, alone)
        free = tellable(FitProblem.of(_explicit(rig, possible), possible, runs, offset_K, fixed_skin))
        if not free and not alone:
            names = ", ".join(run.name for run in runs)
            raise FitError(f"{names}: tells no key of rig {rig.name}; name keys to try them")
        free = free or (CONTACT,)  # with the outermost layer, in series
        notes.insert(0, str(Noticed("no-keys", {"keys": ", ".join(free)})))
    keys = free_keys((free,) if isinstance(free, str) else free, rig, alone)
    problem = FitProblem.of(_explicit(rig, keys), keys, runs, offset_K, fixed_skin)
    check_sensors(problem)
    solution = solve(problem)
    moving = [noticed.facts["run"] for noticed in unsteady(problem, solution.theta)]
    runs = tuple(started(rig, run, offset_K, contradicted=run.name in moving) for run in problem.runs)
    if any(run.start_C != before.start_C for run, before in zip(runs, problem.runs, strict=True)):
        problem = problem.again(problem.rig, keys, runs)
        solution = solve(problem)
    check_clocks(problem, solution.theta)
    sources = tuple((log.name, log.sha256) for log in read)
    return _result(problem, solution, rig, keys, sources, notes)


def _logs(logs: Log | str | Path | pd.DataFrame | Sequence[Log | str | Path | pd.DataFrame]) -> list[Log]:
    several = list(logs) if isinstance(logs, Sequence) and not isinstance(logs, str) else [logs]
    read = list[Log]()
    for log in several:
        read += [log] if isinstance(log, Log) else read_logs(log)
    for place, log in enumerate(read):
        for earlier in read[:place]:
            if earlier is log or (log.sha256 and (log.sha256, log.run) == (earlier.sha256, earlier.run)):
                raise LogError(
                    f"{log.name}: has the same content as {earlier.name}, given before it; counted twice, a log "
                    f"makes the intervals too narrow: name it once"
                )
    return read


def _explicit(rig: Rig, keys: Sequence[FitKey]) -> Rig:
    """The rig with its module given by parameters where one of them is free and it was given by data sheet or name."""
    ways = {"datasheet", "name"} & set(json.loads(rig.document).get("module", {}))
    if not ways or not any(key.key.removeprefix("module.") in PARAMETERS for key in keys):
        return rig
    nothing: dict[str, object] = {f"module.{way}": None for way in ways}
    return rig.with_(**nothing, **{f"module.{name}": getattr(rig.module, name) for name in PARAMETERS})


def _result(
    problem: FitProblem, solution: Solution, start: Rig, keys: tuple[FitKey, ...], sources: tuple[tuple[str, str], ...],
    notes: list[str],
) -> RigFit:  # fmt: skip
    missed = beyond_noise(problem, solution.theta, solution.inflation)
    late = late_column(problem, solution)
    mend = Noticed("late-cure") if late else failed(problem, solution.theta)
    parameters, correlation = identified(problem, solution, start, mend=str(mend or ""))
    unknown = tuple(item for item in parameters if not item.identified)
    disagreed, why = disagreement(problem, solution, missed, late, unknown)
    remarked = remarks(problem, solution.theta, misfit=why is not None)
    if far_off(problem, solution.theta):
        why = why or Noticed("sensor-why")
    misfit = why is not None
    if any(run.points for run in problem.runs):
        why = why or Noticed("points-why")
    layers = changed_layers(problem.rig, problem.factors(solution.theta))
    fitted = problem.rig.with_(
        **{key: float(f"{value:.{LAYER_DIGITS}g}") for key, value in layers.items()},
        **{item.key: item.value for item in parameters if item.identified},
    )
    measured = any(channel.column.endswith("_C") for _, _, channel in problem.channels())
    if not measured:  # a voltage alone cannot show what the rig leaves out
        notes = [*notes, str(Noticed("no-temperature"))]
    elif stated := uncertainties(keys, parameters, before=start.uncertainty, misfit=why is not None):
        changes: dict[str, object] = {f"uncertainty.{key}": value for key, value in stated.items()}
        reason = {} if why else {"uncertainty.reason": reason_of(start, sources)}
        fitted = fitted.with_(**changes, **reason)
    last = closing(problem, solution, unknown, why if measured else None, before=start, fitted=fitted)
    return RigFit(
        fitted, parameters, correlation, channel_fits(problem, solution.theta), sources,
        (*notes, *map(str, (*disagreed, *remarked, *last))), solution.converged, misfit,
        tuple(layer.name for layer in start.skin.layers) if layers else (), problem.offset_sd_K,
    )  # fmt: skip
