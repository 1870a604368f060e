"""Notes beside a ranking: what cannot be played, limits of the data, the task, and what the numbers rest on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from thermicon.icons.number_text import count_of

DETECTED = (
    "Detected is the share of these people's trials that end in a report; onset is the median time of those reports, "
    "channel what most of them go by, from 50 % on."
)


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


def task_note(task: dict[str, Any]) -> str:
    """Return how the identification task differs from the default one.

    >>> task_note({"context": 0.0, "gap_s": 10.0, "bias": 0.0})
    ', 10 s between icons'
    """
    parts = [f", {100 * task['context']:g} % of memory noise from the set's range"] if task["context"] else []
    parts += [] if task["gap_s"] is None else [f", {task['gap_s']:g} s between icons"]
    parts += [f", response bias with a standard deviation of {task['bias']:g}"] if task["bias"] else []
    return "".join(parts)


def crowd_text(result: Mapping[str, Any]) -> str:
    """For how many people and on which rig, with its changes."""
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    crowd = count_of(result["people"], "virtual person", "virtual people")
    return f"{crowd} on the {result['rig']} rig{what_if}"


def caveat(result: Mapping[str, Any]) -> str:
    """Return the sentences that state what the numbers rest on and what they are not."""
    if result["by"] == "rules":
        return (
            "Scored by rules of thumb alone: the share of rules passed, equally weighted, then the smallest margin as "
            "a multiple of its threshold. Rules on latency and felt peak need the model and are not counted; the model "
            f"({crowd_text(result)}, seed {result['seed']}) only shows where it disagrees."
        )
    norm = "" if result["norm"] == "episodes" else f", {result['norm']} norm"
    return (
        f"Predicted for {crowd_text(result)} "
        f"(seed {result['seed']}, {result['tracking']} tracking{norm}{task_note(result['task'])}). "
        f"These are predictions of a model, not measurements. {DETECTED}"
    )
