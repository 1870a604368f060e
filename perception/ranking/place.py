"""Assumptions about place in a ranking of icons on elements apart.

Nothing is assumed about place itself. What else people do meanwhile costs a lapse, which is reported beside the
prediction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from thermicon.base.files.records import Record, load_records

from ..observer.observer import DATA

if TYPE_CHECKING:
    from .ranking import Ranking

SIDES = 2
"""Names in the published tasks."""


@dataclass(frozen=True, slots=True)
class TaskCost:
    """The share of right names that was published for people who did something else as well.

    `lapse` is the share of trials (0–1) with any name that turns `predicted`, what the same people name of two sides
    that they never confuse, into it; `named` what they would then name of this set.
    """

    published: Record
    predicted: float
    lapse: float
    named: float


@dataclass(frozen=True, slots=True)
class Place:
    """What a ranking assumes about places: `elements` apart, a `lapse` (0–1) that the layout names, costs of tasks."""

    elements: tuple[str, ...]
    lapse: float
    costs: tuple[TaskCost, ...]

    @classmethod
    def of(cls, ranking: Ranking) -> Place | None:
        """That of a ranking; None on one element. Costs are reported for two elements whose layout names no lapse."""
        if not ranking.elements:
            return None
        layout, costs = ranking.job.layout, list[TaskCost]()
        predicted = 1.0 - float(ranking.model.people(ranking.people, ranking.seed).lapse.mean()) * (1.0 - 1.0 / SIDES)
        for each in load_records(DATA / "tasks.toml") if len(ranking.elements) == SIDES and not layout.lapse else ():
            lapse = max((predicted - each.central) / (predicted - 1.0 / SIDES), 0.0)
            named = (1.0 - lapse) * ranking.proportion_correct + lapse / len(ranking.icons)
            costs.append(TaskCost(each, predicted, lapse, named))
        return cls(ranking.elements, layout.lapse, tuple(costs))

    @property
    def text(self) -> str:
        """The sentence of a report."""
        apart = "place: the elements are apart, so nothing about place is assumed"
        if self.lapse:
            return f"{apart}; a lapse of {100.0 * self.lapse:.3g} % of trials, for what else people do, is in it"
        return f"{apart}; what driving costs is not in it"

    def to_dict(self) -> dict[str, Any]:
        """The keys of the ranking file."""
        costs = [
            {"task": each.published.quantity, "published": each.published.central, "source": each.published.source,
             "predicted": each.predicted, "lapse": each.lapse, "proportion_correct": each.named}
            for each in self.costs
        ]  # fmt: skip
        return {"elements": list(self.elements), "surfaces": "apart", "lapse": self.lapse, "costs": costs}
