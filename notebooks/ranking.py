"""``thermicon rank``: predicted detection, confusions and information of one set, as table, JSON and figures."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from thermicon.notebooks.cues import read_set
from thermicon.notebooks.door import note, usage
from thermicon.notebooks.outputs import STDOUT, check_folder, check_output, complete_or_absent
from thermicon.notebooks.progress import progress_bar
from thermicon.notebooks.tables import show, table
from thermicon.notebooks.wording import number, percent, seconds

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking


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
        check_folder(figures)
    icons = read_set(files)
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
    if json_out == STDOUT:
        typer.echo(text)
    else:
        show_ranking(json.loads(text), [row["icon"] for row in ranking.rows()], icons.title)
    if json_out is not None and json_out != STDOUT:
        with complete_or_absent(json_out) as draft:
            draft.write_text(text + "\n", encoding="utf-8")
    if figures is not None:
        write_figures(ranking, icons, rig, figures)


def show_ranking(result: dict[str, Any], order: Sequence[str], title: str) -> None:
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
    troubles = [f"{icon['name']} is {_trouble(icon)}: {icon['reason']}" for icon in result["icons"] if icon["reason"]]
    heading = [title, ""] if title else []
    show(*heading, made, "", *troubles, *([""] if troubles else []), *set_lines(result), "", caveat(result))


def caveat(result: dict[str, Any]) -> str:
    """Return the sentence that says on what the numbers rest, and what they are not."""
    crowd = "1 virtual person" if result["people"] == 1 else f"{result['people']} virtual people"
    return (
        f"Predicted for {crowd} on the {result['rig']} rig (seed {result['seed']}, {result['tracking']} tracking). "
        "These are predictions of a model, not measurements."
    )


def _trouble(icon: dict[str, Any]) -> str:
    return "not reached" if icon["safe"] else "NOT SAFE"


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
    low, high = whole["percent_correct_interval"] or (None, None)
    lines = [f"Set: {percent(whole['percent_correct'])} correct; for 95 % of people {percent(low)} to {percent(high)}"]
    bits, interval = whole["information_bits"], whole["information_bits_interval"]
    if bits is not None and interval is not None:
        lines += [
            f"     {bits:.2f} bits; for 95 % of people {interval[0]:.2f} to {interval[1]:.2f}",
            f"     {whole['bits_per_s']:.2f} bits/s",
            f"     {whole['information_bits_plugin']:.2f} bits is what an experiment "
            f"of {whole['trials']} trials would report",
        ]
    if whole["worst_pair"]:
        lines += ["", *_worst(result, whole["worst_pair"])]
    return lines


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
        draw_overview(simulate(icon, rig, tail_s=FELT_TAIL_S), folder / f"overview-{icon.name}.png")
    note(f"wrote distance.png, confusion.png and {len(icons)} overviews into {folder}")
