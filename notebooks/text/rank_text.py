"""What ``rank`` prints: the table of icons, the set, the worst pair with its reasons and edits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from .byrules import rules_caveat, rules_lines, rules_table
from .choices import choice_lines
from .number_text import number, percent, seconds
from .rank_notes import asked_so, carried_lines, norm_lines, outside_lines, playable, trouble_lines
from .tables import show, table

MOST_DISAGREEMENTS, MOST_EDITS, SAME_DPRIME = 5, 20, 0.05


def show_ranking(result: dict[str, Any], order: Sequence[str], title: str, cures: Mapping[str, str]) -> None:
    """Print what ``rank --json`` holds: a row an icon in this order, the set, the worst pair with its reasons."""
    icons = sorted(result["icons"], key=lambda icon: order.index(icon["name"]))
    troubles = [*trouble_lines(result["icons"], cures), *outside_lines(icons)]
    heading = [title, ""] if title else []
    space = [""] if troubles else []
    if result["by"] == "rules":
        told = [*rules_lines(result), *_told(result)]
        show(*heading, rules_table(icons, result["pairs"]), "", *troubles, *space, *told, "", rules_caveat(result))
        return
    made = table(
        "icon",
        "detected",
        "onset",
        "channel",
        "correct",
        "most confused with",
        numbers=("detected", "onset", "correct"),
        names=("icon", "detected", "onset", "channel", "correct", "most confused with"),
    )
    labels = result["confusion"]["labels"]
    apart = len(playable(icons))
    for place, icon in enumerate(icons):
        if place == apart and apart:
            made.add_section()
        made.add_row(
            icon["name"] + (" *" if place >= apart else ""),
            percent(icon["detected_probability"]),
            seconds(icon["onset_s"]),
            icon["channel"] or "–",
            percent(icon["proportion_correct"]),
            rival(result["confusion"], labels.index(icon["name"])),
        )
    best = ["", *choice_lines(result["chosen"])] if result["chosen"] else []
    show(*heading, made, "", *troubles, *space, *set_lines(result), *best, *_told(result), "", caveat(result))


def _told(result: dict[str, Any]) -> list[str]:
    """What rules and model disagree on, with a line of space before it; nothing where they agree."""
    found = result["set"]["rules_disagree"]
    return ["", *disagreement_lines(found)] if found else []


def caveat(result: dict[str, Any]) -> str:
    """Return the sentence that says on what the numbers rest, and what they are not."""
    crowd = "1 virtual person" if result["people"] == 1 else f"{result['people']} virtual people"
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    norm = "" if result["norm"] == "max" else f", {result['norm']} norm"
    return (
        f"Predicted for {crowd} on the {result['rig']} rig{what_if} "
        f"(seed {result['seed']}, {result['tracking']} tracking{norm}{asked_so(result['task'])}). "
        "These are predictions of a model, not measurements."
    )


def rival(confusion: dict[str, Any], place: int) -> str:
    """Return the icon that the one at this place is confused with most often, and how often: the mean of both ways."""
    matrix, labels = confusion["probability"], confusion["labels"]
    others = [(0.5 * (matrix[place][k] + matrix[k][place]), label) for k, label in enumerate(labels) if k != place]
    if not others:
        return "–"
    share, label = max(others)
    return f"{label} {percent(share)}"


def set_lines(result: dict[str, Any]) -> list[str]:
    """Return the sentences about the whole set: what it scores, and which pair to mend first and why."""
    lines = [*number_lines(result), *norm_lines(result), *carried_lines(result["icons"])]
    return [*lines, "", *worst_lines(result), *other_edits(result)] if result["set"]["worst_pair"] else lines


def number_lines(result: dict[str, Any]) -> list[str]:
    """Return what the whole set scores: proportion correct and information, with their intervals."""
    whole = result["set"]
    (low, high), bits = whole["proportion_correct_interval"], whole["information_bits"]
    lines = [f"Set: {percent(whole['proportion_correct'])} correct" + _range(result, percent(low), percent(high))]
    if whole["proportion_correct_parameter_interval"]:
        low, high = whole["proportion_correct_parameter_interval"]
        lines.append(f"     {percent(low)} to {percent(high)} over the range of the model's parameters")
    if bits is not None:
        least, most = whole["information_bits_interval"]
        trials = "1 trial" if whole["trials"] == 1 else f"{whole['trials']} trials"
        lines += [
            f"     {bits:.2f} bits" + _range(result, f"{least:.2f}", f"{most:.2f}"),
            *_bits_range(whole["information_bits_parameter_interval"]),
            f"     {whole['bits_per_s']:.2f} bits/s",
            f"     {whole['information_bits_plugin']:.2f} bits is what an experiment of {trials} would report",
        ]
    return lines


def _bits_range(interval: Sequence[float] | None) -> Iterator[str]:
    if interval is not None:
        yield f"     {interval[0]:.2f} to {interval[1]:.2f} over the range of the model's parameters"


def _range(result: dict[str, Any], low: str, high: str) -> str:
    """What covers 95 % of the people; nothing for one person, who has no spread."""
    return "" if result["people"] == 1 else f"; for 95 % of people {low} to {high}"


def disagreement_lines(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Say where rules and model part, and why they may: the first few, pairs and icons each with its reason."""
    pairs = [each for each in found if "a" in each]
    icons = [each for each in found if "a" not in each]
    for some, why in (
        (pairs, "rules compare two icons back to back, while naming one of them needs memory"),
        (icons, "rules ask for a change and a rate, the model for a cautious observer who notices"),
    ):
        if some:
            yield f"Rules and model disagree: {why}"
            yield from (f"  - {each['text']}" for each in some[:MOST_DISAGREEMENTS])
        if len(some) > MOST_DISAGREEMENTS:
            yield f"  - and {len(some) - MOST_DISAGREEMENTS} more, all of them in --json"


def worst_lines(result: dict[str, Any]) -> Iterator[str]:
    """Yield which pair is confused most often, why, and what would part it; and the nearest, where it is another."""
    pairs, fine = result["pairs"], {icon["name"] for icon in playable(result["icons"])}
    (worst,) = (pair for pair in pairs if [pair["a"], pair["b"]] == result["set"]["worst_pair"])
    confused = percent(worst["confused_probability"])
    head = f"Worst pair: {worst['a']} and {worst['b']}"
    yield f"{head}, confused in {confused} of trials (d′ {number(worst['d_prime'])})"
    yield from (f"  - {reason}" for reason in worst["why"])
    yield from edit_lines(worst)
    near = min((p for p in pairs if not fine or {p["a"], p["b"]} <= fine), key=lambda p: p["d_prime"], default=worst)
    if near["d_prime"] < worst["d_prime"] - SAME_DPRIME:
        share = percent(near["confused_probability"])
        yield f"Nearest in d′: {near['a']} and {near['b']}, d′ {number(near['d_prime'])}, confused in {share} of trials"


def other_edits(result: dict[str, Any]) -> Iterator[str]:
    """Yield the cheapest edits that were found for pairs other than the worst, a line each."""
    others = [pair for pair in result["pairs"] if [pair["a"], pair["b"]] != result["set"]["worst_pair"]]
    found = [(pair, said.removeprefix("  - cheapest edit: ")) for pair in others for said in edit_lines(pair)]
    if found:
        yield ""
        yield "Cheapest edits of the other pairs that are not apart"
    for pair, said in found[:MOST_EDITS]:
        yield f"  - {pair['a']} and {pair['b']}, d′ {number(pair['d_prime'])}: {said.removeprefix('  - ')}"
    if len(found) > MOST_EDITS:
        yield f"  - and {len(found) - MOST_EDITS} more, all of them in --json"


def edit_lines(pair: dict[str, Any]) -> Iterator[str]:
    """Say which edit parts a pair most cheaply, or why none does; nothing where it is apart already."""
    edit = pair["edit"]
    if edit is not None:
        added = f" ({number(edit['added_s'])} s longer)" if edit["added_s"] >= 0.05 else ""
        yield (
            f"  - cheapest edit: in {edit['icon']}, {edit['old']} → {edit['new']}{added}; "
            f"then d′ {number(edit['d_prime'])}"
        )
    elif pair["no_edit"] and "already" not in pair["no_edit"]:
        yield f"  - {pair['no_edit']}"
