"""The text of ``rank``: the table of icons, the set, and the worst pair with its reasons and edits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from thermicon.icons.number_text import count_of, number, percent, percent_span, seconds

from .assumption_text import assumption_lines
from .choices import choice_lines, goal_lines, laboratory
from .rank_notes import (
    carried_lines,
    norm_lines,
    outside_lines,
    playable,
    rules_caveat,
    rules_lines,
    rules_table,
    task_note,
    trouble_lines,
)
from .tables import show, table

DETECTED = (
    "Detected is the share of these people's trials that end in a report; onset is the median time of those reports, "
    "channel what most of them go by, from 50 % on."
)
NO_INTERVAL = "     no interval for a new laboratory: "
MOST_DISAGREEMENTS, MOST_EDITS, SAME_DPRIME = 5, 20, 0.05


def show_ranking(result: dict[str, Any], order: Sequence[str], title: str, cures: Mapping[str, str]) -> None:
    """Print the content of ``rank --json``: one row per icon in this order, the set, the worst pair with reasons."""
    icons = sorted(result["icons"], key=lambda icon: order.index(icon["name"]))
    troubles = [*trouble_lines(result["icons"], cures), *outside_lines(icons)]
    heading = [title, ""] if title else []
    space = [""] if troubles else []
    if result["by"] == "rules":
        lines = [*rules_lines(result), *_disagreements(result)]
        show(*heading, rules_table(icons, result["pairs"]), "", *troubles, *space, *lines, "", rules_caveat(result))
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
    best = ["", *choice_lines(result["chosen"], _where(result))] if result["chosen"] else []
    goal = ["", *goal_lines(result["goal"])] if result["goal"] else []
    depends = assumption_lines(result["assumptions"])
    lines = [*set_lines(result), *depends, *best, *goal, *_disagreements(result)]
    show(*heading, made, "", *troubles, *space, *lines, "", caveat(result))


def _disagreements(result: dict[str, Any]) -> list[str]:
    """Disagreements of rules and model, of the chosen where some are, after an empty line; nothing where they agree."""
    found = result["set"]["rules_disagree"]
    if result["chosen"]:
        chosen = {*result["chosen"]["icons"]}
        found = [each for each in found if {each[key] for key in ("icon", "a", "b") if key in each} <= chosen]
    return ["", *disagreement_lines(found)] if found else []


def caveat(result: dict[str, Any]) -> str:
    """Return the sentences that state what the numbers rest on and what they are not."""
    crowd = count_of(result["people"], "virtual person", "virtual people")
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    norm = "" if result["norm"] == "episodes" else f", {result['norm']} norm"
    return (
        f"Predicted for {crowd} on the {result['rig']} rig{what_if} "
        f"(seed {result['seed']}, {result['tracking']} tracking{norm}{task_note(result['task'])}). "
        f"These are predictions of a model, not measurements. {DETECTED}"
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
    """Return the sentences on the whole set: its scores, and which pair to improve first and why."""
    lines = [*number_lines(result), *norm_lines(result), *carried_lines(result["icons"])]
    return [*lines, "", *worst_lines(result), *other_edits(result)] if result["set"]["worst_pair"] else lines


def number_lines(result: dict[str, Any]) -> list[str]:
    """Return the scores of the set: proportion correct and information, with their intervals."""
    whole = result["set"]
    (low, high), bits = whole["proportion_correct_interval"], whole["information_bits"]
    lines = [f"Set: {percent(whole['proportion_correct'])} correct" + _range(result, percent_span(low, high))]
    if result["observer"] != "shipped":
        lines.append(f"     predicted with the observer of {result['observer']}")
    if whole["proportion_correct_interval_new_laboratory"]:
        low, high = whole["proportion_correct_interval_new_laboratory"]
        people = count_of(whole["new_laboratory_people"], "person", "people")
        lines.append(f"     mean of {people} in {_where(result)} (95 %): {percent_span(low, high)}")
    elif not result["chosen"]:
        lines.append(_no_interval(result["observer"]))
    if bits is not None:
        least, most = whole["information_bits_interval"]
        plugin = whole["information_bits_plugin"]
        lines += [
            f"     {bits:.2f} bits" + _range(result, f"{least:.2f}–{most:.2f} bits"),
            *_bits_range(whole["information_bits_interval_new_laboratory"], _where(result)),
            f"     {whole['bits_per_s']:.2f} bits/s",
            f"     a {whole['trials']}-trial experiment would report {plugin:.2f} bits (biased upwards)",
        ]
    return lines


def _where(result: dict[str, Any]) -> str:
    return laboratory(result["observer"], result["set"]["own_laboratory"])


def _no_interval(observer: str) -> str:
    """Why there is none: an observer without draws, or no draws asked for."""
    if observer.lower().endswith(".toml"):
        return f"{NO_INTERVAL}{observer} is one observer without draws; a table of draws (.csv) gives one"
    return f"{NO_INTERVAL}--intervals 2 or more and an observer with draws give one"


def _bits_range(interval: Sequence[float] | None, where: str) -> Iterator[str]:
    if interval is not None:
        yield f"     in {where} (95 %): {interval[0]:.2f}–{interval[1]:.2f} bits"


def _range(result: dict[str, Any], interval: str) -> str:
    """The interval of the middle 95 % of people, which a goal's 95 % is not; nothing for one person."""
    return "" if result["people"] == 1 else f"; middle 95 % of people: {interval}"


def disagreement_lines(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Report where rules and model disagree, and why they may: the first few pairs and icons."""
    pairs = [each for each in found if "a" in each]
    icons = [each for each in found if "a" not in each]
    for some, why in (
        (pairs, "rules compare two icons played back to back, while naming one needs memory"),
        (icons, "rules require a change and a rate, the model a report in half of the trials"),
    ):
        if some:
            yield f"Rules and model disagree: {why}"
            yield from (f"  - {each['text']}" for each in some[:MOST_DISAGREEMENTS])
        if len(some) > MOST_DISAGREEMENTS:
            yield f"  - and {len(some) - MOST_DISAGREEMENTS} more; --json lists all"


def worst_lines(result: dict[str, Any]) -> Iterator[str]:
    """Yield which pair is confused most often, why, and what would separate it; and the nearest pair if different."""
    pairs, fine = result["pairs"], {icon["name"] for icon in playable(result["icons"])}
    (worst,) = (pair for pair in pairs if [pair["a"], pair["b"]] == result["set"]["worst_pair"])
    confused = percent(worst["confused_probability"])
    head = f"Worst pair: {worst['a']} and {worst['b']}"
    yield f"{head}, confused in {confused} of trials, the mean of both ways (d′ {number(worst['d_prime'])})"
    yield from (f"  - {reason}" for reason in worst["why"])
    yield from edit_lines(worst)
    nearest = min((p for p in pairs if not fine or {p["a"], p["b"]} <= fine), key=lambda p: p["d_prime"], default=worst)
    if nearest["d_prime"] < worst["d_prime"] - SAME_DPRIME:
        share = percent(nearest["confused_probability"])
        pair = f"{nearest['a']} and {nearest['b']}"
        yield (
            f"Nearest in d′: {pair}, d′ {number(nearest['d_prime'])}, confused in {share} of trials: d′ compares these "
            "two alone, answers are spread over all names, and missed icons get any of them"
        )


def other_edits(result: dict[str, Any]) -> Iterator[str]:
    """Yield the cheapest edits of the other pairs, one line each."""
    others = [pair for pair in result["pairs"] if [pair["a"], pair["b"]] != result["set"]["worst_pair"]]
    edits = [(pair, line.removeprefix("  - cheapest edit: ")) for pair in others for line in edit_lines(pair)]
    if edits:
        yield ""
        yield "Cheapest edits of the other indistinguishable pairs"
    for pair, line in edits[:MOST_EDITS]:
        yield f"  - {pair['a']} and {pair['b']}, d′ {number(pair['d_prime'])}: {line.removeprefix('  - ')}"
    if len(edits) > MOST_EDITS:
        yield f"  - and {len(edits) - MOST_EDITS} more; --json lists all"


def edit_lines(pair: dict[str, Any]) -> Iterator[str]:
    """Report the cheapest edit that separates a pair, or why there is none; nothing if it is distinguishable."""
    edit = pair["edit"]
    if edit is not None:
        added = f" ({number(edit['added_s'])} s longer)" if edit["added_s"] >= 0.05 else ""
        yield (
            f"  - cheapest edit: in {edit['icon']}, {edit['old']} → {edit['new']}{added}; "
            f"then d′ {number(edit['d_prime'])}"
        )
    elif pair["no_edit"] and "already" not in pair["no_edit"]:
        yield f"  - {pair['no_edit']}"
