"""Timings of perception and of whole commands, and their growth with icons and people."""

from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Observer, rank
from thermicon.perception.sensation.percept import perceive_many

from .measure import command_timed, timed
from .result import Curve, Entry, Section

TRACES, ROWS, STEP_S = 1000, 3001, 0.01
SET, POOL = "six-icons", "search-space"


def percept_section() -> Section:
    """Percepts of many courses of temperature."""
    rng = np.random.default_rng(0)
    corners = 32.0 + np.cumsum(rng.normal(0.0, 1.0, (TRACES, 16)), axis=1)
    place = np.linspace(0.0, 15.0, ROWS)
    left = np.minimum(place.astype(int), 14)
    cold = corners[:, left] + (place - left) * (corners[:, left + 1] - corners[:, left])
    person = Observer.load()
    took = timed(lambda: perceive_many(cold, cold, STEP_S, person), most=5, budget_s=3.0).over(TRACES)
    about = f"{TRACES:,} courses of {ROWS * STEP_S:.0f} s at 100 Hz, cold and warm."
    return Section("Percepts", about, (Entry("a percept", took),))


def command_section(short: bool) -> Section:
    """Commands as they are typed, each in a process of its own, with the most memory that it had."""
    times, entries = 2 if short else 10, []
    if not short:
        with tempfile.TemporaryDirectory() as name:
            Path(name).chmod(0o700)
            empty = {**os.environ, "THERMICON_CACHE": name}
            first = command_timed(["rank", SET], 1, empty)
            entries.append(Entry(f"rank {SET}, first run ever (code is compiled)", first))
    entries.append(Entry(f"check {SET}", command_timed(["check", SET], times)))
    anew = command_timed(["rank", SET, "--recompute"], times)
    entries.append(Entry(f"rank {SET} (200 people, intervals, edit)", anew))
    kept = {name: value for name, value in os.environ.items() if name != "THERMICON_RECOMPUTE"}
    again = command_timed(["rank", SET], times, kept)
    entries.append(Entry(f"rank {SET}, asked for again", again, again.processor_s / anew.processor_s, "rank"))
    if not short:
        entries.append(Entry("validate", command_timed(["validate"], 1)))
    return Section(
        "Commands",
        "From the key press to the prompt, with the most memory that the process had.",
        tuple(entries),
    )


def ranking_section(rig: Rig, short: bool) -> Section:
    """What a ranking takes beside the start of a process, and what that start takes by itself."""
    times, icons = 2 if short else 10, load_library(SET)
    most, budget_s = (2, 4.0) if short else (5, 15.0)
    alone = command_timed([], times, code="import numpy, numba")
    parts = {
        "200 people, intervals, edit": partial(rank, icons, rig, edits="worst"),
        "200 people and intervals": partial(rank, icons, rig),
        "200 people": partial(rank, icons, rig, parameters=0),
    }
    entries = [Entry("Python with numpy and numba, before any work", alone)]
    entries += [Entry(f"{SET}: {what}", timed(run, most=most, budget_s=budget_s)) for what, run in parts.items()]
    about = (
        "The start of a process, which no command can go below, and rankings in a process that has ranked before, so "
        "that code is loaded. The rest of a command is reading modules, kept machine code, rig and cue."
    )
    return Section("What a ranking takes", about, tuple(entries))


def ranking_curves(rig: Rig, short: bool) -> tuple[Curve, ...]:
    """Time of a ranking without intervals over icons and over people."""
    pool = load_library(POOL)
    sizes, crowds = (4, 8, 16) if short else (4, 8, 16, 32, 64), (25, 50, 100) if short else (50, 100, 200, 400)
    few = 20 if short else 50

    def ranked(icons: int, people: int) -> object:
        chosen = tuple(pool.icons[place * len(pool) // icons] for place in range(icons))
        return rank(replace(pool, entries=chosen), rig, people=people, parameters=0)

    most = 2 if short else 5
    by_icons = [timed(partial(ranked, n, few), most=most, budget_s=2.0) for n in sizes]
    by_people = [timed(partial(ranked, 6, n), most=most, budget_s=2.0) for n in crowds]
    return (
        Curve(f"Ranking over icons of search-space ({few} people)", "icons", sizes, tuple(by_icons)),
        Curve("Ranking over people (6 of search-space)", "people", crowds, tuple(by_people)),
    )
