"""Distance of two traces of sensation in d′: a norm over time, divided by noise.

At each instant the difference is d(t) = √(Δψ_cold² + Δψ_warm²), after both sensations were
smoothed by the uncertainty of a remembered onset. A norm makes one number of it: `max` its
largest value, `rms` its root mean square, `integral` its integral over time (per second).
Back to back only sensory noise limits it; from memory, memory noise is added, which is constant
in log units: ψ is about a·p·ln u far above threshold, so σ_m log units are a·p·σ_m of sensation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.channels import TRACE_NORMS, TraceNorm, trace_norm
from ..observer.observer import Observer
from ..sensation.percept import Percept

MANY, FINE_S = 8, 0.02
"""Smoothed traces of more icons are compared at this step: half of it changes a difference by less than 1 in 1,000."""


def smooth(psi: ArrayLike, dt_s: float, uncertainty_s: float) -> Array:
    """Sensation (..., n_time) blurred by a symmetric exponential of SD `uncertainty_s`; ends are held."""
    from ..kernels import kernels

    rows, shape = as_rows(psi)
    if uncertainty_s <= 0.0:
        return rows.reshape(shape).copy()
    decay = math.exp(-dt_s * math.sqrt(2.0) / uncertainty_s)
    blurred = np.empty_like(rows)

    def work(part: slice) -> None:
        kernels.blur(rows[part], decay, blurred[part])

    over_rows(work, rows.shape[0], rows.size)
    return blurred.reshape(shape)


def percept_distances(
    psi_cold: ArrayLike, psi_warm: ArrayLike, dt_s: float, observer: Observer
) -> dict[TraceNorm, Array]:
    """Differences between all icons of every person, in sensation units, for every norm.

    `psi_cold`, `psi_warm` have shape (people, icons, n_time) on one clock. Each norm gets an array
    (people, icons, icons), symmetric with a zero diagonal.
    """
    from ..kernels import kernels

    cold = smooth(psi_cold, dt_s, observer.onset_uncertainty_s)
    warm = smooth(psi_warm, dt_s, observer.onset_uncertainty_s)
    if cold.ndim != 3 or cold.shape != warm.shape:
        raise ValueError(f"sensations must have shape (people, icons, n_time), not {cold.shape} and {warm.shape}")
    people, icons, samples = cold.shape
    every = max(1, round(FINE_S / dt_s)) if icons > MANY else 1
    cold, warm = (np.ascontiguousarray(felt[..., ::every]) for felt in (cold, warm))
    step_s = dt_s * samples / cold.shape[-1]
    first, second = np.triu_indices(icons, 1)
    found = np.zeros((people, first.size, len(TRACE_NORMS)))

    def work(part: slice) -> None:
        kernels.differences(cold[part], warm[part], step_s, found[part])

    over_rows(work, people, cold.size)
    matrices: dict[TraceNorm, Array] = {}
    for k, norm in enumerate(TRACE_NORMS):
        matrix = np.zeros((people, icons, icons))
        matrix[:, first, second] = found[..., k]
        matrix[:, second, first] = found[..., k]
        matrices[norm] = matrix
    return matrices


def percept_distance(a: Percept, b: Percept, observer: Observer | None = None, norm: str = "max") -> float:
    """Distance of two percepts back to back, in sensation units.

    Parameters
    ----------
    a, b
        Percepts on the same clock; the shorter one is held at its end.
    observer
        The person (None: the nominal one).
    norm
        How the difference over time is counted: `max`, `rms` or `integral`.

    Returns
    -------
    float
        The distance, d′ of sensation, before memory noise; d′ · s by the norm `integral`.

    Raises
    ------
    ValueError
        For different clocks, and for another norm: episodes are compared from memory (`dprime_from_memory`).

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import read_cue
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> from thermicon.perception import perceive
    >>> a, b = (perceive(simulate(icons[name], rig)) for name in ("cooling-step", "warming-step"))
    >>> percept_distance(a, a), percept_distance(a, b) > 10.0
    (0.0, True)
    """
    person = Observer.load() if observer is None else observer
    chosen = trace_norm(norm)
    if chosen is None:
        raise ValueError(
            f"there is no norm {norm!r} of traces: choose one of {', '.join(TRACE_NORMS)}, or compare from memory with "
            "dprime_from_memory"
        )
    cold, warm, dt = on_one_clock([a, b])
    return float(percept_distances(cold[None], warm[None], dt, person)[chosen][0, 0, 1])


def difference_trace(a: Percept, b: Percept, observer: Observer | None = None) -> Array:
    """Signed smoothed differences a − b over time, shape (2, n_time): cold, warm."""
    person = Observer.load() if observer is None else observer
    cold, warm, dt = on_one_clock([a, b])
    smoothed = [smooth(psi, dt, person.onset_uncertainty_s) for psi in (cold, warm)]
    return np.stack([psi[0] - psi[1] for psi in smoothed])


def identification_dprime(
    difference: ArrayLike, observer: Observer, norm: TraceNorm, duration_s: float, memory: ArrayLike = 1.0
) -> Array:
    """d′ of a difference when one of the two comes from memory.

    `memory` multiplies the memory noise of this person and broadcasts against `difference`.
    """
    noise = identification_noise(observer, norm, duration_s, memory)
    found: Array = np.asarray(difference, dtype=np.float64) / noise
    return found


def identification_noise(observer: Observer, norm: TraceNorm, duration_s: float, memory: ArrayLike = 1.0) -> Array:
    """Noise in the units of a norm when one of two comes from memory, shaped as `memory`."""
    log_noise = observer.memory_noise(norm) * np.asarray(memory, dtype=np.float64)
    noise: Array = np.hypot(sensory_noise(norm, observer, duration_s), observer.a * observer.p * log_noise)
    return noise


def sensory_noise(norm: TraceNorm, observer: Observer, duration_s: float) -> float:
    """Sensory noise in the units of a norm: 1, but for the integral of correlated noise √(2τT)."""
    if norm == "integral":
        return math.sqrt(2.0 * observer.noise_correlation_s * duration_s)
    return 1.0


def memory_from_task(
    difference: float, proportion: float, observer: Observer, norm: TraceNorm, duration_s: float
) -> float:
    """Memory noise (log units) that gives `proportion` correct for a difference in a two-interval forced choice.

    The choice is correct with probability Φ(d′/√2).
    """
    noise = difference / (math.sqrt(2.0) * NormalDist().inv_cdf(proportion))
    sensory = sensory_noise(norm, observer, duration_s)
    return math.sqrt(max(noise * noise - sensory * sensory, 0.0)) / (observer.a * observer.p)


def on_one_clock(percepts: Sequence[Percept]) -> tuple[Array, Array, float]:
    """Sensations (percepts, n_time), cold and warm, and their step in s; shorter ones are held at their end."""
    dt = percepts[0].dt_s
    for each in percepts:
        if not math.isclose(each.dt_s, dt, rel_tol=1e-9):
            raise ValueError(f"percepts are on clocks of {dt:g} s and {each.dt_s:g} s: simulate all at one rate")
    n = max(each.psi_cold.size for each in percepts)
    cold = np.stack([_held(each.psi_cold, n) for each in percepts])
    warm = np.stack([_held(each.psi_warm, n) for each in percepts])
    return cold, warm, dt


def _held(psi: Array, n: int) -> Array:
    return np.concatenate([psi, np.full(n - psi.size, psi[-1])])
