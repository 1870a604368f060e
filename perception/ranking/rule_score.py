"""A score by rules alone, and the places where rules and model judge differently.

The score is the share of rules passed, all with the same weight; among equals the one whose smallest
margin, in shares of its threshold, is larger comes first. Nothing in it comes from the model.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import decimals, significant

from ..criteria import DISTINGUISHABLE_DPRIME, FELT_FROM
from .rules import OURS, RuleResult, passes

if TYPE_CHECKING:
    from .scores import IconScore, PairScore


def counted(results: Iterable[RuleResult]) -> list[RuleResult]:
    """The results that a score by rules may use: those whose value does not come from the model."""
    return [r for r in results if not r.from_model]


def pair_margin(results: Iterable[RuleResult]) -> float | None:
    """Margin by which rules separate a pair: the largest normalised margin, since one rule suffices.

    Negative where no rule does; None where a rule without a size separates them, such as direction.
    """
    ours = [r for r in results if r.quantity in OURS]
    if any(r.passed and (r.quantity == "direction" or r.margin is None) for r in ours):
        return None
    margins = [m for r in ours if r.quantity != "direction" and (m := r.normalised_margin) is not None]
    return max(margins, default=-1.0)


def icon_score(icon: Sequence[RuleResult], pairs: Sequence[tuple[bool, float | None]]) -> tuple[float, float | None]:
    """Share passed of an icon's rules and of its pairs, and the smallest normalised margin of them.

    `pairs` holds (distinguishable, margin) of every pair it is in. Bands have no margin to compare. The margin
    is None where nothing has one.
    """
    own = counted(icon)
    passed = sum(r.passed for r in own) + sum(apart for apart, _ in pairs)
    sized = [r for r in own if r.threshold_low is None]
    margins = [r.normalised_margin for r in sized] + [margin for _, margin in pairs]
    known = [m for m in margins if m is not None]
    return passed / (len(own) + len(pairs)), min(known) if known else None


def worst_by_rules(pairs: Sequence[PairScore]) -> tuple[str, str] | None:
    """The pair with the smallest margin by rules; equal ones by how few rules pass, then by name."""

    def safety(pair: PairScore) -> tuple[bool, float, int, str, str]:
        margin = float("inf") if pair.rules_margin is None else pair.rules_margin
        return pair.rules_pass, margin, sum(r.passed for r in pair.rules), pair.a, pair.b

    if not pairs:
        return None
    first = min(pairs, key=safety)
    return first.a, first.b


def disagreements(icons: Sequence[IconScore], pairs: Sequence[PairScore]) -> tuple[dict[str, Any], ...]:
    """Icons and pairs that rules and model judge differently, with both verdicts."""
    found: list[dict[str, Any]] = []
    for icon in icons:
        rules = passes(icon.rules, "change at the receptor", "rate at the receptor")
        model = icon.detected_probability >= FELT_FROM
        if rules != model:
            shown, limit = significant(icon.detected_probability, FELT_FROM, least=2)
            word = "detectable" if rules else "not detectable"
            side = "above" if model else "below"
            text = f"{icon.name}: rules: {word}; model: {shown} detected, {side} the {limit} criterion"
            found.append({"icon": icon.name, "rules": rules, "model": model, "text": text})
    for pair in pairs:
        model = pair.d_prime >= DISTINGUISHABLE_DPRIME
        if pair.rules_pass != model:
            word = "distinguishable" if pair.rules_pass else "not distinguishable"
            side = "above" if model else "below"
            d_prime = f"{pair.d_prime:.{decimals(pair.d_prime, DISTINGUISHABLE_DPRIME, 1)}f}"
            text = (
                f"{pair.a} and {pair.b}: rules: {word}; "
                f"model: d′ {d_prime}, {side} the {DISTINGUISHABLE_DPRIME} criterion"
            )
            found.append({"a": pair.a, "b": pair.b, "rules": pair.rules_pass, "model": model, "text": text})
    return tuple(found)
