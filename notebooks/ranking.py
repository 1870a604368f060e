"""``thermicon rank``: predicted detection, confusions and information of one set, as table, JSON and figures."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from thermicon.notebooks.cues import MOST_ICONS, read_set, warn_of_frames
from thermicon.notebooks.door import note, usage
from thermicon.notebooks.outputs import FIGURE_SUFFIXES, STDOUT, check_folder, check_output, complete_or_absent
from thermicon.notebooks.progress import progress_bar
from thermicon.notebooks.tables import show, table
from thermicon.notebooks.wording import number, percent, seconds

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking

PICTURES = (*FIGURE_SUFFIXES, ".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".eps")
MOST_DISAGREEMENTS = 5


@dataclass(frozen=True, slots=True)
class Request:
    """What ``rank`` was asked for: people, seed, tracking (None: by the icons' control), norm, trials."""

    people: int = 200
    seed: int = 0
    tracking: str | None = None
    norm: str = "max"
    trials: int = 48


def rank_files(files: Sequence[str], rig: Rig, request: Request, json_out: Path | None, figures: Path | None) -> None:
    """Rank the joined icons of some files on the rig: the table on stdout, the rest where it was asked for."""
    from thermicon.perception import NORMS, rank

    if request.norm not in NORMS:
        raise usage(f"{request.norm!r} is none of {', '.join(NORMS)}", "--norm")
    if json_out is not None:
        check_output(json_out, (), "JSON")
    if figures is not None:
        if not figures.is_dir() and (figures.exists() or figures.suffix.lower() in PICTURES):
            hint = figures.with_suffix("") if figures.suffix else "figures"
            raise usage(f"{figures} is the name of a file; give a folder, such as {hint}, for all figures", "--figure")
        check_folder(figures)
    icons = read_set(files)
    if len(icons) > MOST_ICONS:
        what = f"there are {len(icons):,} icons, and every pair is compared: at most {MOST_ICONS:,} are ranked at once"
        raise usage(f"{what}; narrow a family, or name its best members in a set of their own", "FILE")
    warn_of_frames(files, icons, rig)
    with progress_bar("ranking") as progress:
        ranking = rank(
            icons,
            rig,
            people=request.people,
            seed=request.seed,
            trials=request.trials,
            tracking=request.tracking,
            norm=request.norm,
            progress=progress,
        )
    text = ranking.to_json()
    if json_out is not None and json_out != STDOUT:
        with complete_or_absent(json_out) as draft:
            draft.write_text(text + "\n", encoding="utf-8")
        note(f"wrote {json_out}")
    if figures is not None:
        write_figures(ranking, icons, rig, figures)
    if json_out == STDOUT:
        typer.echo(text)
    else:
        show_ranking(json.loads(text), [row["icon"] for row in ranking.rows()], icons.title, cures(ranking, icons, rig))


def cures(ranking: Ranking, icons: IconSet, rig: Rig) -> dict[str, str]:
    """Return by name how each icon that the rig does not reach could be changed so that it does."""
    from thermicon.circuit import nearest_reachable

    missed = {score.name for score in ranking.icons if not score.reachable}
    near = {icon.name: nearest_reachable(icon, rig) for icon in icons if icon.name in missed}
    return {name: found.sentence for name, found in near.items() if found is not None}


def show_ranking(result: dict[str, Any], order: Sequence[str], title: str, cures: Mapping[str, str]) -> None:
    """Print what ``rank --json`` holds: a row an icon in this order, the set, the worst pair with its reasons."""
    made = table(
        "icon",
        "detected",
        "onset",
        "channel",
        "correct",
        "most confused with",
        numbers=("detected", "onset", "correct"),
    )
    for place, icon in sorted(enumerate(result["icons"]), key=lambda item: order.index(item[1]["name"])):
        made.add_row(
            icon["name"],
            percent(icon["detected_probability"]),
            seconds(icon["onset_s"]),
            icon["channel"] or "–",
            percent(icon["percent_correct"]),
            _rival(result["confusion"], place),
        )
    troubles = trouble_lines(result["icons"], cures)
    heading = [title, ""] if title else []
    show(*heading, made, "", *troubles, *([""] if troubles else []), *set_lines(result), "", caveat(result))


def caveat(result: dict[str, Any]) -> str:
    """Return the sentence that says on what the numbers rest, and what they are not."""
    crowd = "1 virtual person" if result["people"] == 1 else f"{result['people']} virtual people"
    changes = result["rig_changes"]
    what_if = f" with {', '.join(changes)}" if changes else ""
    norm = "" if result["norm"] == "max" else f", {result['norm']} norm"
    return (
        f"Predicted for {crowd} on the {result['rig']} rig{what_if} "
        f"(seed {result['seed']}, {result['tracking']} tracking{norm}). "
        "These are predictions of a model, not measurements."
    )


def trouble_lines(icons: Sequence[dict[str, Any]], cures: Mapping[str, str]) -> list[str]:
    """Return what the rig cannot play or must not, with the cure where there is one, and one line on what is amber."""
    lines = []
    for icon in icons:
        if icon["reason"]:
            said = ["NOT SAFE"] * (not icon["safe"]) + ["not reached"] * (not icon["reachable"])
            better = f"; {cures[icon['name']]}" if icon["name"] in cures else ""
            lines.append(f"{icon['name']} is {' and '.join(said)}: {icon['reason']}{better}")
    amber = [icon for icon in icons if icon["cautions"]]
    if amber:
        names = ", ".join(icon["name"] for icon in amber)
        first = f"of {amber[0]['name']}, " if len(amber) > 1 else ""
        lines.append(f"Caution, soft limit of safety passed by {names}: {first}{amber[0]['cautions'][0]}")
    return lines


def _rival(confusion: dict[str, Any], place: int) -> str:
    row = confusion["probability"][place]
    others = [
        (share, label) for k, (share, label) in enumerate(zip(row, confusion["labels"], strict=True)) if k != place
    ]
    if not others:
        return "–"
    share, label = max(others)
    return f"{label} {percent(share)}"


def set_lines(result: dict[str, Any]) -> list[str]:
    """Return the sentences about the whole set: what it scores, and which pair to mend first and why."""
    whole = result["set"]
    (low, high), bits = whole["percent_correct_interval"], whole["information_bits"]
    lines = [f"Set: {percent(whole['percent_correct'])} correct" + _range(result, percent(low), percent(high))]
    if bits is not None:
        least, most = whole["information_bits_interval"]
        trials = "1 trial" if whole["trials"] == 1 else f"{whole['trials']} trials"
        lines += [
            f"     {bits:.2f} bits" + _range(result, f"{least:.2f}", f"{most:.2f}"),
            f"     {whole['bits_per_s']:.2f} bits/s",
            f"     {whole['information_bits_plugin']:.2f} bits is what an experiment of {trials} would report",
        ]
    if whole["worst_pair"]:
        lines += ["", *_worst(result, whole["worst_pair"])]
    if whole["rules_disagree"]:
        lines += ["", *_disagreements(whole["rules_disagree"])]
    return lines


def _range(result: dict[str, Any], low: str, high: str) -> str:
    """What covers 95 % of the people; nothing for one person, who has no spread."""
    return "" if result["people"] == 1 else f"; for 95 % of people {low} to {high}"


def _disagreements(found: Sequence[dict[str, Any]]) -> Iterator[str]:
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


def _worst(result: dict[str, Any], names: Sequence[str]) -> Iterator[str]:
    for pair in result["pairs"]:
        if {pair["a"], pair["b"]} == set(names):
            confused = percent(pair["confused_probability"])
            head = f"Worst pair: {pair['a']} and {pair['b']}"
            yield f"{head}, confused in {confused} of trials (d′ {number(pair['d_prime'])})"
            yield from (f"  - {reason}" for reason in pair["why"])


def write_figures(ranking: Ranking, icons: IconSet, rig: Rig, folder: Path) -> None:
    """Write distance.png, confusion.png and an overview for every icon into ``folder``, which is made if missing."""
    from thermicon.circuit import simulate
    from thermicon.notebooks.overview import single_map
    from thermicon.notebooks.simulate import FELT_TAIL_S, draw_overview

    folder.mkdir(exist_ok=True)
    for kind in ("distance", "confusion"):
        with complete_or_absent(folder / f"{kind}.png") as draft:
            single_map(ranking, kind).savefig(draft, dpi=130)
    for icon in icons:
        draw_overview(simulate(icon, rig, tail_s=FELT_TAIL_S), folder / f"overview-{icon.name}.png", rig.changes)
    count = "1 overview" if len(icons) == 1 else f"{len(icons)} overviews"
    note(f"wrote distance.png, confusion.png and {count} into {folder}")
