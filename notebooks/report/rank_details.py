"""What stands behind a ranking: notes, its numbers with intervals, the worst pair with its reasons, and assumptions."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from thermicon.icons.number_text import count_of, number, percent, percent_span

from .blocks import Block, Bullets, Heading
from .choices import laboratory

MOST_EDITS = 20
NAMES = {f"laboratory, {channel}": f"sensitivity to {channel} in your laboratory" for channel in ("cold", "warm")}
DETECTED = (
    "Detected is the share of these people's trials that end in a report; onset is the median time of those reports, "
    "channel what most of them go by, from 50 % on."
)


def detail_blocks(result: Mapping[str, Any]) -> list[Block]:
    """The scores of the set, its worst pair, and what they depend on."""
    scores = [*number_points(result), *norm_points(result), *carried_points(result["icons"])]
    found: list[Block] = [Heading("The set"), Bullets(tuple(scores))]
    if result["set"]["worst_pair"]:
        first, *reasons = worst_points(result)
        found += [Heading(first), Bullets(tuple(reasons)), *edits_blocks(result)]
    return [*found, *assumption_blocks(result["assumptions"])]


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


def crowd_text(result: Mapping[str, Any]) -> str:
    """For how many people and on which rig, with its changes."""
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    crowd = count_of(result["people"], "virtual person", "virtual people")
    return f"{crowd} on the {result['rig']} rig{what_if}"


def caveat(result: Mapping[str, Any]) -> str:
    """Return the sentences that state what the numbers rest on and what they are not."""
    norm = "" if result["norm"] == "episodes" else f", memory: {result['norm']}"
    gap_s = result["task"]["gap_s"]
    gap = "" if gap_s is None else f", {gap_s:g} s between icons"
    return (
        f"Predicted for {crowd_text(result)} (seed {result['seed']}, {result['tracking']} tracking{norm}{gap}). "
        f"These are predictions of a model, not measurements. {DETECTED}"
    )


def number_points(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield the scores of the set: proportion correct and information, with their intervals."""
    whole = result["set"]
    (low, high), bits = whole["proportion_correct_interval"], whole["information_bits"]
    where = laboratory(result["observer"], whole["own_laboratory"])
    yield f"{percent(whole['proportion_correct'])} correct" + _range(result, percent_span(low, high))
    if result["observer"] != "shipped":
        yield f"predicted with the observer of {result['observer']}"
    if whole["proportion_correct_interval_new_laboratory"]:
        low, high = whole["proportion_correct_interval_new_laboratory"]
        people = count_of(whole["new_laboratory_people"], "person", "people")
        yield f"mean of {people} in {where} (95 %): {percent_span(low, high)}"
    elif not result["chosen"]:
        yield "no interval for a new laboratory: --intervals 2 or more and an observer with draws (.csv) give one"
    if bits is None:
        return
    least, most = whole["information_bits_interval"]
    yield f"{bits:.2f} bits" + _range(result, f"{least:.2f}–{most:.2f} bits")
    if (interval := whole["information_bits_interval_new_laboratory"]) is not None:
        yield f"in {where} (95 %): {interval[0]:.2f}–{interval[1]:.2f} bits"
    yield f"{whole['bits_per_s']:.2f} bits/s"
    plugin = whole["information_bits_plugin"]
    yield f"a {whole['trials']}-trial experiment would report {plugin:.2f} bits (biased upwards)"


def _range(result: Mapping[str, Any], interval: str) -> str:
    """The interval of the middle 95 % of people, which a goal's 95 % is not; nothing for one person."""
    return "" if result["people"] == 1 else f"; middle 95 % of people: {interval}"


def norm_points(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield whether the order would change with the other form of memory; nothing for one icon.

    >>> whole = {"norm_sensitivity": {"naming": 0.7}, "norm_changes": {"naming": [["a", "b"], ["a", "c"]]}}
    >>> list(norm_points({"pairs": [{}], "set": whole}))
    ['with the naming distance: 70 % correct, b before a (1 more change of order)']
    """
    whole = result["set"] if result["pairs"] else {"norm_sensitivity": {}}
    for norm, share in whole["norm_sensitivity"].items():
        changes = whole["norm_changes"][norm]
        if not changes:
            order = "same order"
        else:
            more = f" ({count_of(len(changes) - 1, 'more change')} of order)" if len(changes) > 1 else ""
            order = f"{changes[0][1]} before {changes[0][0]}{more}"
        yield f"with the {norm} distance: {percent(share)} correct, {order}"


def carried_points(icons: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Yield which icon is changed most by the icon before it; nothing where all carry-over has faded."""
    carried = [(icon["carry_over"]["d_prime"], icon["name"], icon["carry_over"]["after"]) for icon in icons
               if icon["carry_over"]]  # fmt: skip
    if carried:
        d_prime, name, before = max(carried)
        after = "a first play of itself" if before == name else before
        yield f"carry-over: largest for {name} after {after}, d′ {number(d_prime)} from {name} alone"


def worst_points(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield which pair is confused most often, why, and what would separate it."""
    worst = worst_pair(result)
    confused = percent(worst["confused_probability"])
    head = f"Worst pair: {worst['a']} and {worst['b']}"
    yield f"{head}, confused in {confused} of trials, the mean of both ways (d′ {number(worst['d_prime'])})"
    yield from worst["why"]
    if edit := edit_text(worst):
        yield edit


def worst_pair(result: Mapping[str, Any]) -> dict[str, Any]:
    """The record of the worst pair of a set that has one."""
    (worst,) = (pair for pair in result["pairs"] if [pair["a"], pair["b"]] == result["set"]["worst_pair"])
    return dict(worst)


def edits_blocks(result: Mapping[str, Any]) -> list[Block]:
    """The cheapest edits of the other pairs, a point each."""
    others = [pair for pair in result["pairs"] if [pair["a"], pair["b"]] != result["set"]["worst_pair"]]
    edits = [f"{pair['a']} and {pair['b']}, d′ {number(pair['d_prime'])}: {text.removeprefix('cheapest edit: ')}"
             for pair in others if (text := edit_text(pair))]  # fmt: skip
    if not edits:
        return []
    more = [f"and {len(edits) - MOST_EDITS} more; --json lists all"] * (len(edits) > MOST_EDITS)
    return [Heading("Cheapest edits of the other indistinguishable pairs", 3), Bullets((*edits[:MOST_EDITS], *more))]


def edit_text(pair: Mapping[str, Any]) -> str:
    """The cheapest edit that separates a pair, or why there is none; empty if it was not looked for or not needed."""
    from thermicon.perception.criteria import DISTINGUISHABLE_DPRIME

    if (edit := pair["edit"]) is not None:
        added = f" ({number(edit['added_s'])} s longer)" if edit["added_s"] >= 0.05 else ""
        return (
            f"cheapest edit: in {edit['icon']}, {edit['old']} → {edit['new']}{added}; then d′ {number(edit['d_prime'])}"
        )
    return pair["no_edit"] if pair["no_edit"] and pair["d_prime"] < DISTINGUISHABLE_DPRIME else ""


def assumption_blocks(found: Mapping[str, Any] | None) -> list[Block]:
    """The assumptions that move the proportion correct most, what the site rests on, and what was not varied."""
    if found is None or not (found["moving"] or found["site"]):
        return []
    head = "What this depends on (no single assumption stands out from these people and draws)"
    if found["moving"]:
        head = "What this depends on most, from the people and draws above"
    points = [_moving(each) for each in found["moving"]] + ([_site(found["site"])] if found["site"] else [])
    points += [f"not varied: {', '.join(found['not_varied'])}"] if found["not_varied"] else []
    return [Heading(head), Bullets(tuple(points))]


def _moving(each: Mapping[str, Any]) -> str:
    low, high = percent(each["correct_at_low"]), percent(each["correct_at_high"])
    if each["source"] == "draws":
        name = NAMES.get(each["name"], each["name"])
        return f"{name}: {low} correct at the low end of its 95 %, {high} at the high end"
    unit = each["unit"]
    return (
        f"{each['name']}: {low} correct at {each['low']:.2g} {unit}, {high} at {each['high']:.2g} {unit} "
        f"({each['value']:.2g} {unit} assumed)"
    )


def _site(site: Mapping[str, Any]) -> str:
    nearest = site["nearest_recorded"]
    near = f"the nearest site with thresholds on record is the {nearest} ({site['why']})" if nearest else site["why"]
    used = (
        "whose thresholds are used" if nearest == site["thresholds_of"] else f"the {site['thresholds_of']}'s are used"
    )
    twice = site["proportion_correct_at_twice_the_thresholds"]
    more = "" if twice is None else f"; with twice those thresholds, {percent(twice)} correct"
    return f"{site['site']}: {near}, {used}{more}"
