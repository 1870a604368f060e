"""A set ranked for the set view first quickly and then well."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermicon.circuit import Rig
from thermicon.icons import Icon
from thermicon.perception import Observer, Ranking, rank
from thermicon.perception.criteria import MOST_ICONS
from thermicon.perception.identification.map import PerceptualMap, map_of
from thermicon.perception.kernels.parallel import step_counter
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.plots.draw_heat import clustered_order, short
from thermicon.perception.ranking.rank import with_intervals
from thermicon.perception.ranking.scores import PairScore

from ..editing.cue_check import Reading, read_text
from ..timeline.frames import MOST_POINTS, CanvasFrame, terms_of
from ..timeline.scene import draw

SetRequest = tuple[str, Rig]
QUICK, WELL = (12, 0), (200, 128)
"""How many people, and how many draws of the parameters: at once, and when there is time."""
MOST_RANKED = 60
STYLES: tuple[tuple[list[int], float], ...] = (([], 1.75), ([7, 3], 1.75))
"""Dashes and width of the first curve and the second, which distinguish them in grey too."""
PANELS = (
    ("skin", "skin (°C)", 1.2, "ink"),
    ("cold", "felt as cold (d′)", 1.0, "cool"),
    ("warm", "felt as warm (d′)", 1.0, "warm"),
)


@dataclass(frozen=True, slots=True)
class RankedSet:
    """A ranking, its text and rig, its map, the order of its heat maps, and what it took (ms)."""

    text: str
    rig: Rig
    icons: tuple[Icon, ...]
    ranking: Ranking
    map: PerceptualMap | None
    order: tuple[int, ...]
    ms: float

    @property
    def labels(self) -> list[str]:
        """Names in the order of the heat maps."""
        return [self.ranking.labels[k] for k in self.order]

    def names(self, row: int, column: int) -> tuple[str, str]:
        """Names of the two icons of a cell; IndexError for a cell that there is not."""
        labels = self.labels
        if not (0 <= row < len(labels) and 0 <= column < len(labels)):
            raise IndexError(f"there is no cell {row + 1}, {column + 1} in a set of {len(labels)} icons")
        return labels[row], labels[column]

    def pair(self, a: str, b: str) -> PairScore:
        """The two icons' numbers and reasons; KeyError for icons that are no pair of it."""
        for pair in self.ranking.pairs:
            if {pair.a, pair.b} == {a, b}:
                return pair
        raise KeyError(f"{a} and {b} are not a pair of this set")


def rank_set(
    text: str,
    rig: Rig,
    people: int,
    parameters: int,
    reference: PerceptualMap | None = None,
    progress: Callable[[int, int], None] | None = None,
    observer: ObserverModel | None = None,
    known: Ranking | None = None,
) -> RankedSet:
    """Rank the set of a text; its map is laid onto the ``reference``. Raises ValueError where it cannot be.

    Where the ``observer`` has fewer draws than ``parameters``, all are used. ``known`` is the ranking without them,
    where it was made already.
    """
    began = time.perf_counter()
    reading = read_text(text)
    if (why := why_not(reading)) is not None or reading.icons is None:
        raise ValueError(why)
    draws = draws_of(observer, parameters)
    if known is None:
        made = rank(reading.icons, rig, people=people, parameters=draws, progress=progress, observer=observer)
    else:
        made = with_intervals(known, draws, step_counter(progress, draws)) if draws else known
    order = tuple(int(k) for k in clustered_order(made.d_prime))
    laid = map_of(made, reference) if len(made.icons) > 1 else None
    ms = 1e3 * (time.perf_counter() - began)
    return RankedSet(text, rig, tuple(reading.icons), made, laid, order, ms)


def draws_of(observer: ObserverModel | None, wanted: int = WELL[1]) -> int:
    """How many draws an interval rests on: as many as the observer has, but not one."""
    draws = wanted if observer is None else observer.most_draws(wanted)
    return 0 if draws == 1 else draws


def why_not(reading: Reading) -> str | None:
    """Why a text is not ranked, in one sentence; None where it can be."""
    if reading.icons is None:
        first = reading.troubles[0]
        more = len(reading.troubles) + reading.more - 1
        others = f", and {more} more {'error' if more == 1 else 'errors'}" if more else ""
        return f"the text has errors: line {first.line}, {first.headline}{others}"
    if len(reading.icons) == 0:
        return "there is no icon to rank: the set is empty"
    if len(reading.icons) > MOST_RANKED:
        fits = len(reading.icons) <= MOST_ICONS
        cure = "Workbench.ranking or thermicon rank does it" if fits else "narrow the family"
        return f"{len(reading.icons):,} icons are too many to rank while you wait (at most {MOST_RANKED}); {cure}"
    return None


def heat_frame(made: RankedSet, picked: tuple[str, str] | None, seq: int = 0) -> CanvasFrame:
    """The frame of both heat maps, near icons side by side."""
    order, labels = np.array(made.order), made.labels
    distances = made.ranking.d_prime[np.ix_(order, order)]
    confusions = made.ranking.confusion[np.ix_(order, order)]
    highest = max(float(distances.max()), 1e-9)
    meta = {
        "type": "frame",
        "view": "heat",
        "seq": seq,
        "labels": [short(name) for name in labels],
        "matrices": [
            {"key": "distance", "label": "distance (d′)", "buffer": 0, "unit": "", "low": 0, "high": highest,
             "text": "0.0", "terms": terms_of("d′")},
            {"key": "confusion", "label": "answered", "buffer": 1, "unit": "", "low": 0,
             "high": 1, "text": "0%", "terms": terms_of("confusion matrix")},
        ],
        "rough": f"rough: {made.ranking.people} people" if made.ranking.people < WELL[0] else "",
        "picked": None if picked is None else [labels.index(name) for name in picked],
        "ms": made.ms,
    }  # fmt: skip
    return CanvasFrame(meta, (distances.astype(np.float32).ravel(), confusions.astype(np.float32).ravel()))


def overlay_frame(made: RankedSet, nominal: Observer, a: str, b: str) -> CanvasFrame:
    """Two icons over each other on one clock: skin, sensation of cold and of warmth; one icon alone where a is b."""
    reading = read_text(made.text)
    icons = {icon.name: icon for icon in made.icons}
    drawn = {name: draw(icons[name], made.rig, nominal, reading) for name in dict.fromkeys((a, b))}
    clock = max((view.trace.time_s for view in drawn.values()), key=lambda time_s: time_s[-1])
    clock = clock[:: -(-len(clock) // MOST_POINTS)]
    buffers: list[Any] = []
    panels = []
    for key, title, height, role in PANELS:
        series = []
        for (name, view), (dash, width) in zip(drawn.items(), STYLES, strict=False):
            values = {"skin": view.trace.skin_C, "cold": view.percept.psi_cold, "warm": view.percept.psi_warm}[key]
            about = {"key": f"{key} {name}", "label": name, "buffer": len(buffers), "role": role}
            series.append({**about, "dash": dash, "width": width, "step": False})
            rows = min(len(values), len(view.trace.time_s))
            on_clock = np.interp(clock, view.trace.time_s[:rows], values[:rows], right=np.nan)
            buffers.append(on_clock.astype(np.float32))
        felt = key != "skin"
        about = {"digits": 1 if felt else 2, "terms": terms_of("d′", "sensation ψ") if felt else []}
        panels.append({"key": key, "label": title, "height": height, "series": series, **about})
    time = {"t0": 0.0, "dt": float(clock[1] - clock[0]), "n": len(clock)}
    meta = {"type": "frame", "view": "traces", "seq": 0, "time": time, "panels": panels, "notes": []}
    return CanvasFrame(meta, tuple(buffers))
