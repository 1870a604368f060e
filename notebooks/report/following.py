"""The next step for a set."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import listed

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.perception import Goal
    from thermicon.perception.selection.advice import Way
    from thermicon.perception.selection.frontier import Frontier

    from .set_report import SetReport

Command = Callable[..., str]
"""Writes a command for the set and rig of the run, from its name and the words that are added."""

PLAYED = ("--to", "csv", "-o", "drives")
OTHER = "Icons of another kind, another rig or a lower goal remain to be tried."


def after_ranking(found: SetReport, command: Command, cures: Mapping[str, str] | None = None) -> str:
    """The command for what is in the way of a set: its play (with `cures`), detection, confusions; else the export."""
    from thermicon.perception.criteria import FELT_FROM

    missed = [] if found.goal is None else [each.part.quantity for each in found.goal.parts if not each.met]
    icons = found.ranking.icons
    lost = [icon.name for icon in icons if not (icon.safe and icon.reachable)]
    if curable := [name for name in lost if name in (cures or {})]:
        return f"change the lines of {listed(curable)} as said below, then {command('rank')}"
    if lost:
        return command("simulate", "--icon", lost[0])
    if found.ranking.elements:
        return _by_hand(found, missed, command)
    if not missed and min(found.ranking.felt.detected) < FELT_FROM:
        return _wider(found, command)
    if missed == ["count"]:
        return f"write more icons, then {command('rank')}"
    if missed:
        return _by_way(found, command)
    if _close(found):
        return command("improve", "--edits", "-o", "edited.cue")
    return command("export", *PLAYED)


def _by_hand(found: SetReport, missed: list[str], command: Command) -> str:
    """To change the icon that fewest feel, or the worst pair; else to export: no edits are tried on elements."""
    from thermicon.perception.criteria import FELT_FROM

    ranking = found.ranking
    if min(ranking.felt.detected) < FELT_FROM:
        least = min(ranking.icons, key=lambda icon: icon.detected_probability)
        return f"write {least.name} larger, then {command('rank')}"
    if missed or _close(found):
        worst = ranking.worst
        those = f"{worst.a} or {worst.b}" if worst else "the icon"
        return f"change {those}, then {command('rank')}"
    return command("export", *PLAYED)


def after_simulating(cured: list[str], lost: list[str], command: Command) -> str:
    """To rank what is played as written; otherwise to change the icons that have a cure, or are lost."""
    if not lost:
        return command("rank")
    way = f"change the lines of {listed(cured)} as said above" if cured else f"write {listed(lost)} slower or smaller"
    return f"{way}, then {command('rank')}"


def after_sweep(frame: pd.DataFrame, key: str, quantity: str, rank: str) -> str:
    """To rank at the value where people do best, if they feel every icon there."""
    from thermicon.perception.criteria import FELT_FROM
    from thermicon.perception.ranking.swept import AGE, MEASURES, SITE

    column = MEASURES[quantity][0]
    means = frame.groupby(key)[column].mean().dropna()
    if means.empty or key == AGE:
        return rank
    best = means.idxmin() if quantity == "onset" else means.idxmax()
    shares = frame[frame[key] == best].set_index("icon")[column].dropna()
    if quantity == "detected" and shares.min() < FELT_FROM:
        return f"no value here lets people feel {shares.idxmin()}: write it larger, then {rank}"
    return f"{rank} --rig {best}" if key == SITE else f"{rank} --set {key}={best:g}"


def after_choices(found: Frontier, command: Command, written: str | None, way: Way | None = None) -> str:
    """The largest choice that meets the goal, or whose icons are all distinguishable: to be written, or exported.

    Where none does, the `way` in which the nearest meets it.
    """
    if written is not None:
        return command("export", *PLAYED, file=written)
    count, hardware = largest(found), list[str]()
    if way is not None:
        count, hardware = len(found.nearest[0].icons), _contact(way)
    if count is None:
        those = "of these icons" if all(point.optimal for point in found.points) else "that was looked at"
        return f"no choice {those} {'meets the goal' if found.goals else 'is distinguishable'}. {OTHER}"
    objective, goal = found.points[0].objective, _goal(found.goals[0].goal if found.goals else None)
    return command("improve", "--choose", str(count), "--objective", objective, *hardware, *goal, "-o", "best.cue")


def after_searching(found: SetReport, command: Command, written: str | None) -> str:
    """To export the set that was found, or to play it on the larger contact with which it meets its goal."""
    if found.way is None or found.goal is None:
        return after_choice(found, command, written)
    hint = "" if written else "add -o best.cue, then "
    return hint + command("rank", *_contact(found.way), *_goal(found.goal.goal), file=written or "best.cue")


def after_choice(found: SetReport, command: Command, written: str | None) -> str:
    """To export what was written, unless its goal is missed."""
    if found.goal is not None and not found.goal.met:
        edited = found.way is not None and found.way.edits and written
        return command("export", *PLAYED, file=written) if edited else _by_way(found, command)
    if found.choice is None and (found.edits or len(found.ranking.icons) == 1):
        return _after_edits(found, command, written)
    return command("export", *PLAYED, file=written) if written else "add -o best.cue, which is then exported"


def _by_way(found: SetReport, command: Command) -> str:
    """To go the cheapest way that meets the goal; the obstacles where none that was tried does."""
    assert found.goal is not None
    way, goal = found.way, _goal(found.goal.goal)
    if way is None:
        return f"{'; '.join(found.goal.binding)}. Nothing that was tried meets the goal. {OTHER}"
    if way.edits:
        return command("improve", "--edits", *goal, "-o", "edited.cue")
    if way.choice is not None:
        kept = [word for name in way.must for word in ("--must", name)]
        return command("improve", "--choose", str(len(way.choice.icons)), *kept, *goal, "-o", "best.cue")
    if found.choice is None:
        return command("rank", *_contact(way), *goal)
    return command("improve", "--choose", str(len(found.choice.icons)), *_contact(way), *goal, "-o", "best.cue")


def _contact(way: Way) -> list[str]:
    return ["--set", f"contact.area_cm2={way.area_cm2:g}"]


def _after_edits(found: SetReport, command: Command, written: str | None) -> str:
    """To export the edited set, or to take fewer icons where edits do not help enough."""
    count, after = len(found.ranking.icons), found.edited
    if after is not None and not _close(replace(found, ranking=after)):
        return command("export", *PLAYED, file=written) if written else "add -o edited.cue, which is then exported"
    if after is None and not _close(found):
        return command("export", *PLAYED)
    return command("improve", "--up-to", str(count)) if count > 2 else f"no edit helps enough. {OTHER}"


def largest(found: Frontier) -> int | None:
    """The size of the largest choice that meets the goal, or, without one, is distinguishable throughout."""
    from thermicon.perception.criteria import DISTINGUISHABLE_DPRIME

    good = (
        [goal.met for goal in found.goals]
        if found.goals
        else [point.at_own_range.d_prime >= DISTINGUISHABLE_DPRIME for point in found.points]
    )
    return max((len(point.icons) for point, met in zip(found.points, good, strict=True) if met), default=None)


def _goal(goal: Goal | None) -> tuple[str, ...]:
    return () if goal is None else ("--goal", goal.text)


def _close(found: SetReport) -> bool:
    """Whether two icons are hardly distinguishable."""
    from thermicon.perception.criteria import DISTINGUISHABLE_DPRIME

    return any(pair.d_prime < DISTINGUISHABLE_DPRIME for pair in found.ranking.pairs)


def _wider(found: SetReport, command: Command) -> str:
    """The growth of detection with the area of the contact."""
    area_cm2 = 1e4 * found.ranking.job.rig.contact.area_m2
    areas = f"contact.area_cm2={area_cm2:.3g}:{4.0 * area_cm2:.3g}:5log"
    return command("sweep", "--vary", areas, "--measure", "detected")
