"""What a fit notices for the reader of its result.

Of several causes of one misfit the first is named: a column that is late and explains it all, a fit that did not come
to rest, a start that was not steady, and only then keys that are held fixed.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from thermicon.base.files.inputs import shipped_table
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import signed

from ..rig.rig import Rig
from ..rig.uncertainty import Uncertainty
from .between import MAD_TO_SD
from .identify import T95, FittedParameter
from .keys import CONTACT, free_keys, possible_keys
from .problem import FitProblem, Unknown
from .rig_fit import LARGEST, channel_fits
from .runs import Channel
from .solve import LEAST_SD, Solution, covariance_of, huber, parts_of, solve

EARLY_S, EARLY_TIMES, EARLY_NOISE, START_NOISE = 2.0, 1.2, 2.0, 3.0
"""A start that is not steady shows in the first seconds, in residuals above noise and above those of the rest; of a run
whose start is fitted along, in residuals of so many times the noise anywhere."""

FAR = 10.0
"""Residuals of so many times the log's noise are another matter than noise: nothing is known from such a fit."""

OFFSET_SDS = 3.0
"""A sensor that is off by more than this many standard deviations of OFFSET_SD_K is named."""


@dataclass(frozen=True, slots=True)
class Noticed:
    """A cause of ``data/fit-words.toml``, with the facts that its words name; as text, the sentence."""

    cause: str
    facts: Mapping[str, object] = field(default_factory=dict)

    def __str__(self) -> str:
        return str(shipped_table("fit-words.toml")[self.cause].format(**self.facts))


def disagreement(
    problem: FitProblem, solution: Solution, missed: Sequence[Noticed], late: Noticed | None,
    unknown: Sequence[FittedParameter],
) -> tuple[tuple[Noticed, ...], Noticed | None]:  # fmt: skip
    """Disagreements of rig and logs and the reason in brief; `missed` and `late` were noticed of channels."""
    if late:
        return (late,), Noticed("late-why")
    if not solution.converged:
        return (*missed, Noticed("unrested")), Noticed("unrested-why")
    if not missed:
        mended = not unknown or far_off(problem, solution.theta)  # of keys that a wrong sensor hides nothing is said
        combined = not mended and _combined(problem, solution.theta, unknown)
        return ((Noticed("combination"),), Noticed("no-match-why")) if combined else ((), None)
    if not beyond_noise(problem, solution.theta):
        return tuple(missed), Noticed("left-out-why")
    if unsteady(problem, solution.theta):
        return tuple(missed), Noticed("no-match-why")
    keys = explaining(problem, solution)
    held = Noticed("held-keys", {"keys": " or ".join(keys)}) if keys else Noticed("held-others")
    return (*missed, held), Noticed("no-match-why")


def _combined(problem: FitProblem, theta: Array, unknown: Sequence[FittedParameter]) -> bool:
    """Whether keys that are not identified matter together, so that the rig that keeps them misses the log."""
    names = {item.key for item in unknown}
    places = [k for k, key in enumerate(problem.keys) if key.key in names]
    kept = theta.copy()
    kept[places] = problem.first[places]
    return problem.predictions(kept) is None or bool(beyond_noise(problem, kept))


def remarks(problem: FitProblem, theta: Array, *, misfit: bool = False) -> tuple[Noticed, ...]:
    """Of drives, starts, sensors and clocks; with a `misfit` an offset is a consequence and no fault."""
    driver_ms = 1e3 / problem.rig.update_Hz
    noticed = [
        Noticed("points", {"run": run.name, "rows_ms": 1e3 * run.step_s, "driver_ms": driver_ms})
        for run in problem.runs
        if run.points
    ]
    noticed += unsteady(problem, theta)
    for channel, offset_K in far_off(problem, theta):
        where = {"file": channel.file, "column": channel.column}
        cause = "offset-of-misfit" if misfit else "offset"
        noticed.append(Noticed(cause, {**where, "offset": signed(offset_K, "+.2f"), "sd_K": problem.offset_sd_K}))
    for r, run in enumerate(problem.runs):
        for clock, name in enumerate(run.clocks, 1):
            shift_s = run.shifts[clock - 1] + problem.nuisance(theta, "shift", r, clock)
            drift = 1e6 * problem.nuisance(theta, "drift", r, clock)
            moved = {"shift": signed(shift_s, ".3f"), "drift": signed(drift, ".0f")}
            noticed.append(Noticed("clock", {"file": name, "run": run.name, **moved}))
    return tuple(noticed)


def far_off(problem: FitProblem, theta: Array) -> list[tuple[Channel, float]]:
    """Sensors that are off by more than they are assumed to be, with the offset in K."""
    offsets = [(channel, problem.nuisance(theta, "offset", r, c)) for r, c, channel in problem.channels()]
    return [(channel, offset) for channel, offset in offsets if abs(offset) > OFFSET_SDS * problem.offset_sd_K > 0]


def unsteady(problem: FitProblem, theta: Array) -> list[Noticed]:
    """Runs whose first seconds fit much worse than the rest, or that a start fitted along does not make fit."""
    names = []
    for part, (r, _, channel) in zip(in_noise(problem, theta), problem.channels(), strict=True):
        run = problem.runs[r]
        early = part[problem.run_time_s(theta, r, channel) < EARLY_S]
        if channel.temperature and early.size:
            usual = MAD_TO_SD * float(np.median(np.abs(part)))
            first = MAD_TO_SD * float(np.median(np.abs(early)))
            moving = run.start_C is not None and usual > START_NOISE
            if moving or first > max(EARLY_TIMES * usual, EARLY_NOISE):
                names.append(run.name)
    return [Noticed("unsteady", {"run": name, "early_s": EARLY_S}) for name in dict.fromkeys(names)]


def failed(problem: FitProblem, theta: Array) -> Noticed | None:
    """What is mended first where no interval can be trusted: a start, residuals far beyond noise, a sensor."""
    if unsteady(problem, theta):
        return Noticed("unsteady-cure")
    if any(np.sqrt(np.mean(part**2)) > FAR for part in in_noise(problem, theta) if part.size):
        return Noticed("far-off-cure")
    return Noticed("offset-cure") if far_off(problem, theta) else None


def closing(
    problem: FitProblem, solution: Solution, unknown: Sequence[FittedParameter], why: Noticed | None,
    *, before: Rig, fitted: Rig,
) -> tuple[Noticed, ...]:  # fmt: skip
    """Of the fitted rig: what it keeps and states, and `why` its uncertainty is not narrowed."""
    return (
        *_in_series(problem, solution),
        *_kept(unknown),
        *((Noticed("not-narrowed", {"why": why}),) if why else ()),
        *_too_narrow(fitted.uncertainty, before.uncertainty),
    )


def _in_series(problem: FitProblem, solution: Solution) -> tuple[Noticed, ...]:
    """Contact and outermost layer in series, which a display without a current tells best."""
    contact = [k for k, key in enumerate(problem.keys) if key.key == CONTACT]
    if not (contact and problem.alone):
        return ()
    layer, rates = problem.rig.skin.layers[0], np.zeros(len(solution.theta))
    factors, first = problem.factors(solution.theta), layer.thickness_m / layer.conductivity_W_per_mK
    outer = first * math.exp(factors.get(("thickness", 0), 0.0) - factors.get(("conductivity", 0), 0.0))
    rates[contact[0]] = math.exp(solution.theta[contact[0]])
    for k, item in enumerate(problem.unknowns):
        if item.place == 0 and item.kind in ("thickness", "conductivity"):
            rates[k] = outer if item.kind == "thickness" else -outer
    both, sd = float(rates[contact[0]]) + outer, float(np.sqrt(rates @ solution.covariance @ rates))
    facts = {"layer": layer.name, "both": both, "percent": 100 * T95 * sd / both}
    return (Noticed("in-series", facts),)


def _kept(parameters: Sequence[FittedParameter]) -> tuple[Noticed, ...]:
    """Values that the fitted rig keeps from the rig before, since the logs do not determine them."""
    values = ", ".join(f"{item.key} = {item.start:.4g} {item.unit}".rstrip() for item in parameters)
    return (Noticed("kept", {"values": values}),) if values else ()


def _too_narrow(fitted: Uncertainty, before: Uncertainty) -> tuple[Noticed, ...]:
    """Uncertainties that reached the most a rig file may state."""
    most = [
        f"{key} = {limit:g}" for key, limit in LARGEST.items() if getattr(fitted, key) == limit > getattr(before, key)
    ]
    return (Noticed("most", {"values": ", ".join(most)}),) if most else ()


BEYOND = 2.0
"""Residuals that scatter by so many times the noise are more than noise."""
WORTH, MOST_NAMED = 0.3, 2
"""Share of the sum of squares that a freed key must take away to be named; freeing several at once identifies none."""
ALIKE = 3.0
"""From so many alike neighbours on, a note says that the rig leaves something out."""
LATE_EVALUATIONS = 10
LATE_SD_S, MOST_LATE_S, LEAST_LATE_S, LATE_SDS = 1.0, 5.0, 0.01, 5.0
"""How late a column may be against others of its file (standard deviation), at most, and to be named: at least, and in
standard deviations of the delay itself."""


def beyond_noise(problem: FitProblem, theta: Array, inflation: Sequence[float] = ()) -> tuple[Noticed, ...]:
    """Channels whose residuals exceed their noise or, by the `inflation`, have a structure."""
    noticed, noises = list[Noticed](), [channel.noise for _, _, channel in problem.channels()]
    parts = in_noise(problem, theta)
    for place, (each, part) in enumerate(zip(channel_fits(problem, theta), parts, strict=True)):
        factor, where = inflation[place] if inflation else 1.0, {"file": each.file, "column": each.column}
        if each.difference.size and MAD_TO_SD * float(np.median(np.abs(part))) > BEYOND:
            cause = "beyond-noise-alike" if factor > ALIKE else "beyond-noise"
            by = {"rms": milli(each.rms, each.unit), "noise": milli(noises[place], each.unit)}
            noticed.append(Noticed(cause, {**where, **by}))
        elif factor > ALIKE:
            noticed.append(Noticed("alike", {**where, "times": math.sqrt(factor)}))
    return tuple(noticed)


def in_noise(problem: FitProblem, theta: Array) -> list[Array]:
    """Return the residuals of each channel in SDs of its noise, and of what a drive unknown between rows explains."""
    least = [max(channel.noise, LEAST_SD[channel.temperature]) for _, _, channel in problem.channels()]
    return parts_of(problem, problem.residuals(theta, least))


def late_column(problem: FitProblem, solution: Solution) -> Noticed | None:
    """The column whose delay explains the residuals best, if any; a step of Gauss and Newton tells which to fit."""
    best, noticed = np.inf, None
    for r, c, channel in problem.channels():
        if channel.clock or len(problem.runs[r].channels) == 1:
            continue
        wide = problem.with_unknown(Unknown("late", r, c, LATE_SD_S, low=-MOST_LATE_S, high=MOST_LATE_S))
        begin = np.append(solution.theta, 0.0)
        residuals, jacobian = wide.residuals(begin, solution.sigma), wide.jacobian(begin, solution.sigma)
        step = float(np.linalg.lstsq(jacobian, -residuals)[0][-1])
        if abs(step) < LATE_SDS * float(np.sqrt(covariance_of(wide, jacobian, solution.inflation)[-1, -1])):
            continue
        found = solve(wide, begin, LATE_EVALUATIONS)
        late, sd = float(found.theta[-1]), float(np.sqrt(found.covariance[-1, -1]))
        left = huber(wide.residuals(found.theta, solution.sigma))
        explained = not beyond_noise(wide, found.theta, found.inflation)
        known = problem.runs[r].unknown is None  # else columns may share no instant
        least = LEAST_LATE_S if known else problem.runs[r].step_s
        if explained and abs(late) > max(least, LATE_SDS * sd) and left < best:
            where = {"file": channel.file, "column": channel.column}
            best, side = left, "late" if late > 0 else "early"
            noticed = Noticed("late", {**where, "size_s": abs(late), "side": side})
    return noticed


def explaining(problem: FitProblem, solution: Solution) -> list[str]:
    """Fixed keys that would take away most of the sum of squares in one step of Gauss and Newton, the best first."""
    rig = problem.rig.with_(**problem.values(solution.theta))
    own = [key.key for key in problem.keys]
    others = [key.key for key in possible_keys(rig, problem.alone) if key.key not in own]
    wide = problem.again(rig, free_keys([*own, *others], rig, problem.alone), problem.runs)
    theta = np.concatenate([wide.first[: len(wide.keys)], solution.theta[len(own) :]])
    jacobian = wide.jacobian(theta, solution.sigma)
    clipped = np.clip(wide.residuals(theta, solution.sigma), -10.0, 10.0)
    usual = [*range(len(own)), *range(len(wide.keys), len(theta))]

    def left(columns: list[int]) -> float:
        step = np.linalg.lstsq(jacobian[:, columns], -clipped, rcond=None)[0]
        return float(np.square(clipped + jacobian[:, columns] @ step).sum())

    before = left(usual)
    gains = {key: 1.0 - left([*usual, len(own) + k]) / before for k, key in enumerate(others)}
    return sorted((key for key in others if gains[key] >= WORTH), key=lambda key: -gains[key])[:MOST_NAMED]


def milli(value: float, unit: str) -> str:
    """A difference in K or V in thousandths, from 1 on in the unit itself."""
    text = f"{1e3 * value:.3g} m{unit}" if abs(value) < 0.9995 else f"{value:.3g} {unit}"
    return text.replace("-", "−")
