"""``thermicon rank --by rules``: the table and the sentences, with no number of the model in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .number_text import percent
from .tables import table

if TYPE_CHECKING:
    from rich.table import Table


def rules_table(icons: Sequence[dict[str, Any]], pairs: Sequence[dict[str, Any]]) -> Table:
    """Return a row an icon: share passed, its own rules, its pairs told apart, how near the nearest is to failing."""
    made = table(
        "icon",
        "score",
        "rules passed",
        "pairs apart",
        "least margin",
        "fails",
        numbers=("score", "rules passed", "pairs apart", "least margin"),
        names=("icon", "score", "rules passed", "pairs apart", "least margin"),
    )
    for icon in icons:
        own = [rule for rule in icon["rules"] if not rule["from_model"]]
        mine = [pair for pair in pairs if icon["name"] in (pair["a"], pair["b"])]
        fails = [rule["rule"] for rule in own if not rule["pass"]]
        made.add_row(
            icon["name"],
            percent(icon["rules_score"]),
            f"{sum(rule['pass'] for rule in own)} of {len(own)}",
            f"{sum(pair['told_apart_by_rules'] for pair in mine)} of {len(mine)}" if mine else "–",
            margin(icon["rules_margin"]),
            ", ".join(fails) or "–",
        )
    return made


def margin(share: float | None) -> str:
    """Write a margin in multiples of its threshold; below none, by how much it is missed.

    >>> margin(1.79), margin(-0.25), margin(None)
    ('2.79 ×', '0.75 ×', '–')
    """
    return "–" if share is None else f"{1.0 + share:.3g} ×"


def rules_lines(result: Mapping[str, Any]) -> list[str]:
    """Return the sentences on the set: distinguishable pairs, the rules on the rig, the worst pair with its rules."""
    pairs, whole = result["pairs"], result["set"]
    lines = []
    if pairs:
        apart = sum(pair["told_apart_by_rules"] for pair in pairs)
        lines.append(f"Set: rules tell {apart} of {'1 pair' if len(pairs) == 1 else f'{len(pairs)} pairs'} apart")
    lines += [f"     {rule['text']}" for rule in whole["rules"]] if pairs else [r["text"] for r in whole["rules"]]
    if whole["worst_pair"]:
        lines += ["", *_worst(pairs, whole["worst_pair"])]
    return lines


def rules_caveat(result: Mapping[str, Any]) -> str:
    """Return the sentence that says what the score is made of and what the model was asked."""
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    crowd = "1 virtual person" if result["people"] == 1 else f"{result['people']} virtual people"
    return (
        f"Scored by rules of thumb alone on the {result['rig']} rig{what_if}: the share of rules passed, each counting "
        "the same, then the least margin, in multiples of its threshold. Rules on latency and felt peak need the model "
        f"and are not counted; it was asked ({crowd}, seed {result['seed']}) only where it disagrees."
    )


def _worst(pairs: Sequence[dict[str, Any]], names: Sequence[str]) -> Iterator[str]:
    for pair in pairs:
        if {pair["a"], pair["b"]} == set(names):
            word = "distinguishable" if pair["told_apart_by_rules"] else "not distinguishable"
            yield f"Worst pair by rules: {pair['a']} and {pair['b']}, {word}"
            yield from (f"  - {rule['text']}" for rule in pair["rules"])
