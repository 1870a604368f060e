"""Goals for a set of icons in a few words.

A goal has one or more parts, joined by commas: ``felt-and-named >= 90 % for 95 % of people, time <= 10 s``.
Rankings are judged by it in `thermicon.perception.selection.goal_result`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.words.near_words import did_you_mean

from ..criteria import FELT_FROM
from .request import Objective

GRAMMAR = r"""
start: part ("," part)*
part: WORD COMPARISON NUMBER [UNIT] [people]  -> number
    | WORD NUMBER                             -> exactly
    | WORD WORD                               -> verdict
    | NUMBER [UNIT] WORD [people]             -> stated
people: "for" NUMBER "%" "of" "people"
COMPARISON: ">=" | "<=" | "≥" | "≤" | "=" | ">" | "<"
NUMBER: /[-−]?[0-9]+(\.[0-9]+)?/
UNIT.2: /%|(ms|min|s|mJ|kJ|J|bits?)(?![a-z_])/
WORD: /(?!for\b)[a-z_][a-z_'′-]*/
%ignore /\s+/
"""
EXAMPLE = "felt-and-named >= 90 % for 95 % of people, time <= 10 s, safety green"
CORRECT = "correct"
"""The word for `named` that published experiments use, where it is known that an icon was played."""
SPACED = re.compile(r"\bfelt +and +named\b")


class GoalError(InputError):
    """A goal cannot be read, or its parts contradict each other; the text says where, and what would be right."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """The quantity of a goal's part: its comparison, units as factors to the unit of its value, bounds, an example."""

    comparison: str
    units: Mapping[str, float]
    least: float
    most: float
    people: bool
    meaning: str
    example: str


SHARE = {"%": 0.01, "": 1.0}
SECONDS = {"s": 1.0, "ms": 1e-3, "min": 60.0}
BITS = {"bits": 1.0, "bit": 1.0, "": 1.0}
JOULES = {"J": 1.0, "mJ": 1e-3, "kJ": 1e3}
QUANTITIES: Mapping[str, Quantity] = {
    "felt_and_named": Quantity(
        ">=", SHARE, 0.0, 1.0, True, "share of plays that are felt and named correctly", "felt-and-named >= 90 %"
    ),
    "named": Quantity(
        ">=", SHARE, 0.0, 1.0, True, "share of announced icons that are named correctly", "named >= 90 %"
    ),
    "detected": Quantity(">=", SHARE, 0.0, 1.0, True, "detection of the icon detected least", "detected >= 95 %"),
    "bits": Quantity(">=", BITS, 0.0, 20.0, True, "information of the set", "bits >= 2"),
    "d_prime": Quantity(">=", {"": 1.0}, 0.0, 20.0, False, "median d′ of the worst pair", "d_prime >= 2.5"),
    "time": Quantity("<=", SECONDS, 0.0, math.inf, False, "duration of all icons together", "time <= 10 s"),
    "energy": Quantity("<=", JOULES, 0.0, math.inf, False, "energy of all icons together", "energy <= 5 J"),
    "onset": Quantity("<=", SECONDS, 0.0, math.inf, False, "onset of the icon that is felt last", "onset <= 1.5 s"),
    "count": Quantity(">=", {"": 1.0}, 2.0, 10_000.0, False, "number of icons that can be played", "count 6"),
}
NEEDS_DRAWS = (
    "a goal for a share of people is about people and the uncertainty of the model together, and needs draws of the "
    "posterior: ask for 2 or more, and use an observer that has draws"
)
SAFETY = "safety"
OF_SETS = ("felt_and_named", "named", "bits", "d_prime")
VERDICTS = ("green", "amber")
"""Green: no finding at all; amber: no hard limit is passed."""


@dataclass(frozen=True, slots=True)
class GoalPart:
    """One part: a quantity with its limit in SI units or as a share, for a share of people (None: for their mean).

    For `safety`, `limit` is the place in `VERDICTS`.
    """

    quantity: str
    limit: float
    people: float | None = None

    @property
    def at_most(self) -> bool:
        """Whether the value may be at most the limit, rather than at least."""
        return self.quantity == SAFETY or QUANTITIES[self.quantity].comparison == "<="

    def margin(self, value: Any) -> Any:
        """By what share of its limit a value (or an array) is on the right side of it: 0 at the limit, below: missed.

        >>> part = Goal.parse("time <= 10 s").parts[0]
        >>> part.margin(8.0), part.margin(12.5)
        (0.2, -0.25)
        """
        gap = self.limit - value if self.at_most else value - self.limit
        return gap / self.limit if self.limit else gap

    @property
    def whose(self) -> str:
        """The share of people in words; empty for their mean."""
        return "" if self.people is None else f" for {100.0 * self.people:g} % of people"

    @property
    def unit(self) -> str:
        """The unit that its limit is written in; empty for a pure number, and for safety."""
        return "" if self.quantity == SAFETY else next(iter(QUANTITIES[self.quantity].units))

    @property
    def text(self) -> str:
        """The part in canonical form."""
        if self.quantity == SAFETY:
            return f"{SAFETY} {VERDICTS[int(self.limit)]}"
        known = QUANTITIES[self.quantity]
        value = f"{self.limit / known.units[self.unit]:g} {self.unit}".rstrip()
        return f"{word_of(self.quantity)} {known.comparison} {value}{self.whose}"


@checked
@dataclass(frozen=True, slots=True)
class Goal:
    """A goal for a set of icons.

    Attributes
    ----------
    parts
        Its parts, about different quantities or shares of people, in the order in which they were given.

    See Also
    --------
    search : Looks for a set that meets a goal.

    Examples
    --------
    >>> goal = Goal.parse("90 % felt and named for 95 % of people, safety green")
    >>> goal.parts[0].limit, goal.parts[0].people
    (0.9, 0.95)
    """

    parts: tuple[GoalPart, ...]

    def __post_init__(self) -> None:
        seen: dict[tuple[str, float | None], GoalPart] = {}
        for part in self.parts:
            other = seen.setdefault((part.quantity, part.people), part)
            if other is not part and other.limit == part.limit:
                raise GoalError(f"goal: {other.text!r} stands twice: leave one out")
            if other is not part:
                kept = (min if part.at_most else max)((other, part), key=lambda each: each.limit).text
                same = f"{other.text!r} and {part.text!r} limit the same quantity"
                raise GoalError(f"goal: {same}: keep the stricter, {kept!r}")

    @classmethod
    @checked
    def parse(cls, text: str) -> Goal:
        """Read a goal: parts joined by commas; a `GoalError` says what cannot be read, and where.

        A part is a quantity (`felt-and-named`, `named`, `detected`, `bits`, `d_prime`, `time`, `energy`, `onset`,
        `count`), its comparison, a number with its unit, and for the first four `for N % of people`; or number, unit
        and quantity, as in `90 % felt-and-named`; or `safety green`, `safety amber`. `correct` is read as `named`.
        """
        from lark import Lark
        from lark.exceptions import UnexpectedInput

        text = SPACED.sub("felt-and-named", text)
        try:
            tree = Lark(GRAMMAR, parser="lalr", propagate_positions=True).parse(text)
        except UnexpectedInput as problem:
            raise GoalError(_where(text, problem)) from None
        return cls(tuple(_part(k, text, part) for k, part in enumerate(tree.children, 1)))

    def of(self, quantity: str) -> float | None:
        """Limit of a quantity, where the goal has one; the strictest of several."""
        limits = [part.limit for part in self.parts if part.quantity == quantity]
        if not limits:
            return None
        return max(limits) if quantity != SAFETY and QUANTITIES[quantity].comparison == ">=" else min(limits)

    @property
    def of_sets(self) -> tuple[GoalPart, ...]:
        """Parts that depend on which icons are together, or on single people; the others bind icons and totals."""
        return tuple(part for part in self.parts if part.quantity in OF_SETS or part.people is not None)

    @property
    def objective(self) -> Objective:
        """What a choice maximises where margins are equal: the worst pair, unless it asks for shares or bits."""
        words: dict[str, Objective] = {"felt_and_named": "felt-and-named", "named": "named", "bits": "bits"}
        return next((word for name, word in words.items() if self.of(name) is not None), "worst")

    @property
    def least_detected(self) -> float | None:
        """How often each icon must be detected, mean over people, to be chosen; None: the goal does not say."""
        means = [part.limit for part in self.parts if part.quantity == "detected" and part.people is None]
        # Half of people may reach a limit that their mean misses.
        asked = self.of("detected")
        return max(means) if means else None if asked is None else min(FELT_FROM, asked)

    @property
    def totals(self) -> tuple[float | None, float | None]:
        """Most time in s and most energy in J of all icons together; None: any."""
        return self.of("time"), self.of("energy")

    def check_count(self, count: int | None) -> None:
        """Raise a GoalError where fewer icons are chosen than the goal asks for."""
        least = self.of("count")
        if count is not None and least is not None and count < least:
            raise GoalError(
                f"goal: it asks for {least:g} icons or more, and {count} are to be chosen: choose {least:g}, or write "
                f"count {count}"
            )

    def check_draws(self, draws: int) -> None:
        """Raise a GoalError for a goal for a share of people without draws of the posterior to judge it by."""
        if any(part.people is not None for part in self.parts) and not draws:
            raise GoalError(NEEDS_DRAWS).to(parameters=128)

    @property
    def text(self) -> str:
        """The goal in canonical form."""
        return ", ".join(part.text for part in self.parts)

    def __repr__(self) -> str:
        return f"Goal({self.text})"


def word_of(quantity: str) -> str:
    """The word of a goal for a quantity.

    >>> word_of("felt_and_named"), word_of("d_prime")
    ('felt-and-named', 'd_prime')
    """
    return quantity if quantity == "d_prime" else quantity.replace("_", "-")


def other_word(goal: str) -> str | None:
    """What `correct` in the text of a goal is read as, and what may be meant; None where it does not say so."""
    if not re.search(rf"\b{CORRECT}(?![a-z])", goal):
        return None
    return f"{CORRECT} is read as named, for which a play that is not felt is no miss; for that write felt-and-named"


def _part(number: int, text: str, tree: Any) -> GoalPart:
    where = f"goal, part {number} {text[tree.meta.start_pos : tree.meta.end_pos]!r}"
    name = quantity_of(str(tree.children[2 if tree.data == "stated" else 0]))
    if name == SAFETY:
        wanted = str(tree.children[1]) if tree.data == "verdict" else ""
        if wanted not in VERDICTS:
            raise GoalError(f"{where}: safety is {' or '.join(VERDICTS)}, such as 'safety green'")
        return GoalPart(SAFETY, float(VERDICTS.index(wanted)))
    if name not in QUANTITIES:
        raise GoalError(
            f"{where}: there is no quantity {name!r}: {did_you_mean(name, {*map(word_of, QUANTITIES), SAFETY})}"
        )
    known = QUANTITIES[name]
    if tree.data == "verdict" or (tree.data == "exactly" and name != "count"):
        raise GoalError(f"{where}: {word_of(name)} needs a comparison and a number, such as '{known.example}'")
    comparison, value, unit, people = _pieces(tree)
    if comparison is not None and comparison != known.comparison:
        raise GoalError(
            f"{where}: {word_of(name)} ({known.meaning}) is wanted {known.comparison} a number, not {comparison}"
        )
    if unit not in known.units:
        units = " or ".join(each or "no unit" for each in known.units)
        raise GoalError(f"{where}: {word_of(name)} is given in {units}, not {unit or 'without a unit'}")
    if unit == "%" and 0.0 < value < 1.0:
        raise GoalError(
            f"{where}: {value:g} % is next to nothing: write {100.0 * value:g} %, or {value:g} without unit"
        )
    limit = round(value * known.units[unit], 12)
    if name == "count" and limit != int(limit):
        raise GoalError(f"{where}: count is a whole number of icons")
    if not known.least <= limit <= known.most or not limit > 0.0:
        first = next(iter(known.units))
        low, high = (f"{end / known.units[first]:g} {first}".rstrip() for end in (known.least, known.most))
        lies = (
            f"must be above {low}" if math.isinf(known.most) else f"lies in {low.removesuffix(first).strip()} to {high}"
        )
        cure = f": write it as {value:g} %" if unit == "" and "%" in known.units and value <= 100.0 else ""
        raise GoalError(f"{where}: {word_of(name)} {lies}{cure}")
    if people is not None and not known.people:
        raise GoalError(f"{where}: {word_of(name)} is the same for all people: leave out 'for ... of people'")
    if people is not None and not 0.5 <= people < 1.0:
        raise GoalError(f"{where}: a goal is set for 50 % of people or more, and less than 100 %")
    return GoalPart(name, limit, people)


def quantity_of(word: str) -> str:
    """The quantity that a word names, here or in `sweep`.

    >>> quantity_of("felt-and-named"), quantity_of("d′"), quantity_of("correct_95")
    ('felt_and_named', 'd_prime', 'named_95')
    """
    name = word.replace("-", "_").replace("d'", "d_prime").replace("d′", "d_prime")
    return re.sub(rf"^{CORRECT}(?![a-z])", "named", name)


def _pieces(tree: Any) -> tuple[str | None, float, str, float | None]:
    """Comparison, number, unit and share of people of a part; a count may be said to be equal to a number."""
    if tree.data == "exactly":
        return None, _number(tree.children[1]), "", None
    if tree.data == "stated":  # 90 % correct for 95 % of people
        number, unit, name, people = tree.children
        comparison = QUANTITIES[quantity_of(str(name))].comparison
    else:
        name, comparison, number, unit, people = tree.children
    signs = {"≥": ">=", ">": ">=", "≤": "<=", "<": "<=", "=": ">=" if name == "count" else "="}
    share = None if people is None else _number(people.children[0]) / 100.0
    return signs.get(str(comparison), str(comparison)), _number(number), str(unit or ""), share


def _number(token: Any) -> float:
    return float(str(token).replace("−", "-"))


def _where(text: str, problem: Any) -> str:
    place, token = getattr(problem, "pos_in_stream", None), getattr(problem, "token", None)
    if comma := re.search(r"\d,\d", text):
        return f"goal: {comma[0]!r} is not a number; write {comma[0].replace(',', '.')}, with a decimal point"
    if place is None or not 0 <= place < len(text) or (token is not None and token.type == "$END"):
        if text.rstrip().endswith(","):
            return "goal: it ends with a comma: leave it out, or add another part such as 'safety green'"
        return f"goal, part {text.rpartition(',')[2].strip()!r}: it ends too early: write it such as {EXAMPLE!r}"
    part, here = text[text.rfind(",", 0, place) + 1 :].partition(",")[0].strip(), text[place:].partition(",")[0][:12]
    return f"goal, part {part!r}: {here or ','!r} cannot be read: write it such as {EXAMPLE!r}"
