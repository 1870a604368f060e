"""The details of a ranking."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from thermicon.base.words.number_text import count_of, number, percent, percent_span

from .blocks import Block, Bullets, Heading
from .choices import laboratory

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.ranking.assumptions import Assumption, Assumptions
    from thermicon.perception.ranking.scores import IconScore, PairScore
    from thermicon.perception.ranking.sensitivity import Sensitivity
    from thermicon.perception.selection.edit import Edit

    from .set_report import SetReport

MOST_EDITS = 20
NAMES = {f"laboratory, {channel}": f"sensitivity to {channel} in your laboratory" for channel in ("cold", "warm")}
DETECTED = (
    "Detected is the share of these people's trials that end in a report; onset is the median time of those reports, "
    "channel that of most of them, from 50 % on. Felt and named is, for each person, the share of plays that are "
    "reported times that of right names, taken as independent given the person; named is for announced icons."
)


def detail_blocks(made: SetReport) -> list[Block]:
    """The scores of the set, its worst pair, and what they depend on."""
    ranking, worst = made.ranking, made.ranking.worst
    scores = [*number_points(made), *memory_points(ranking), *carried_points(ranking), *task_points(ranking)]
    found: list[Block] = [Heading("The set"), Bullets(tuple(scores))]
    if worst is not None:
        confused = f"confused in {percent(worst.confused_probability)} of trials, the mean of both ways"
        head = f"Worst pair: {worst.a} and {worst.b}, {confused} (d′ {number(worst.d_prime)})"
        edit = edit_text(made, worst)
        found += [Heading(head), Bullets((*worst.why, *([edit] if edit else []))), *edits_blocks(made)]
    return [*found, *assumption_blocks(ranking.assumptions)]


def trouble_lines(icons: Sequence[IconScore], cures: Mapping[str, str]) -> list[str]:
    """Return one line per icon that is unsafe or not reached, with its cure, and one line on exceeded soft limits."""
    lines = []
    for icon in sorted(icons, key=lambda icon: icon.name not in cures):
        if icon.reason:
            states = ["NOT SAFE"] * (not icon.safe) + ["not reached"] * (not icon.reachable)
            cure = f"; {cures[icon.name]}" if icon.name in cures else ""
            lines.append(f"* {icon.name} is {' and '.join(states)}: {icon.reason}{cure}")
    if lines:
        lines.append("* ranked separately; the set's numbers include these icons as the rig would play them")
    amber = [icon for icon in icons if icon.cautions]
    if amber:
        names = ", ".join(icon.name for icon in amber)
        verb = "exceed" if len(amber) > 1 else "exceeds"
        first = f"of {amber[0].name}, " if len(amber) > 1 else ""
        lines.append(f"Caution: {names} {verb} a soft safety limit: {first}{amber[0].cautions[0]}")
    return lines


def outside_lines(icons: Sequence[IconScore]) -> list[str]:
    """Return one line per way in which icons lie outside the range of the data, with the icons concerned."""
    names_by_reason: dict[str, list[str]] = {}
    for icon in icons:
        for reason in icon.outside_data:
            names_by_reason.setdefault(reason, []).append(icon.name)
    every = len(icons) > 1
    return [
        f"Outside the data: {'all icons' if every and len(names) == len(icons) else ', '.join(names)}: {reason}"
        for reason, names in names_by_reason.items()
    ]


def crowd_text(ranking: Ranking | Sensitivity) -> str:
    """For how many people and on which rig, with its changes."""
    what_if = f" with {', '.join(ranking.rig_changes)}" if ranking.rig_changes else ""
    crowd = count_of(ranking.people, "virtual person", "virtual people")
    return f"{crowd} on the {ranking.rig} {'layout' if getattr(ranking, 'elements', ()) else 'rig'}{what_if}"


def intervals_text(ranking: Ranking) -> str:
    """The sentence on what intervals for a laboratory hold; empty where there are none."""
    found = ranking.new_laboratory
    if found is None:
        return ""
    # The least and the greatest of n hold a further one in (n - 1) / (n + 1) of cases.
    held = (found.draws - 1) / (found.draws + 1)
    few = "" if held >= 0.95 else f"{found.draws} draws are too few for 95 %: they hold at most {int(100.0 * held)} %. "
    return f"Intervals of a laboratory: {', '.join(found.covers)}. {few}"


def caveat(ranking: Ranking) -> str:
    """Return the sentences that state what the numbers rest on and what they are not."""
    memory = "" if ranking.memory == "both" else f", memory: {ranking.memory}"
    gap_s = ranking.task.gap_s
    gap = "" if gap_s is None else f", {gap_s:g} s between icons"
    return (
        f"Predicted for {crowd_text(ranking)} (seed {ranking.seed}, {ranking.tracking} tracking{memory}{gap}). "
        f"These are predictions of a model, not measurements. {intervals_text(ranking)}{DETECTED}"
    )


def number_points(made: SetReport) -> Iterator[str]:
    """Yield the scores of the set: felt and named, named, and information, with their intervals."""
    ranking, elsewhere, where = made.ranking, made.ranking.new_laboratory, laboratory(made.ranking)
    both = (
        ("felt and named", ranking.felt_and_named, ranking.felt_and_named_interval),
        ("named", ranking.proportion_correct, ranking.proportion_correct_interval),
    )
    for word, share, spread in both:
        yield f"{percent(share)} {word}" + _range(ranking, percent_span(*spread))
    if ranking.observer != "shipped":
        yield f"predicted with the observer of {ranking.observer}"
    if elsewhere is not None:
        people = count_of(elsewhere.people, "person", "people")
        ends = f"{percent_span(*elsewhere.felt_and_named)}; named: {percent_span(*elsewhere.proportion_correct)}"
        yield f"mean of {people} in {where} (95 %): {ends}"
    elif made.choice is None:
        yield "no interval for a new laboratory: --intervals 2 or more and an observer with draws (.csv) give one"
    if len(ranking.icons) == 1:
        return
    least, most = ranking.information_bits_interval
    yield f"{ranking.information_bits:.2f} bits" + _range(ranking, f"{least:.2f}–{most:.2f} bits")
    if elsewhere is not None:
        least, most = elsewhere.information_bits
        yield f"in {where} (95 %): {least:.2f}–{most:.2f} bits"
    yield f"{ranking.bits_per_s:.2f} bits/s"
    plugin = float(ranking.felt.plugin.mean())
    yield f"a {ranking.job.trials}-trial experiment would report {plugin:.2f} bits (biased upwards)"


def _range(ranking: Ranking, interval: str) -> str:
    """The interval of the middle 95 % of people, which a goal's 95 % is not; nothing for one person."""
    return "" if ranking.people == 1 else f"; middle 95 % of people: {interval}"


def memory_points(ranking: Ranking) -> Iterator[str]:
    """Yield what each form of memory predicts, and the change of order; nothing for one icon or one form."""
    if not ranking.pairs or len(ranking.by_form) == 1:
        return
    shares = ", ".join(f"{percent(share)} named with {form}" for form, share in ranking.by_form.items())
    changes = ranking.form_changes
    if not changes:
        order = "the same order"
    else:
        more = f" ({count_of(len(changes) - 1, 'more change')} of order)" if len(changes) > 1 else ""
        better, worse = changes[0]
        order = f"{better} ranks before {worse} with the first and after it with the second{more}"
    known = "as the draws of this laboratory have them" if ranking.own_laboratory else "no data settle which is right"
    yield f"form of memory: {shares}; {order}; {known}, and d′ are those of the first"


def carried_points(ranking: Ranking) -> Iterator[str]:
    """Yield which icon is changed most by the icon before it; nothing where all carry-over has faded."""
    if left := ranking.carry_over:
        form, counted = ranking.job.forms[0], ranking.task.counted
        worst = [left.worst_of(place, form, counted) for place in range(len(ranking.icons))]
        d_prime, name, before = max((d, name, before) for name, (before, d) in zip(ranking.labels, worst, strict=True))
        after = "a first play of itself" if before == name else before
        yield f"carry-over: largest for {name} after {after}, d′ {number(d_prime)} from {name} alone"


def task_points(ranking: Ranking) -> Iterator[str]:
    """Yield which lapse turns the prediction into what was published for people who did something else too."""
    for cost in ranking.place.costs if ranking.place else ():
        told = f"{cost.published.quantity}: {100.0 * cost.published.central:.1f} % ({cost.published.source})"
        why = f"{percent(cost.predicted)} are predicted without that task, so it costs a lapse of {cost.lapse:.2g}"
        yield f"{told}; {why}; with it in the layout file, this set is named in {percent(cost.named)}"


def edits_blocks(made: SetReport) -> list[Block]:
    """The cheapest edits of the other pairs, a point each."""
    worst = made.ranking.worst
    edits = [f"{pair.a} and {pair.b}, d′ {number(pair.d_prime)}: {text}" for pair in made.ranking.pairs
             if pair is not worst and (text := edit_text(made, pair, ""))]  # fmt: skip
    if not edits:
        return []
    more = [f"and {len(edits) - MOST_EDITS} more; --json lists all"] * (len(edits) > MOST_EDITS)
    return [Heading("Cheapest edits of the other indistinguishable pairs", 3), Bullets((*edits[:MOST_EDITS], *more))]


def edit_text(made: SetReport, pair: PairScore, lead: str = "cheapest edit: ") -> str:
    """The cheapest edit that separates a pair, or why there is none; empty if it was not looked for or not needed."""
    from thermicon.perception.criteria import DISTINGUISHABLE_DPRIME
    from thermicon.perception.selection.edit import NoEdit

    edit = made.edits.get((pair.a, pair.b))
    if isinstance(edit, NoEdit):
        return edit.reason if pair.d_prime < DISTINGUISHABLE_DPRIME else ""
    return "" if edit is None else f"{lead}{edit_words(edit)}"


def edit_words(edit: Edit) -> str:
    """The change by an edit, and the distance of the pair after it."""
    added = f" ({number(edit.added_s)} s longer)" if edit.added_s >= 0.05 else ""
    return f"in {edit.icon}, {edit.old} → {edit.new}{added}; then d′ {number(edit.d_prime)}"


def assumption_blocks(found: Assumptions) -> list[Block]:
    """The assumptions that move the proportion named most, what the site rests on, and what was not varied."""
    if not (found.moving or found.site):
        return []
    head = "What this depends on (no single assumption stands out from these people and draws)"
    if found.moving:
        head = "What this depends on most, from the people and draws above"
    points = [_moving(each) for each in found.moving] + ([_site(found.site)] if found.site else [])
    points += [f"not varied: {', '.join(found.not_varied)}"] if found.not_varied else []
    return [Heading(head), Bullets(tuple(points))]


def _moving(each: Assumption) -> str:
    low, high = percent(each.correct_at_low), percent(each.correct_at_high)
    if each.source == "draws":
        name = NAMES.get(each.name, each.name)
        return f"{name}: {low} named at the low end of its 95 %, {high} at the high end"
    return (
        f"{each.name}: {low} named at {each.low:.2g} {each.unit}, {high} at {each.high:.2g} {each.unit} "
        f"({each.value:.2g} {each.unit} assumed)"
    )


def _site(site: Mapping[str, Any]) -> str:
    nearest = site["nearest_recorded"]
    near = f"the nearest site with thresholds on record is the {nearest} ({site['why']})" if nearest else site["why"]
    used = (
        "whose thresholds are used" if nearest == site["thresholds_of"] else f"the {site['thresholds_of']}'s are used"
    )
    twice = site["proportion_correct_at_twice_the_thresholds"]
    more = "" if twice is None else f"; with twice those thresholds, {percent(twice)} named"
    return f"{site['site']}: {near}, {used}{more}"
