"""The result of a goal.

A part without people is about their mean. One for a share of people is about people and uncertainty of the model
together: the value that this share of (draw, person) pairs reaches, a person being one of a new laboratory.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import listed

from ..ranking.batches import FeltResult
from ..ranking.ranking import Ranking
from .goal import SAFETY, VERDICTS, Goal, GoalPart
from .pool import Pool

if TYPE_CHECKING:
    from .choose import Choice

TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class SetOutcome:
    """The scores by which goals are judged: of a set, its icons, and its people.

    `names` of all icons; `felt_and_named`, `named` and `bits` are means over people, `d_prime` that of the nearest
    pair; `each_felt_and_named`, `detected`, `onset_s` (NaN: not felt), `durations_s` and `energies_J` (NaN on a
    thermode, which states none) of every icon.
    `worst_pair` is confused most, `nearest_pair` has the smallest d′ (None: one icon). `amber` and `red` pass a soft
    and a hard limit of safety; `unreached` icons are no matter of safety, which judges what the rig plays of them.
    `persons` has values of `felt_and_named`, `named`, `detected` (of the icon detected least) and `bits` for single
    people (n,), of all draws together; it is empty without draws.
    """

    names: tuple[str, ...]
    felt_and_named: float
    named: float
    bits: float
    d_prime: float
    each_felt_and_named: Array
    detected: Array
    onset_s: Array
    durations_s: Array
    energies_J: Array
    worst_pair: tuple[str, str] | None
    nearest_pair: tuple[str, str] | None
    amber: tuple[str, ...]
    red: tuple[str, ...]
    persons: dict[str, Array]
    unreached: tuple[str, ...] = ()

    @classmethod
    def of(cls, ranking: Ranking) -> SetOutcome:
        """What a goal for the whole set is judged by."""
        icons, felt = ranking.icons, ranking.felt
        nearest = min(ranking.pairs, key=lambda pair: pair.d_prime, default=None)
        worst = min(ranking.pairs, key=lambda pair: (-pair.confused_probability, pair.a, pair.b), default=None)
        return cls(
            names=ranking.labels,
            felt_and_named=ranking.felt_and_named,
            named=ranking.proportion_correct,
            bits=ranking.information_bits,
            d_prime=math.nan if nearest is None else nearest.d_prime,
            each_felt_and_named=np.array([icon.felt_and_named for icon in icons]),
            detected=felt.detected,
            onset_s=felt.detection.onset_s,
            durations_s=np.array([icon.duration_s for icon in icons]),
            energies_J=np.array([icon.energy_J for icon in icons]),
            worst_pair=None if worst is None else (worst.a, worst.b),
            nearest_pair=None if nearest is None else (nearest.a, nearest.b),
            amber=tuple(icon.name for icon in icons if icon.safe and icon.cautions),
            red=tuple(icon.name for icon in icons if not icon.safe),
            persons={} if ranking.new_laboratory is None else ranking.new_laboratory.persons,
            unreached=tuple(icon.name for icon in icons if not icon.reachable),
        )

    @classmethod
    def of_pool(cls, pool: Pool, felt: FeltResult) -> SetOutcome:
        """Scores of choices out of a pool of which nobody named all icons."""
        names, energies_J = tuple(icon.name for icon in pool.icons), pool.energies_J
        unknown = np.full(len(names), math.nan)
        where = unknown, felt.detected, felt.detection.onset_s, pool.durations_s, energies_J
        return cls(names, math.nan, math.nan, math.nan, math.nan, *where, None, None, pool.amber, (), {})

    def of_choice(self, choice: Choice) -> SetOutcome:
        """The same for the chosen icons alone, as a set of their own."""
        places, own = [self.names.index(name) for name in choice.icons], choice.at_own_range
        return SetOutcome(
            names=choice.icons,
            felt_and_named=own.felt_and_named,
            named=own.proportion_correct,
            bits=own.information_bits,
            d_prime=own.d_prime,
            each_felt_and_named=own.each_felt_and_named,
            detected=self.detected[places],
            onset_s=self.onset_s[places],
            durations_s=self.durations_s[places],
            energies_J=self.energies_J[places],
            worst_pair=own.worst_pair,
            nearest_pair=own.worst_pair,
            amber=tuple(name for name in self.amber if name in choice.icons),
            red=(),
            persons={} if choice.new_laboratory is None else choice.new_laboratory.persons,
        )


@dataclass(frozen=True, slots=True)
class GoalPartResult:
    """One part with the value that was predicted, in the unit of its limit; None where there is none."""

    part: GoalPart
    value: float | None
    met: bool
    binding: str

    @property
    def margin(self) -> float:
        """By what share of its limit the part is met; below 0: missed."""
        return -math.inf if self.value is None else float(self.part.margin(self.value))

    @property
    def verdict(self) -> str | None:
        """The colour of safety; None for other parts."""
        return (*VERDICTS, "red")[int(self.value)] if self.part.quantity == SAFETY and self.value is not None else None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`; of safety, value and limit are words."""
        wanted = VERDICTS[int(self.part.limit)] if self.part.quantity == SAFETY else self.part.limit
        return {"text": self.part.text, "met": self.met, "value": self.verdict or self.value, "wanted": wanted}


@dataclass(frozen=True, slots=True)
class GoalResult:
    """A goal with its parts judged.

    `unreached` icons are judged as the rig would play them.
    """

    goal: Goal
    parts: tuple[GoalPartResult, ...]
    unreached: tuple[str, ...] = ()

    @property
    def met(self) -> bool:
        """Whether every part is met."""
        return all(each.met for each in self.parts)

    @property
    def margin(self) -> float:
        """The least margin of its parts."""
        return min(each.margin for each in self.parts)

    @property
    def binding(self) -> tuple[str, ...]:
        """Obstacles to the parts that are not met, each once."""
        return tuple(dict.fromkeys(each.binding for each in self.parts if not each.met))

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`."""
        return {
            "text": self.goal.text,
            "met": self.met,
            "parts": [each.to_dict() for each in self.parts],
            "binding": list(self.binding),
            "not_reached": list(self.unreached),
        }

    def __repr__(self) -> str:
        return f"GoalResult({self.goal.text}: {'met' if self.met else 'not met'})"


@checked
def judge_goal(goal: Goal | str, found: Ranking | SetOutcome, choice: Choice | None = None) -> GoalResult:
    """Judge every part of a goal for a whole ranking, or for a choice out of it as a set of its own.

    Parameters
    ----------
    goal
        The goal, or its text, such as ``"correct >= 90 %, safety green"``.
    found
        The ranking.
    choice
        A choice out of it; None: the whole set.

    Returns
    -------
    GoalResult
        Whether each part is met, and what binds where one is not.

    Raises
    ------
    GoalError
        For a text that is not a goal, and for a share of people where ranking or choice have no draws.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> judge_goal("correct >= 50 %, safety green", ranking).met
    True
    """
    wanted = Goal.parse(goal) if isinstance(goal, str) else goal
    outcome = found if isinstance(found, SetOutcome) else SetOutcome.of(found)
    outcome = outcome if choice is None else outcome.of_choice(choice)
    wanted.check_draws(len(outcome.persons))
    return GoalResult(wanted, tuple(_judged(part, outcome) for part in wanted.parts), outcome.unreached)


def _judged(part: GoalPart, outcome: SetOutcome) -> GoalPartResult:
    value = _value(part, outcome)
    met = value <= part.limit + TOLERANCE if part.at_most else value >= part.limit - TOLERANCE
    return GoalPartResult(part, None if math.isnan(value) else value, met, "" if met else _binding(part, outcome))


def _value(part: GoalPart, outcome: SetOutcome) -> float:
    if part.people is not None:
        return float(np.quantile(outcome.persons[part.quantity], 1.0 - part.people))
    return {
        "felt_and_named": lambda: outcome.felt_and_named,
        "named": lambda: outcome.named,
        "bits": lambda: outcome.bits,
        "d_prime": lambda: outcome.d_prime,
        "detected": lambda: float(outcome.detected.min()),
        "onset": lambda: float(outcome.onset_s.max()),
        "time": lambda: math.fsum(outcome.durations_s),
        "energy": lambda: math.fsum(outcome.energies_J),
        "count": lambda: float(len(outcome.names) - len({*outcome.red, *outcome.unreached})),
        SAFETY: lambda: 2.0 if outcome.red else 1.0 if outcome.amber else 0.0,
    }[part.quantity]()


def _binding(part: GoalPart, outcome: SetOutcome) -> str:
    """The obstacle: a pair, an icon, or those that cannot be played."""
    if part.quantity == SAFETY:
        names = (*outcome.red, *outcome.amber)
        return f"{listed(names)} {'is' if len(names) == 1 else 'are'} not green"
    if part.quantity == "count":
        lost = [name for name in outcome.names if name in outcome.red or name in outcome.unreached]
        return f"{listed(lost)} cannot be played" if lost else "the set has fewer icons"
    if part.quantity == "felt_and_named":
        worst = int(outcome.each_felt_and_named.argmin())
        share = outcome.detected[worst]
        named = outcome.each_felt_and_named[worst] / max(share, 1e-9)
        if 1.0 - share > 1.0 - named:  # more plays are not felt than misnamed
            return f"{outcome.names[worst]} is felt in {100.0 * share:.0f} % of plays"
    if part.quantity in ("felt_and_named", "named", "bits", "d_prime"):
        apart = part.quantity == "d_prime"
        if (pair := outcome.nearest_pair if apart else outcome.worst_pair) is None:
            return "there is one icon only"
        return f"{pair[0]} and {pair[1]} {'have the smallest d′' if apart else 'are confused most'}"
    if part.quantity == "detected":
        return f"{outcome.names[int(outcome.detected.argmin())]} is detected least"
    if part.quantity == "onset":
        late = np.where(np.isnan(outcome.onset_s), np.inf, outcome.onset_s)
        name = outcome.names[int(late.argmax())]
        return f"{name} is not felt" if np.isinf(late.max()) else f"{name} is felt last"
    largest = outcome.durations_s if part.quantity == "time" else outcome.energies_J
    if np.isnan(largest).any():
        return "a thermode states no energy"
    return f"{outcome.names[int(largest.argmax())]} takes most {part.quantity}"
