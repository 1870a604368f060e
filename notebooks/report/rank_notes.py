"""Notes on a ranking: icons ranked separately, limits of the data, the task, and scores by rules of thumb."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import count_of, number, percent

from .tables import table

if TYPE_CHECKING:
    from rich.table import Table


def playable(icons: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the icons that are safe and reached; the others are ranked separately."""
    return [icon for icon in icons if icon["safe"] and icon["reachable"]]


def trouble_lines(icons: Sequence[dict[str, Any]], cures: Mapping[str, str]) -> list[str]:
    """Return one line per icon that is unsafe or not reached, with its cure, and one line on exceeded soft limits."""
    lines = []
    for icon in icons:
        if icon["reason"]:
            states = ["NOT SAFE"] * (not icon["safe"]) + ["not reached"] * (not icon["reachable"])
            cure = f"; {cures[icon['name']]}" if icon["name"] in cures else ""
            lines.append(f"* {icon['name']} is {' and '.join(states)}: {icon['reason']}{cure}")
    if lines:
        lines.append("* ranked separately; the set's numbers include these icons as the rig would play them")
    amber = [icon for icon in icons if icon["cautions"]]
    if amber:
        names = ", ".join(icon["name"] for icon in amber)
        verb = "exceed" if len(amber) > 1 else "exceeds"
        first = f"of {amber[0]['name']}, " if len(amber) > 1 else ""
        lines.append(f"Caution: {names} {verb} a soft safety limit: {first}{amber[0]['cautions'][0]}")
    return lines


def outside_lines(icons: Sequence[dict[str, Any]]) -> list[str]:
    """Return one line per way in which icons lie outside the range of the data, with the icons concerned."""
    names_by_reason: dict[str, list[str]] = {}
    for icon in icons:
        for reason in icon["outside_data"]:
            names_by_reason.setdefault(reason, []).append(icon["name"])
    every = len(icons) > 1
    return [
        f"Outside the data: {'all icons' if every and len(names) == len(icons) else ', '.join(names)}: {reason}"
        for reason, names in names_by_reason.items()
    ]


def carried_lines(icons: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Report which icon is changed most by the icon before it; nothing where all carry-over has faded."""
    carried = [(icon["carry_over"]["d_prime"], icon["name"], icon["carry_over"]["after"]) for icon in icons
               if icon["carry_over"]]  # fmt: skip
    if carried:
        d_prime, name, before = max(carried)
        after = "a first play of itself" if before == name else before
        yield f"     Carry-over: largest for {name} after {after}, d′ {number(d_prime)} from {name} alone"


def norm_lines(result: dict[str, Any]) -> Iterator[str]:
    """Report whether the order would change with another norm of memory; nothing for one icon.

    >>> whole = {"norm_sensitivity": {"naming": 0.7}, "norm_changes": {"naming": [["a", "b"], ["a", "c"]]}}
    >>> list(norm_lines({"pairs": [{}], "set": whole}))
    ['     with the naming distance: 70 % correct, b before a (1 more change of order)']
    """
    whole = result["set"] if result["pairs"] else {"norm_sensitivity": {}}
    for norm, share in whole["norm_sensitivity"].items():
        changes = whole["norm_changes"][norm]
        if not changes:
            order = "same order"
        else:
            more = f" ({count_of(len(changes) - 1, 'more change')} of order)" if len(changes) > 1 else ""
            order = f"{changes[0][1]} before {changes[0][0]}{more}"
        yield f"     with the {norm} distance: {percent(share)} correct, {order}"


def task_note(task: dict[str, Any]) -> str:
    """Return how the identification task differs from the default one.

    >>> task_note({"context": 0.0, "gap_s": 10.0, "bias": 0.0})
    ', 10 s between icons'
    """
    parts = [f", {100 * task['context']:g} % of memory noise from the set's range"] if task["context"] else []
    parts += [] if task["gap_s"] is None else [f", {task['gap_s']:g} s between icons"]
    parts += [f", response bias with a standard deviation of {task['bias']:g}"] if task["bias"] else []
    return "".join(parts)


def rules_table(icons: Sequence[dict[str, Any]], pairs: Sequence[dict[str, Any]]) -> Table:
    """Return one row per icon: share of rules passed, distinguishable pairs, and the smallest margin."""
    made = table(
        "icon",
        "score",
        "rules passed",
        "distinct pairs",
        "margin",
        "fails",
        numbers=("score", "rules passed", "distinct pairs", "margin"),
        names=("icon", "score", "rules passed", "distinct pairs", "margin"),
    )
    for icon in icons:
        rules = [rule for rule in icon["rules"] if not rule["from_model"]]
        own_pairs = [pair for pair in pairs if icon["name"] in (pair["a"], pair["b"])]
        distinct = sum(pair["distinguishable_by_rules"] for pair in own_pairs)
        fails = [rule["rule"] for rule in rules if not rule["pass"]]
        made.add_row(
            icon["name"],
            percent(icon["rules_score"]),
            f"{sum(rule['pass'] for rule in rules)} of {len(rules)}",
            f"{distinct} of {len(own_pairs)}" if own_pairs else "–",
            margin(icon["rules_margin"]),
            ", ".join(fails) or "–",
        )
    return made


def margin(share: float | None) -> str:
    """Write a margin as a multiple of its threshold; below 1, the threshold is missed.

    >>> margin(1.79), margin(-0.25), margin(None)
    ('2.79 ×', '0.75 ×', '–')
    """
    return "–" if share is None else f"{1.0 + share:.3g} ×"


def rules_lines(result: Mapping[str, Any]) -> list[str]:
    """Return the sentences on the set: distinguishable pairs, rules on the rig, and the worst pair with its rules."""
    pairs, whole = result["pairs"], result["set"]
    lines = []
    if pairs:
        apart = sum(pair["distinguishable_by_rules"] for pair in pairs)
        lines.append(f"Set: {apart} of {count_of(len(pairs), 'pair')} distinguishable by the rules")
    lines += [f"     {rule['text']}" for rule in whole["rules"]] if pairs else [r["text"] for r in whole["rules"]]
    if whole["worst_pair"]:
        lines += ["", *_worst(pairs, whole["worst_pair"])]
    return lines


def rules_caveat(result: Mapping[str, Any]) -> str:
    """Return the sentence that explains the score and what the model was used for."""
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    crowd = count_of(result["people"], "virtual person", "virtual people")
    return (
        f"Scored by rules of thumb alone on the {result['rig']} rig{what_if}: the share of rules passed, equally "
        "weighted, then the smallest margin as a multiple of its threshold. Rules on latency and felt peak need the "
        f"model and are not counted; the model ({crowd}, seed {result['seed']}) only shows where it disagrees."
    )


def _worst(pairs: Sequence[dict[str, Any]], names: Sequence[str]) -> Iterator[str]:
    for pair in pairs:
        if {pair["a"], pair["b"]} == set(names):
            word = "distinguishable" if pair["distinguishable_by_rules"] else "not distinguishable"
            yield f"Worst pair by rules: {pair['a']} and {pair['b']}, {word}"
            yield from (f"  - {rule['text']}" for rule in pair["rules"])
