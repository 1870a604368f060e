"""Fit rig parameters to measured logs."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..cores import quiet_blas
from ..rig.keyunits import unit_of
from ..rig.modules import PARAMETERS
from ..rig.rig import Rig
from .checks import aligned, check_clocks, check_sensors, far_off, remarks, unsteady
from .identify import T95, Parameter, cures, is_identified
from .keys import CONTACT, FitError, FitKey, free_keys, value_of
from .left_out import beyond_noise, left_out
from .log import Log, LogError
from .log_files import read_log
from .problem import FREE_START, OFFSET_SD_K, STEADY, STEADY_BEFORE, Problem
from .rig_file import LARGEST, reason_of, uncertainties
from .rig_fit import ChannelFit, RigFit
from .runs import runs_of
from .skin_layers import CONDUCTIVITY, THICKNESS, changed_layers
from .solve import Solution, fits_better, solve

BOUND = 1e-3
"""A parameter within this share of its room from a bound is at the bound."""

LAYER_DIGITS = 5
"""Significant digits of the layers in the fitted rig."""

NOT_NARROWED = (
    "the rig does not match the logs within their noise and what sensors are assumed to be off, so that the "
    "uncertainty which the safety gate relies on is not narrowed by this fit"
)
MOST_OFFSET_K = 10.0
"""A sensor that is off by more is broken."""


@quiet_blas()
def fit(
    logs: Log | str | Path | Sequence[Log | str | Path],
    rig: Rig,
    *,
    free: Sequence[str],
    held: bool | None = None,
    fit_start: bool = False,
    offset_K: float = OFFSET_SD_K,
    fixed_skin: bool = False,
) -> RigFit:
    """Fit named parameters of a rig to one or several measured logs.

    Parameters
    ----------
    logs
        Logs or names of files (see `read_log`). A log without a drive has a clock of its own and belongs to the log
        before it.
    rig
        The rig to begin with; what is not free stays as it is.
    free
        Dotted keys to fit, such as `contact.resistance_m2K_per_W`.
    held
        Whether the drive of a row lasts until the next row (True), or is linear between rows (False); None: whichever
        fits the logs better.
    fit_start
        Fit the state at the first row as well; otherwise the rig is taken as steady there, under the first row's drive
        or the one before it.
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
    Robust least squares (Huber, beyond three standard deviations) with bounds, by `scipy.optimize.least_squares`. The
    noise of each channel comes from its residuals; where neighbouring residuals are alike, because the model leaves
    something out, intervals are widened accordingly, as by the error of the skin's mesh. Intervals allow for skin that
    differs as it does between people, and hold if what else is not free is right.

    Examples
    --------
    >>> from thermicon.circuit.fitting.laboratory import synthetic_log
    >>> rig = Rig.load("thenar")
    >>> log = synthetic_log(rig.with_(**{"contact.resistance_m2K_per_W": 7e-4}), seed=1)
    >>> fitted = fit(log, rig, free=["contact.resistance_m2K_per_W", "module.resistance_ohm"])
    >>> fitted["contact.resistance_m2K_per_W"].identified
    True
    """
    if not (math.isfinite(offset_K) and 0 <= offset_K <= MOST_OFFSET_K):
        raise FitError(f"an offset of {offset_K:g} K is not possible for a sensor; give 0 to {MOST_OFFSET_K:g} K")
    keys = free_keys(free, rig)
    read = _logs(logs)
    begin = _explicit(rig, keys)
    runs = runs_of(read, begin, held is not False)

    def begun(start_count: int) -> Problem:
        return aligned(Problem.of(begin, keys, runs, start_count, offset_K, fixed_skin))

    problem = begun(FREE_START if fit_start else STEADY)
    check_sensors(problem)
    problem, solution = _solved(problem, held)
    if not fit_start and unsteady(problem, solution.theta):
        # As in a trace, whose first row has the drive from then on: steady it was under the drive before.
        other, found = _solved(begun(STEADY_BEFORE), held)
        if not unsteady(other, found.theta):
            problem, solution = other, found
    check_clocks(problem, solution.theta)
    sources = tuple((log.name, log.sha256) for log in read)
    notes = [note for log in read for note in log.notes]
    return _result(problem, solution, rig, keys, sources, notes)


def _solved(problem: Problem, held: bool | None) -> tuple[Problem, Solution]:
    """The solution of a problem, and of its variant with a linear drive where that fits better and is open."""
    solution = solve(problem)
    if held is None:
        linear = replace(problem, runs=tuple(replace(run, held=False) for run in problem.runs), _kept={})
        if fits_better(linear, problem, solution):
            return linear, solve(linear, solution.theta)
    return problem, solution


def _logs(logs: Log | str | Path | Sequence[Log | str | Path]) -> list[Log]:
    several = [logs] if isinstance(logs, Log | str | Path) else list(logs)
    read = [log if isinstance(log, Log) else read_log(log) for log in several]
    for place, log in enumerate(read):
        for earlier in read[:place]:
            if earlier is log or (log.sha256 and log.sha256 == earlier.sha256):
                raise LogError(
                    f"{log.name}: has the same content as {earlier.name}, given before it; counted twice, a log "
                    f"makes the intervals too narrow: name it once"
                )
    return read


def _explicit(rig: Rig, keys: Sequence[FitKey]) -> Rig:
    """The rig with its module given by parameters where one of them is free and it was given by data sheet or name."""
    table = json.loads(rig.document).get("module", {})
    if not any(key.key.removeprefix("module.") in PARAMETERS for key in keys) or not {"datasheet", "name"} & set(table):
        return rig
    nothing: dict[str, object] = {f"module.{way}": None for way in ("datasheet", "name", "extraction") if way in table}
    return rig.with_(**nothing, **{f"module.{name}": getattr(rig.module, name) for name in PARAMETERS})


def _result(
    problem: Problem, solution: Solution, start: Rig, keys: tuple[FitKey, ...], sources: tuple[tuple[str, str], ...],
    notes: list[str],
) -> RigFit:  # fmt: skip
    count = len(keys)
    deviation = np.sqrt(np.diag(solution.covariance)[:count])
    correlation = solution.covariance[:count, :count] / np.outer(deviation, deviation)
    sure = [
        is_identified(key.log, float(sd), key.usual) and not _at_bound(problem, solution.theta, k)
        for k, (key, sd) in enumerate(zip(keys, deviation, strict=True))
    ]
    advice = cures(problem, solution.theta, [k for k, known in enumerate(sure) if not known], correlation)
    parameters = tuple(
        _parameter(start, key, float(solution.theta[k]), float(deviation[k]), sure[k], advice.get(k, ""))
        for k, key in enumerate(keys)
    )
    noise = left_out(problem, solution)
    stopped = () if solution.converged else ("the fit did not come to rest; free fewer keys",)
    unknown = tuple(item for item in parameters if not item.identified)
    kept = _without(problem, solution, unknown) if unknown and not noise else ()
    remarked = remarks(problem, solution.theta, misfit=bool(noise or kept or stopped))
    misfit = bool(noise or kept or stopped or far_off(problem, solution.theta))
    layers = changed_layers(problem.rig, problem.factors(solution.theta))
    fitted = problem.rig.with_(
        **{key: float(f"{value:.{LAYER_DIGITS}g}") for key, value in layers.items()},
        **{item.key: item.value for item in parameters if item.identified},
    )
    measured = any(channel.column.endswith("_C") for _, _, channel in problem.channels())
    skin = start.bench_load is None
    if not measured:  # a voltage alone cannot show what the rig leaves out
        notes = [*notes, "no temperature was logged: the uncertainty of the rig stays what it was"]
    elif stated := uncertainties(keys, parameters, before=start.uncertainty, skin=skin, misfit=misfit):
        changes: dict[str, object] = {f"uncertainty.{key}": value for key, value in stated.items()}
        reason = {} if misfit else {"uncertainty.reason": reason_of(start, sources)}
        fitted = fitted.with_(**changes, **reason)
    closing = (
        *_kept_sentences(unknown),
        *((NOT_NARROWED,) if misfit and measured else ()),
        *_too_narrow(fitted, start),
    )
    return RigFit(
        fitted, parameters, correlation, channel_fits(problem, solution.theta), sources,
        (*notes, *noise, *kept, *stopped, *remarked, *closing), solution.converged, misfit,
        tuple(layer.name for layer in start.skin.layers) if layers else (), _in_series(problem, solution),
    )  # fmt: skip


def _in_series(problem: Problem, solution: Solution) -> Parameter | None:
    """Contact and outermost layer in series; None where one of them is not fitted."""
    names: list[object] = [key.key for key in problem.keys]
    names += [(item.kind, item.place) for item in problem.nuisances]
    wanted = (CONTACT, (THICKNESS, 0), (CONDUCTIVITY, 0))
    if any(each not in names for each in wanted):
        return None
    places = [names.index(each) for each in wanted]
    layer, rig = problem.rig.skin.layers[0], problem.rig
    contact, thicker, better = np.exp(solution.theta[places])
    before = layer.thickness_m / layer.conductivity_W_per_mK
    above = before * thicker / better
    total, slope = contact + above, np.array([contact, above, -above])
    half = math.exp(T95 * math.sqrt(slope @ solution.covariance[np.ix_(places, places)] @ slope) / total)
    start = rig.contact.resistance_m2K_per_W + before
    return Parameter(
        f"contact + {layer.name}", f"contact and {layer.name} in series", unit_of(CONTACT), start, float(total),
        float(total / half), float(total * half), True, True,
    )  # fmt: skip


def _without(problem: Problem, solution: Solution, unknown: Sequence[Parameter]) -> tuple[str, ...]:
    """A sentence where keys that are not identified matter together, so that the rig that keeps them misses the log."""
    theta, names = solution.theta.copy(), {item.key for item in unknown}
    for k, key in enumerate(problem.keys):
        if key.key in names:
            theta[k] = problem.first[k]
    if problem.predictions(theta) is not None and not beyond_noise(problem, theta):
        return ()
    return (
        "the logs need another combination of the keys that are not identified, and the rig that keeps their values "
        "misses the logs by more than their noise: leave one of them out of the free keys",
    )


def _too_narrow(fitted: Rig, start: Rig) -> tuple[str, ...]:
    """A sentence on uncertainties that reached the most a rig file may state."""
    most = [
        f"{key} = {limit:g}"
        for key, limit in LARGEST.items()
        if getattr(fitted.uncertainty, key) == limit > getattr(start.uncertainty, key)
    ]
    if not most:
        return ()
    return (f"{', '.join(most)} is the most that a rig file may state, and too narrow here; do not export from it",)


def _kept_sentences(unknown: Sequence[Parameter]) -> tuple[str, ...]:
    """What the fitted rig keeps, since the logs do not say it."""
    if not unknown:
        return ()
    values = ", ".join(f"{item.key} = {item.start:.4g} {item.unit}".rstrip() for item in unknown)
    return (f"not identified, so that the fitted rig keeps value and uncertainty of the rig before: {values}",)


def _at_bound(problem: Problem, theta: Array, place: int) -> bool:
    room = problem.high[place] - problem.low[place]
    low = theta[place] - problem.low[place] < BOUND * room and not problem.keys[place].key.endswith("lag_s")
    return bool(low or problem.high[place] - theta[place] < BOUND * room)


def _parameter(rig: Rig, key: FitKey, place: float, sd: float, identified: bool, cure: str) -> Parameter:
    ends = (place - T95 * sd, place, place + T95 * sd)
    low, value, high = (math.exp(min(end, 500.0)) for end in ends) if key.log else ends
    if key.key.endswith("lag_s"):
        low = max(low, 0.0)
    start = value_of(rig, key.key)
    assert start is not None
    return Parameter(key.key, key.words, unit_of(key.key), start, value, low, high, key.log, identified, cure)


def channel_fits(problem: Problem, theta: Array) -> tuple[ChannelFit, ...]:
    """Return every channel beside the simulation at a point, on the clock of its run's drive."""
    found = problem.predictions(theta)
    assert found is not None
    fits = []
    for r, c, channel in problem.channels():
        inside = problem.inside(theta, r, channel)
        measured = channel.values[inside]
        fitted = problem.modelled(theta, r, c, found[r])[inside]
        time, offset = problem.run_time_s(theta, r, channel)[inside], problem.nuisance(theta, "offset", r, c)
        unit, run = "K" if channel.temperature else "V", problem.runs[r].name
        fits.append(ChannelFit(channel.column, time, measured, fitted, run, channel.file, unit, offset))
    return tuple(fits)
