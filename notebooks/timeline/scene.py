"""The scene of the design view: a cue text on a rig as data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from thermicon.base.words.number_text import number, percent
from thermicon.circuit import InputError, Rig, Trace, simulate
from thermicon.circuit.safety.verdict import SafetyVerdict, judge_safety
from thermicon.circuit.solver.inverse import baseline_C
from thermicon.circuit.solver.simulate import duration_s
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import CueErrors, Icon
from thermicon.perception import Observer, Percept, perceive

from ..editing.cue_check import MOST_NAMES, Reading, Trouble, read_text, trouble_of
from .handles import MOST_HANDLES, Handle, handles_of
from .marks import EventTime, Span, event_times_of, missed_spans

TAIL_S = 10.0
"""Seconds of sensation simulated after the last corner, as in ``thermicon simulate --figure``."""
RATE_HZ, MOST_ROWS = 100.0, 30_000
"""Samples per second, and their largest number: longer runs have a lower rate."""
Colour = Literal["green", "amber", "red", "grey"]


@dataclass(frozen=True, slots=True)
class Badge:
    """Safety in one line, with its colour and all findings in ``more``; grey if nothing is judged."""

    colour: Colour
    text: str
    more: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Drawing:
    """One icon played on a rig for an observer, with everything that is drawn."""

    icon: Icon
    rig: Rig
    trace: Trace
    percept: Percept
    verdict: SafetyVerdict
    missed: tuple[Span, ...]
    moments: tuple[EventTime, ...]
    handles: tuple[Handle, ...]
    start: float


@dataclass(frozen=True, slots=True)
class Scene:
    """Content of the design view: names, errors, the chosen icon, notes, and its drawing.

    ``stale``: the drawing is of an earlier text or rig, since this one has none. ``start`` of the drawing is the level
    that its icon begins at (°C or A). Without a drawing there was nothing to draw yet.

    >>> from thermicon.circuit import Rig
    >>> made = scene("cue 1; icon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s }", Rig.load("thenar"))
    >>> made
    Scene('dip' of 1 on thenar, green)
    >>> scene("cue 1; icon dip { cool by 6 at 3 °C/s }", Rig.load("thenar"), before=made).troubles[0].code
    'E102'
    """

    text: str
    rig: Rig
    icon: str | None
    names: tuple[str, ...]
    count: int
    troubles: tuple[Trouble, ...]
    notes: tuple[str, ...]
    stale: bool
    drawing: Drawing | None

    @property
    def badge(self) -> Badge:
        """Safety of what is written now: a stale drawing is not judged."""
        if self.stale or self.drawing is None:
            cause = "the text has errors" if self.troubles else self.notes[0] if self.notes else "there is no icon"
            return Badge("grey", f"safety not judged: {cause}")
        if not (findings := self.drawing.verdict.findings):
            return Badge("green", "limits kept: in this simulation (export judges worst cases)")
        first = findings[0]
        unit = "" if first.unit == "1" else f" {first.unit}"
        side = "above" if first.upper else "below"
        kind = "not safe" if first.severity == "hard" else "caution"
        what = f"{kind}: {first.quantity} {number(first.value, 2)}{unit} at {first.time_s:.2f} s, {side}"
        limit = f"the {first.severity} limit of {number(first.limit, 2)}{unit}, in this simulation"
        colour: Colour = "red" if self.drawing.verdict.colour == "red" else "amber"
        return Badge(colour, f"{what} {limit}", tuple(map(str, findings)))

    def __repr__(self) -> str:
        count = len(self.troubles)
        said = f", {count} {'error' if count == 1 else 'errors'}" if count else ", stale" if self.stale else ""
        return f"Scene({self.icon!r} of {self.count} on {self.rig.name}, {self.badge.colour}{said})"


def scene(
    text: str,
    rig: Rig,
    icon: str | None = None,
    observer: Observer | None = None,
    before: Scene | None = None,
    notes: Sequence[str] = (),
) -> Scene:
    """Return the scene of a text on a rig, for the icon of a name, or else for the one that stands in its place.

    The drawing of the scene ``before`` stays, as ``stale``, where there is nothing new. Raises nothing for what a
    person may type or set.
    """
    wanted = icon if icon is not None or before is None else before.icon
    reading = read_text(text)
    names, count, drawing = ((), 0, None) if before is None else (before.names, before.count, before.drawing)
    person = Observer.load() if observer is None else observer
    shown = Scene(text, rig, wanted, names, count, reading.troubles, _once(notes), True, drawing)
    if reading.icons is None:
        return _counted(shown, reading.more)
    chosen, remarks = _chosen(reading, wanted, before)
    count, names = len(reading.icons), reading.names
    if count > MOST_NAMES:
        remarks.append(f"{count:,} icons; the first {MOST_NAMES} are listed, Workbench(…, icon=NAME) shows any other")
        names = names if chosen.name in names else (*names, chosen.name)
    shown = replace(shown, icon=chosen.name, names=names, count=count, notes=_once([*notes, *remarks]))
    try:
        drawing = draw(chosen, rig, person, reading)
    except CueErrors as wrong:  # with the rest of this rig a target lies on the wrong side
        return _counted(replace(shown, troubles=tuple(map(trouble_of, wrong.errors))), wrong.more)
    except (InputError, ValueError, ArithmeticError) as wrong:
        told = (f"not drawn: {line}" for line in str(wrong).splitlines()[:3])
        return replace(shown, notes=_once([*shown.notes, *told]))
    told_on = _notes_on(drawing, reading, rig)
    return replace(shown, notes=_once([*shown.notes, *told_on]), stale=False, drawing=drawing)


def draw(icon: Icon, rig: Rig, observer: Observer, reading: Reading) -> Drawing:
    """Play one icon and judge it; raises what simulation raises: RigError, CueErrors, ValueError."""
    lasts = duration_s(icon, rig)
    rate = RATE_HZ if (lasts + TAIL_S) * RATE_HZ <= MOST_ROWS else float(MOST_ROWS // (lasts + TAIL_S + 1.0))
    end = math.ceil((lasts + TAIL_S) * rate - 1e-6) / rate  # on the beat, so that the clock is uniform
    trace = simulate(icon, rig, rate_Hz=rate, tail_s=end - lasts)
    percept = perceive(trace, observer)
    base = baseline_C(icon, rig)
    start = steady_state(rig, "display", base)[0] if icon.context.control == "current" else base
    return Drawing(
        icon=icon,
        rig=rig,
        trace=trace,
        percept=percept,
        verdict=judge_safety(trace),
        missed=missed_spans(icon, trace, rig),
        moments=event_times_of(trace, percept),
        handles=handles_of(icon, reading.family_of(icon.name), start),
        start=start,
    )


def with_notes(made: Scene, *notes: str) -> Scene:
    """The scene with notes put before its own, such as why a drag was refused."""
    return replace(made, notes=_once([*notes, *made.notes]))


def _chosen(reading: Reading, wanted: str | None, before: Scene | None) -> tuple[Icon, list[str]]:
    """The icon of a name; where it is gone, the one in its place, or the first, and a sentence that says so."""
    assert reading.icons is not None
    found = reading.find(wanted)
    if found is not None:
        return found, []
    first = reading.icons.icons[0]
    if wanted is None:
        return first, []
    if before is not None and before.count == len(reading.icons) and wanted in before.names:
        first = reading.icons.icons[min(before.names.index(wanted), len(reading.icons) - 1)]
        return first, [f"{wanted} is now called {first.name}"]
    return first, [f"no icon is called {wanted}; {first.name} is shown"]


def _counted(made: Scene, more: int) -> Scene:
    """The scene with how many more errors there are than are listed."""
    said = [f"and {more} more {'error' if more == 1 else 'errors'}"] if more else []
    return replace(made, notes=_once([*made.notes, *said]))


def _notes_on(drawing: Drawing, reading: Reading, rig: Rig) -> list[str]:
    """Notes on a drawing: why it is not reached, site, unusual values, limits of the data."""
    trace, notes = drawing.trace, []
    if trace.reason is not None:
        verb = "not reached: it" if trace.outcome is not None else "not played as written:"
        notes.append(f"{drawing.icon.name} is {verb} {trace.reason}")
    site = reading.icons.context.site if reading.icons is not None else None
    if site is not None and site != rig.site:
        notes.append(f"the set is for the site {site}, the rig {rig.name} is for {rig.site}")
    if not drawing.percept.felt:
        share = percent(drawing.percept.detected_probability)
        notes.append(f"{drawing.icon.name} is not felt by the nominal person, who reports it in {share} of trials")
    if len(drawing.handles) == MOST_HANDLES:
        notes.append(f"only the first {MOST_HANDLES} corners can be dragged")
    return [*notes, *trace.warnings, *drawing.percept.outside_data]


def _once(notes: Sequence[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(notes))
