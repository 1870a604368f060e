"""The result of `rank`."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product
from typing import Any

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.base.results.drawn import Drawn, Tabled
from thermicon.base.words.number_text import count_of

from ..identification.carry_over import CarryOver
from ..identification.map import PerceptualMap
from ..identification.new_laboratory import NewLaboratory, interval_of
from ..identification.task import Task
from ..observer.channels import MemoryChoice, MemoryForm
from ..observer.observer_model import Crowd, ObserverModel
from .assumptions import Assumptions, assumptions_of
from .batches import Job, PooledResult
from .place import Place
from .rules_of_thumb import RuleResult
from .scores import IconScore, PairScore, counted, disagreements

PERCENTAGE_POINT = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Ranking(Drawn, Tabled):
    """A predicted experiment: icons in file order, pairs, the pooled confusion matrix, the whole set.

    Attributes
    ----------
    version
        Version of the program.
    content_hash, digests
        Hash of icons, rig and observer, and of each.
    job
        What was ranked, and how: icons, rig, seed and number of people, trials, tracking, memory, task.
    model
        The observer with its people and draws.
    felt
        Responses of all people.
    icons, pairs
        Scores, in file order.
    worst_pair
        Names of the pair that is confused most often; None for one icon.
    rules
        Rules on the rig.
    carry_over
        What each icon leaves behind for the next where there is a gap; None: nothing.
    new_laboratory
        What a new laboratory will find: people, constants and laboratory together; None: not requested.

    Raises
    ------
    ValueError
        For a confusion matrix of another shape than the icons, or whose rows do not sum to 1.

    See Also
    --------
    rank : Predicts a ranking.
    """

    version: str
    content_hash: str
    digests: dict[str, str]
    job: Job
    model: ObserverModel
    felt: PooledResult
    icons: tuple[IconScore, ...]
    pairs: tuple[PairScore, ...]
    worst_pair: tuple[str, str] | None
    rules: tuple[RuleResult, ...]
    carry_over: CarryOver | None = None
    new_laboratory: NewLaboratory | None = None

    def __post_init__(self) -> None:
        square = self.confusion.shape == (len(self.icons),) * 2
        if not square or not np.allclose(self.confusion.sum(axis=1), 1.0, rtol=0, atol=1e-12):
            raise ValueError("the confusion matrix must have one row and one column per icon, and rows that sum to 1")

    @property
    def rig(self) -> str:
        """Name of the rig, or of the layout."""
        return (self.job.layout.name or "unnamed") if self.elements else self.job.rig.name

    @property
    def elements(self) -> tuple[str, ...]:
        """Names of the elements of the layout; empty for a rig."""
        elements = self.job.layout.elements
        return tuple(element.name for element in elements) if len(elements) > 1 else ()

    @property
    def rig_changes(self) -> tuple[str, ...]:
        """Keys of the rig that were changed, such as `contact.area_cm2=4`."""
        return () if self.elements else tuple(self.job.rig.changes)

    @property
    def place(self) -> Place | None:
        """What is assumed about places; None on one element."""
        return Place.of(self)

    @property
    def seed(self) -> int:
        """Seed of the people and of all noise."""
        return self.job.seed

    @property
    def people(self) -> int:
        """Number of virtual people."""
        return self.job.people

    @property
    def tracking(self) -> str:
        """What every virtual person receives: `replay`, `display` or `ideal`."""
        from thermicon.circuit.solver.batch import usual_tracking

        return self.job.tracking or ", ".join(
            sorted({usual_tracking(icon) for _, tracks in self.job.tracks.by_rig for icon in tracks})
        )

    @property
    def memory(self) -> MemoryChoice:
        """Form of memory: `episodes`, `naming`, or `both`."""
        return self.job.memory

    @property
    def crowd(self) -> Crowd:
        """The people who feel and remember the icons."""
        return self.job.crowd(self.model)

    @property
    def task(self) -> Task:
        """The identification task."""
        return self.job.task

    @property
    def observer(self) -> str:
        """Name of the observer's file, or `shipped`."""
        return self.model.name

    @property
    def own_laboratory(self) -> bool:
        """Whether the observer's draws are those of one laboratory, which intervals are then for, not for a new one."""
        return self.model.posterior is not None and self.model.posterior.one_laboratory

    @property
    def confusion(self) -> Array:
        """Pooled probabilities (icons, icons): rows are presented, columns answered."""
        return self.felt.pooled

    @property
    def felt_and_named(self) -> float:
        """Share of plays that are felt and named correctly, 0–1: the mean over people of both for each."""
        return float(self.felt.felt_and_named.mean())

    @property
    def felt_and_named_interval(self) -> tuple[float, float]:
        """Felt and named of the middle 95 % of people."""
        return interval_of(self.felt.felt_and_named)

    @property
    def persons(self) -> tuple[float, ...]:
        """Proportion named of every virtual person, 0–1."""
        return tuple(self.felt.correct.tolist())

    @property
    def proportion_correct(self) -> float:
        """Proportion named, 0–1: the mean over people."""
        return float(self.felt.correct.mean())

    @property
    def proportion_correct_interval(self) -> tuple[float, float]:
        """Proportion named of the middle 95 % of people."""
        return interval_of(self.felt.correct)

    @property
    def information_bits(self) -> float:
        """Information, bits: the mean over people."""
        return float(self.felt.bits.mean())

    @property
    def information_bits_interval(self) -> tuple[float, float]:
        """Information of the middle 95 % of people, bits."""
        return interval_of(self.felt.bits)

    @property
    def bits_per_s(self) -> float:
        """Information over the mean length of an icon, bits per s."""
        return self.information_bits / (sum(icon.duration_s for icon in self.icons) / len(self.icons))

    @property
    def assumptions(self) -> Assumptions:
        """The most influential assumptions, where people and draws show them; of several rigs about the first."""
        crowd, elsewhere = self.model.people(self.people, self.seed), self.new_laboratory
        each = None if elsewhere is None else elsewhere.each
        return assumptions_of(self.felt.correct, crowd, self.job.tracks.by_rig[0][0], self.model.nominal, each)

    @property
    def total_s(self) -> float:
        """Time of all icons together, s."""
        return math.fsum(icon.duration_s for icon in self.icons)

    @property
    def total_J(self) -> float:
        """Energy of all icons together, J; on a thermode, which states no energy, NaN."""
        return math.fsum(icon.energy_J for icon in self.icons)

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the icons, in file order."""
        return tuple(icon.name for icon in self.icons)

    @property
    def best_first(self) -> tuple[IconScore, ...]:
        """The icons by what is felt and named; those that are not safe or not reached come last."""
        return tuple(sorted(self.icons, key=lambda icon: (not icon.playable, -icon.felt_and_named, icon.name)))

    @property
    def worst(self) -> PairScore | None:
        """The pair that is confused most often; None for one icon."""
        return next((pair for pair in self.pairs if (pair.a, pair.b) == self.worst_pair), None)

    @property
    def marked(self) -> tuple[str, ...]:
        """Names of the icons for pictures: a star behind those that are not safe or not reached."""
        return tuple(icon.name if icon.playable else f"{icon.name} *" for icon in self.icons)

    @property
    def d_prime(self) -> Array:
        """Median d′ of every pair as a matrix (icons, icons), zero on the diagonal."""
        return self.felt.middle

    @property
    def by_form(self) -> dict[MemoryForm, float]:
        """Proportion named of the set by each form of memory that counts."""
        return dict(zip(self.job.forms, self.felt.by_form.mean(axis=(1, 2)).tolist(), strict=True))

    @property
    def form_changes(self) -> tuple[tuple[str, str], ...]:
        """Pairs of icons that both forms of memory order differently: the first is better with the first form.

        Differences must exceed one percentage point in both, since smaller ones are within the sampling error.
        """
        own, *others = self.felt.by_form.mean(axis=1)
        return tuple(
            (self.labels[i], self.labels[j])
            for other, (i, j) in product(others, permutations(range(len(own)), 2))
            if own[i] > own[j] + PERCENTAGE_POINT and other[j] > other[i] + PERCENTAGE_POINT
        )

    @property
    def rules_score(self) -> float | None:
        """Share of pairs that are distinguishable by rules alone; None for one icon."""
        return sum(pair.rules_pass for pair in self.pairs) / len(self.pairs) if self.pairs else None

    @property
    def rules_disagree(self) -> tuple[dict[str, Any], ...]:
        """Disagreements of rules and model."""
        return disagreements(self.icons, self.pairs)

    def rows(self) -> list[dict[str, Any]]:
        """One plain row per icon, the best first; those that are not safe or not reached come last."""
        apart = Counter(name for pair in self.pairs if pair.rules_pass for name in (pair.a, pair.b))
        return [
            {
                "icon": icon.name,
                **({"where": ", ".join(icon.where)} if self.elements else {}),
                "proportion_correct": icon.proportion_correct,
                "felt_and_named": icon.felt_and_named,
                "detected_probability": icon.detected_probability,
                "onset_s": icon.onset_s,
                "channel": icon.channel,
                "peak_change_cold_K": icon.peak_change_K[0],
                "peak_change_warm_K": icon.peak_change_K[1],
                "rules_score": icon.rules_score,
                "rules_margin": icon.rules_margin,
                "rules_passed": sum(r.passed for r in counted(icon.rules)),
                "rules": len(counted(icon.rules)),
                "pairs_distinguishable_by_rules": apart[icon.name],
                "reachable": icon.reachable,
                "safe": icon.safe,
                "reason": icon.reason,
            }
            for icon in self.best_first
        ]

    def map(self) -> PerceptualMap:
        """The icons as points, near where they are hard to distinguish."""
        from ..identification.map import map_of

        return map_of(self)

    def to_dict(self) -> dict[str, Any]:
        """The content of `rank --json` as plain data: missing values are None, never NaN."""
        from .rank_file import ranking_file

        return ranking_file(self)

    def to_json(self) -> str:
        """The content of `rank --json` as text, the same bytes for the same arguments."""
        from .rank_file import as_text

        return as_text(self.to_dict())

    def __repr__(self) -> str:
        low, high = self.felt_and_named_interval
        where = f"{count_of(len(self.icons), 'icon')} on {with_changes(self.rig, self.rig_changes)}"
        worst = "" if self.worst_pair is None else f", worst pair {self.worst_pair[0]} and {self.worst_pair[1]}"
        crowd = count_of(self.people, "person", "people")
        spread = "" if self.people == 1 else f" [{100 * low:.0f}, {100 * high:.0f}]"
        bits = f", {self.information_bits:.2f} bits" if len(self.icons) > 1 else ""
        alert = f"{100 * self.felt_and_named:.1f} % felt and named"
        return f"Ranking(predicted: {where}, {crowd}, {alert}{spread}{bits}{worst})"


def with_changes(rig: str, changes: Sequence[str]) -> str:
    """Name of a rig with its changed keys, as in `thenar with contact.area_cm2=4`."""
    return f"{rig} with {', '.join(changes)}" if changes else rig
