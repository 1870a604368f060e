"""The limits that a single fault may reach."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rules import Limits, Rule
from .demands import Harm
from .exposure import cem43_min, cem43_per_min
from .tally import HOTTEST_C, WATCHED

DOSE = "thermal dose"
WIDER_K = 1.0
"""Skin and receptors may pass their hard limits by this much in a single fault, but never the published bound."""
DOSE_SHARE = 0.5
"""Share of the limit of dose that a single fault may add."""
COLUMN_OF = {
    **{"skin surface": "skin_C", "cold-receptor depth": "cold_receptor_C"},
    **{"display": "display_C", "hot plate": "hot_plate_C"},
}
"""Quantities that count in a fault, with their columns; in skin and receptors the limit is wider."""
FELT_COLUMNS = ("skin_C", "cold_receptor_C")


@dataclass(frozen=True, slots=True)
class FaultLimits:
    """What a single fault may lead to: limits of temperature and, in min CEM43, of the dose that it adds."""

    limits: Limits
    dose_min: float

    @staticmethod
    def of(limits: Limits, dose_before_min: float = 0.0) -> FaultLimits:
        """The limits of a fault in a session that has a dose already."""
        dose = next(rule for rule in limits.rules if rule.quantity == DOSE)
        most = dose.limit if dose.bound is None else dose.bound
        before_min = min(dose_before_min, dose.limit)  # more is refused for itself
        dose_min = min(DOSE_SHARE * dose.limit, most - before_min)
        wider = [_widened(rule) for rule in limits.rules if rule.always_hard and rule.quantity in COLUMN_OF]
        return FaultLimits(replace(limits, rules=(*wider, replace(dose, limit=dose_min))), dose_min)

    @property
    def temperatures(self) -> tuple[Rule, ...]:
        """The rules of temperature."""
        return self.limits.rules[:-1]

    def passed(self, values: Array, rows_s: Array, on_s: float) -> tuple[Harm | None, Array]:
        """What is passed the farthest by WATCHED (4, lanes, rows) after a fault, and by how much in each lane.

        The dose counts over the rows, and for `on_s` before them at the warmest skin. An excess is in K, or in shares
        of the dose; negative inside.
        """
        farthest, harm = np.full(values.shape[1], -np.inf), None
        for rule in self.temperatures:
            column = np.nan_to_num(values[WATCHED.index(COLUMN_OF[rule.quantity])], nan=HOTTEST_C)
            over = (column - rule.limit if rule.upper else rule.limit - column).max(axis=1)
            if over.max() > max(float(farthest.max()), 0.0):
                harm = Harm(rule.quantity, float(column.max() if rule.upper else column.min()), "°C")
            farthest = np.maximum(farthest, over)
        dose = self._dose_min(values[WATCHED.index("skin_C")], rows_s, on_s)
        beyond = dose / self.dose_min - 1.0 if self.dose_min > 0.0 else dose + 1.0
        if harm is None and beyond.max() > 0.0:
            harm = Harm(DOSE, float(dose.max()), "min CEM43")
        return harm, np.maximum(farthest, beyond)

    def _dose_min(self, skin_C: Array, rows_s: Array, on_s: float) -> Array:
        """Dose (lanes,) of skin (lanes, rows) and of a time before; computed where a bound does not suffice."""
        skin = np.clip(np.nan_to_num(skin_C, nan=HOTTEST_C), None, HOTTEST_C)
        at_most = cem43_per_min(skin.max(axis=1)) / 60.0
        dose = at_most * (on_s + rows_s[-1])
        beyond = np.flatnonzero(dose > self.dose_min)
        dose[beyond] = at_most[beyond] * on_s + cem43_min(rows_s, skin[beyond])[:, -1]
        return np.asarray(dose)


def _widened(rule: Rule) -> Rule:
    """The rule for a single fault: a kelvin wider for skin and receptors, within the published bound."""
    if COLUMN_OF[rule.quantity] not in FELT_COLUMNS:
        return rule
    limit = rule.limit + (WIDER_K if rule.upper else -WIDER_K)
    if rule.bound is not None:
        limit = min(limit, rule.bound) if rule.upper else max(limit, rule.bound)
    return replace(rule, limit=limit)
