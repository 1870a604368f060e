"""What stands beside a ranking in words: icons ranked apart, what lies outside the data, how icons are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .number_text import number, percent
from .tables import table

if TYPE_CHECKING:
    from rich.table import Table


def playable(icons: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the icons that are safe and reached: the others are ranked apart."""
    return [icon for icon in icons if icon["safe"] and icon["reachable"]]


def trouble_lines(icons: Sequence[dict[str, Any]], cures: Mapping[str, str]) -> list[str]:
    """Return what the rig cannot play or must not, with the cure where there is one, and one line on what is amber."""
    lines = []
    for icon in icons:
        if icon["reason"]:
            said = ["NOT SAFE"] * (not icon["safe"]) + ["not reached"] * (not icon["reachable"])
            better = f"; {cures[icon['name']]}" if icon["name"] in cures else ""
            lines.append(f"* {icon['name']} is {' and '.join(said)}: {icon['reason']}{better}")
    if lines:
        lines.append("* ranked apart; the set's numbers take these icons as the rig would play them")
    amber = [icon for icon in icons if icon["cautions"]]
    if amber:
        names = ", ".join(icon["name"] for icon in amber)
        first = f"of {amber[0]['name']}, " if len(amber) > 1 else ""
        lines.append(f"Caution, soft limit of safety passed by {names}: {first}{amber[0]['cautions'][0]}")
    return lines


def outside_lines(icons: Sequence[dict[str, Any]]) -> list[str]:
    """Return one line for each way in which icons lie outside the data, with the icons that it holds for."""
    held: dict[str, list[str]] = {}
    for icon in icons:
        for said in icon["outside_data"]:
            held.setdefault(said, []).append(icon["name"])
    every = len(icons) > 1
    return [
        f"Outside the data: {'all icons' if every and len(names) == len(icons) else ', '.join(names)}: {said}"
        for said, names in held.items()
    ]


def carried_lines(icons: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Say which icon is changed most by the one before it; nothing where all has faded."""
    carried = [(icon["carry_over"]["d_prime"], icon["name"], icon["carry_over"]["after"]) for icon in icons
               if icon["carry_over"]]  # fmt: skip
    if carried:
        d_prime, name, before = max(carried)
        again = "itself" if before == name else before
        yield f"     Carry-over: {name} feels least like itself after {again}, by d′ {number(d_prime)}"


def norm_lines(result: dict[str, Any]) -> Iterator[str]:
    """Say whether the ranking would change if a difference over time counted by another norm; nothing for one icon.

    >>> whole = {"norm_sensitivity": {"rms": 0.7}, "norm_changes": {"rms": [["a", "b"], ["a", "c"]]}}
    >>> list(norm_lines({"pairs": [{}], "set": whole}))
    ['     by the rms norm 70 % correct, and b would come before a (1 more change of order)']
    """
    whole = result["set"] if result["pairs"] else {"norm_sensitivity": {}}
    for norm, share in whole["norm_sensitivity"].items():
        changes = whole["norm_changes"][norm]
        if not changes:
            said = "in the same order"
        else:
            more = f" ({len(changes) - 1} more change{'s' * (len(changes) > 2)} of order)" if len(changes) > 1 else ""
            said = f"and {changes[0][1]} would come before {changes[0][0]}{more}"
        yield f"     by the {norm} norm {percent(share)} correct, {said}"


def asked_so(task: dict[str, Any]) -> str:
    """Return how icons are asked for, where it is not the usual way.

    >>> asked_so({"context": 0.0, "gap_s": 10.0, "bias": 0.0})
    ', 10 s from one icon to the next'
    """
    said = [f", {100 * task['context']:g} % of memory noise with the range of the set"] if task["context"] else []
    said += [] if task["gap_s"] is None else [f", {task['gap_s']:g} s from one icon to the next"]
    said += [f", names favoured by a spread of {task['bias']:g}"] if task["bias"] else []
    return "".join(said)


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
    """Return the sentences on the set: pairs told apart, the rules on the rig, the worst pair with its rules."""
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
            word = "told apart" if pair["told_apart_by_rules"] else "not told apart"
            yield f"Worst pair by rules: {pair['a']} and {pair['b']}, {word}"
            yield from (f"  - {rule['text']}" for rule in pair["rules"])
