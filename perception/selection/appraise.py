"""A set in a few numbers, by the chain of `rank` without reasons and intervals, and how probably one beats another.

For that comparison each draw is one virtual person on one rig: contact and skin are the person's, ambient, module and
heat sink are drawn about the rig. Both sets meet the same draws and the same noise, so that what differs is the set.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..identification.measures import information_bits, proportion_correct
from ..identification.population import (
    RATE_HZ,
    PopulationResponse,
    ReceptorTemperatures,
    identify,
    memory_dprime,
    respond,
    run_end_s,
)
from ..identification.task import USUAL, Task
from ..observer.channels import USUAL_NORM
from ..observer.observer import Norm, Observer
from ..observer.people import People, draw_people
from .request import ChoiceError, Objective

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet

REACHED_BY = 0.95
"""Share of people who reach what a set is also judged by."""
DRAWS = 100
AMBIENT_SD_K = 2.0
GAIN_SD = 0.05
SINK_SD = 0.2
"""Assumed, for want of data: a room within 2 K, a current within 5 %, a heat sink within 20 % (SD)."""
TIED = 1e-12
"""Values that differ by no more are equal."""


@dataclass(frozen=True, slots=True)
class Appraisal:
    """One set at its own range: the worst pair by median d′, proportion correct, bits, and bits per second.

    `reached` is the proportion correct that 95 % of people reach.
    """

    worst_pair: tuple[str, str]
    d_prime: float
    proportion_correct: float
    information_bits: float
    bits_per_s: float
    reached: float

    def value(self, objective: Objective) -> float:
        """The number that an objective goes by."""
        return {
            "worst": self.d_prime,
            "correct": self.proportion_correct,
            "bits": self.information_bits,
            "bits-per-s": self.bits_per_s,
        }[objective]

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "worst_pair": list(self.worst_pair),
            "d_prime": self.d_prime,
            "proportion_correct": self.proportion_correct,
            "information_bits": self.information_bits,
            "bits_per_s": self.bits_per_s,
        }


def appraise(
    icons: Sequence[Icon],
    rig: Rig,
    *,
    people: int | People = 200,
    seed: int = 0,
    tracking: str | None = None,
    norm: Norm = USUAL_NORM,
    task: Task = USUAL,
    observer: Observer | None = None,
) -> Appraisal:
    """Predict how well people identify two or more icons, with the same people and noise as `rank`.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> six = read_cue("six-icons")
    >>> appraise([six["cooling-step"], six["warming-step"]], Rig.load("thenar"), people=4).worst_pair
    ('cooling-step', 'warming-step')
    """
    if len(icons) < 2:
        raise ValueError("at least two icons are needed to be distinguished")
    crowd = draw_people(people, seed) if isinstance(people, int) else people
    nominal = Observer.load() if observer is None else observer
    felt, durations = population_response(icons, rig, crowd, tracking, observer=nominal)
    d_prime, named = identify(felt, norm, crowd, nominal, seed, task=task)
    each, bits = proportion_correct(named.probability), float(information_bits(named.probability).mean())
    middle = np.median(d_prime, axis=0)
    a, b = nearest_two(middle)
    return Appraisal(
        worst_pair=(icons[a].name, icons[b].name),
        d_prime=float(middle[a, b]),
        proportion_correct=float(each.mean()),
        information_bits=bits,
        bits_per_s=bits / float(np.mean(durations)),
        reached=float(np.quantile(each, 1.0 - REACHED_BY)),
    )


def nearest_two(distances: Array) -> tuple[int, int]:
    """Places of the nearest pair, in rising order, the first of equal ones."""
    first, second = np.triu_indices(len(distances), 1)
    k = int(distances[first, second].argmin())
    return int(first[k]), int(second[k])


def population_dprime(
    icons: Sequence[Icon],
    rig: Rig,
    crowd: People,
    tracking: str | None = None,
    norm: Norm = USUAL_NORM,
    *,
    rigs: Sequence[Rig] | None = None,
    end_s: float | None = None,
    task: Task = USUAL,
    observer: Observer | None = None,
) -> tuple[Array, Array]:
    """Pairwise d′ (people, icons, icons) from memory and durations (s) of the icons.

    `rigs` are those of the people (None: the rig with each person's contact and skin).
    """
    nominal = Observer.load() if observer is None else observer
    felt, durations = population_response(icons, rig, crowd, tracking, rigs=rigs, end_s=end_s, observer=nominal)
    return memory_dprime(felt, norm, crowd.memory, nominal, task), durations


def population_response(
    icons: Sequence[Icon],
    rig: Rig,
    crowd: People,
    tracking: str | None = None,
    *,
    rigs: Sequence[Rig] | None = None,
    rate_Hz: float = RATE_HZ,
    end_s: float | None = None,
    observer: Observer,
) -> tuple[PopulationResponse, Array]:
    """What every person feels of every icon, and durations (s) of the icons; arguments as for `population_dprime`."""
    from thermicon.circuit.solver.simulate import duration_s

    durations = np.array([duration_s(icon, rig) for icon in icons])
    end = run_end_s(durations.tolist(), rate_Hz) if end_s is None else end_s
    each = crowd.rigs(rig) if rigs is None else rigs
    played = ReceptorTemperatures.simulated(icons, each, rig, end, rate_Hz, tracking)
    return respond(played, crowd, observer, detection=False), durations


@dataclass(frozen=True, slots=True)
class SetComparison:
    """How probably set A is better than set B by its worst pair: the share of `draws` of a person and a rig.

    Ties count half; `gain` is the median gain of A over B in the d′ of the worst pair.
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
    """Predict how probably set A is better than set B for a person and a rig drawn at random about a nominal rig.

    A `ChoiceError` for a set of fewer than two icons, and for no draws.

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
    drawn = []
    for k, rig in enumerate(rigs):
        changes = {
            "ambient.temperature_C": rig.ambient.temperature_C + AMBIENT_SD_K * float(np.clip(ambient[k], -2, 2))
        }
        if rig.thermode is None:  # which has neither heat sink nor module of its own
            changes |= {
                "heat_sink.resistance_K_per_W": rig.heat_sink.resistance_K_per_W * math.exp(SINK_SD * float(sink[k])),
                "module.seebeck_V_per_K": rig.module.seebeck_V_per_K * math.exp(GAIN_SD * float(gain[k])),
            }
        drawn.append(rig.with_(**changes))
    return drawn
