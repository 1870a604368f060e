"""What stands beside a ranking in words: icons ranked apart, what lies outside the data, how icons are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from .number_text import number, percent


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
