"""d′ between icons of which one comes from memory, for one person and by any norm."""

from __future__ import annotations

from collections.abc import Sequence

from ..arrays import Array
from ..observer.channels import USUAL_NORM, Norm, check_norm
from ..observer.observer import Observer
from ..sensation.percept import Percept, on_one_clock
from .episodes import Episodes, episode_distances

Felt = tuple[Array, Array]
"""Sensations (icons, n_time) of cold and warm."""
Names = str | Sequence[str]


def dprimes_from_memory(
    one: Felt, other: Felt, dt_s: float, observer: Observer, norm: Norm, names: tuple[Names, Names] = ("", "")
) -> Array:
    """d′ (n, m) of every icon of one to every icon of the other, on one clock, for the nominal memory."""
    first, second = (
        Episodes.of(cold[None], warm[None], dt_s, observer, called)
        for (cold, warm), called in zip((one, other), names, strict=True)
    )
    found: Array = episode_distances(first, second, observer, norm)[0]
    return found


def dprime_from_memory(a: Percept, b: Percept, observer: Observer | None = None, norm: str = USUAL_NORM) -> float:
    """d′ of two percepts when one of them comes from memory.

    Parameters
    ----------
    a, b
        Percepts on the same clock; the shorter one is held at its end.
    observer
        The person (None: the nominal one).
    norm
        How episodes are remembered: `episodes` or `naming`.

    Returns
    -------
    float
        Distance over noise; two icons are distinguished correctly in Φ(d′/2) of trials.

    Raises
    ------
    ValueError
        For different clocks and for an unknown norm.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> from thermicon.perception import perceive
    >>> icons, rig = load_library("six-icons"), Rig.load("thenar")
    >>> step, ramp = (perceive(simulate(icons[name], rig, tail_s=10)) for name in ("cooling-step", "linear-cooling"))
    >>> dprime_from_memory(step, step), dprime_from_memory(step, ramp) > 1.5
    (0.0, True)

    """
    person, chosen = Observer.load() if observer is None else observer, check_norm(norm)
    cold, warm, dt = on_one_clock([a, b])
    one, other = ((cold[[k]], warm[[k]]) for k in (0, 1))
    names = a.icon or "", b.icon or ""
    return float(dprimes_from_memory(one, other, dt, person, chosen, names)[0, 0])
