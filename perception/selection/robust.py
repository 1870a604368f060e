"""How probably one set is better than another by its worst pair, when people, contact, ambient and rig vary.

Each draw is one virtual person on one rig: contact and skin are the person's, ambient, module and heat sink are drawn
about the rig. Both sets meet the same draws and the same noise, so that what differs is the set.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..observer.people import draw_people
from .appraise import population_dprime
from .request import ChoiceError

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet

DRAWS = 100
AMBIENT_SD_K = 2.0
GAIN_SD = 0.05
SINK_SD = 0.2
"""Assumed, for want of data: a room within 2 K, a current within 5 %, a heat sink within 20 % (SD)."""
TIED = 1e-12
"""Values that differ by no more are equal."""


@dataclass(frozen=True, slots=True)
class SetComparison:
    """How probably set A is better than set B.

    Attributes
    ----------
    probability
        Share of draws in which A is better; ties count half.
    standard_error
        Standard error of `probability`.
    gain
        Median gain of A over B in the d′ of the worst pair.
    draws
        Number of persons and rigs.

    See Also
    --------
    compare_sets : Compares two sets.
    """

    probability: float
    standard_error: float
    gain: float
    draws: int

    def __repr__(self) -> str:
        return (
            f"SetComparison(P(A better) = {self.probability:.2f} ± {self.standard_error:.2f}, "
            f"median gain d′ {self.gain:+.3g}, {self.draws} draws)"
        )


def compare_sets(
    a: Sequence[Icon] | IconSet,
    b: Sequence[Icon] | IconSet,
    rig: Rig,
    *,
    draws: int = DRAWS,
    seed: int = 0,
) -> SetComparison:
    """Predict how probably set A is better than set B for a person and a rig drawn at random.

    Parameters
    ----------
    a, b
        The sets.
    rig
        The nominal rig; contact and skin are each person's, ambient, module and heat sink vary about it.
    draws
        Number of persons and rigs.
    seed
        Seed of the draws.

    Returns
    -------
    SetComparison
        The probability with its standard error, and the median gain.

    Raises
    ------
    ChoiceError
        For a set of fewer than two icons, and for no draws.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> six = read_cue("six-icons")
    >>> few = [six["cooling-step"], six["cold-to-warm"], six["warming-step"]]
    >>> compare_sets(few, six, Rig.load("thenar"), draws=8).probability
    1.0
    """
    if draws < 1:
        raise ChoiceError(f"at least one draw is needed, not {draws}")
    pool: list[Icon] = []
    for name, each in (("A", a), ("B", b)):
        if len(each) < 2:
            raise ChoiceError(f"{name} has only {len(each)} icon: at least two are needed to be distinguished")
        pool += [icon for icon in each if icon not in pool]
    crowd = draw_people(draws, seed)
    apart, _ = population_dprime(pool, rig, crowd, rigs=drawn_rigs(crowd.rigs(rig), seed))
    rows = ([pool.index(icon) for icon in each] for each in (a, b))
    first, second = (apart[:, some][:, :, some][:, *np.triu_indices(len(some), 1)].min(axis=1) for some in rows)
    gains = first - second
    p = float(np.mean(gains > TIED)) + 0.5 * float(np.mean(np.abs(gains) <= TIED))
    error = math.sqrt(max(p * (1.0 - p), 0.0) / draws)
    return SetComparison(p, error, float(np.median(gains)), draws)


def drawn_rigs(rigs: Sequence[Rig], seed: int) -> list[Rig]:
    """Each rig with ambient, gain and heat sink drawn about its own values; the n-th is always the same.

    Gain is that of the module, by its Seebeck coefficient: how much heat a current pumps. Under closed control it has
    no effect on what is played, under `replay` it acts as another current would.
    """
    streams = np.random.SeedSequence([seed, 11]).spawn(3)
    ambient, gain, sink = (np.random.default_rng(stream).standard_normal(len(rigs)) for stream in streams)
    return [
        rig.with_(
            **{
                "ambient.temperature_C": rig.ambient.temperature_C + AMBIENT_SD_K * float(np.clip(ambient[k], -2, 2)),
                **(_pump_drawn(rig, float(sink[k]), float(gain[k])) if rig.thermode is None else {}),
            }
        )
        for k, rig in enumerate(rigs)
    ]


def _pump_drawn(rig: Rig, sink: float, gain: float) -> dict[str, float]:
    """Heat sink and module with their draws; a thermode has neither."""
    return {
        "heat_sink.resistance_K_per_W": rig.heat_sink.resistance_K_per_W * math.exp(SINK_SD * sink),
        "module.seebeck_V_per_K": rig.module.seebeck_V_per_K * math.exp(GAIN_SD * gain),
    }
