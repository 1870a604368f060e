"""Two versions of a set side by side, as data: one icon of both on one clock, both rankings, and what was changed."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.perception.observer.people import YOUNG_YEARS

from ..editing.cue_check import read_text
from ..files.kept_draft import KeptVersion
from ..timeline.frames import CanvasFrame, traces_of
from ..timeline.overlaid import STYLES, series_of, values_on
from ..timeline.terms import terms_of

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception import Observer, Ranking
    from thermicon.perception.observer.observer_model import ObserverModel
    from thermicon.perception.selection.goal import Goal
    from thermicon.perception.selection.goal_result import GoalResult

    from ..report.set_report import SetReport
    from .set_model import RankedSet

PEOPLE, DRAWS = 200, 128
"""People of both rankings, the same in both; draws of the parameters, where a goal needs them."""
MOST_LINES = 14
PANELS = (
    ("skin", "temperature", "skin", "skin (°C)", "ink", 1.3),
    ("current", "current", "current", "current (A)", "ink", 0.8),
    ("cold", "sensation", "cold", "felt as cold (d′)", "cool", 0.9),
    ("warm", "sensation", "warm", "felt as warm (d′)", "warm", 0.9),
)
"""Key, panel and series of the design view, title, role and height of every panel."""


@dataclass(frozen=True, slots=True)
class Version:
    """A state of the workbench: text, the icon that is shown, the rig as chosen, and the knobs set on it.

    ``rig`` has the knobs set, and ``observer`` their age; ``model`` is what predicts, None: the shipped observer.
    """

    text: str
    icon: str | None
    nominal: Rig
    rig: Rig
    observer: Observer = field(compare=False)
    values: Mapping[str, float | str] = field(default_factory=dict)
    model: ObserverModel | None = field(default=None, compare=False)

    @property
    def rig_words(self) -> str:
        """The rig with its changes, in words."""
        return ", ".join((self.rig.name, *self.rig.changes))

    def to_kept(self) -> KeptVersion:
        """The version as it is kept beside unsaved text."""
        return KeptVersion(
            text=self.text,
            icon=self.icon,
            rig=self.nominal.toml,
            rig_changes=self.nominal.changes,
            values=dict(self.values),
        )

    @classmethod
    def of_kept(cls, kept: KeptVersion, model: ObserverModel | None = None) -> Version:
        """The version that was kept, predicted by the observer of the workbench that restores it.

        A ValueError where this release no longer knows its rig or its knobs.
        """
        from thermicon.circuit import Rig, RigError

        from .knobs import apply

        with TemporaryDirectory() as folder:
            file = Path(folder) / "version-a.toml"
            file.write_text(kept.rig, encoding="utf-8")
            try:
                nominal = replace(Rig.load(file), changes=kept.rig_changes)
                applied = apply(nominal, kept.values, None if model is None else model.nominal)
            except (RigError, KeyError) as wrong:
                why = str(wrong.args[0]).replace(f"{file}: ", "").replace("\n", "; ")
                raise ValueError(f"version A cannot be restored: {why}") from None
        return cls(kept.text, kept.icon, nominal, applied.rig, applied.observer, dict(kept.values), model)


@dataclass(frozen=True, slots=True)
class RankedVersions:
    """Rankings of A and B with the same virtual people; None for a version that cannot be ranked, with its reason.

    `goals` are how both meet a goal, None without one.
    """

    a: Ranking | None
    b: Ranking | None
    reasons: tuple[str, str]
    goals: tuple[GoalResult | None, GoalResult | None]

    @property
    def gain(self) -> tuple[float, tuple[float, float]] | None:
        """Proportion correct of B minus A: its mean, and the 95 % interval over people, person by person."""
        if self.a is None or self.b is None:
            return None
        each = np.array(self.b.persons) - np.array(self.a.persons)
        low, high = np.quantile(each, (0.025, 0.975))
        return float(each.mean()), (float(low), float(high))


def rank_versions(
    a: Version, b: Version, goal: Goal | None, known: dict[Any, RankedSet], progress: Callable[[int, int], None]
) -> RankedVersions:
    """Rank both versions; ``known`` keeps rankings that are needed again while the other version is edited."""
    from thermicon.circuit import InputError

    from .set_model import rank_set

    draws = DRAWS if goal is not None and goal.single_people else 0
    reports: list[SetReport | None] = []
    reasons = []
    keys = [(each.text, each.rig, goal) for each in (a, b)]
    for each, key in zip((a, b), keys, strict=True):
        try:
            if key not in known:
                known[key] = rank_set(
                    each.text, each.rig, PEOPLE, draws, progress=progress, goal=goal, observer=each.model
                )
        except (InputError, ValueError) as wrong:
            reports.append(None)
            reasons.append(str(wrong))
        else:
            reports.append(known[key].report)
            reasons.append("")
    for key in [key for key in known if key not in keys]:
        del known[key]
    first, second = ((None, None) if each is None else (each.ranking, each.goal) for each in reports)
    return RankedVersions(first[0], second[0], (reasons[0], reasons[1]), (first[1], second[1]))


def both_frame(a: Version, b: Version) -> CanvasFrame:
    """One icon in both versions on one clock, and the difference of their skin temperatures.

    It is the one that is shown in B, or else the first that was changed. Where a version does not have it, the frame
    holds the other alone and says so.
    """
    from thermicon.circuit import InputError
    from thermicon.icons import CueErrors

    notes, parts = [], []
    icon = changed_icon(a, b)
    for letter, each in zip("AB", (a, b), strict=True):
        try:
            part = _traces(each, icon)
        except (CueErrors, InputError, ValueError, ArithmeticError) as wrong:
            notes.append(f"{letter} is not drawn: {str(wrong).splitlines()[0]}")
        else:
            if part is None:
                notes.append(f"{letter} has no icon {icon}")
            else:
                parts.append((letter, part))
    time, panels, buffers = _panels(parts)
    if panels:
        panels[0]["label"] = f"{icon}: {panels[0]['label']}"
    meta = {"type": "frame", "view": "traces", "seq": 0, "time": time, "panels": panels, "notes": notes}
    return CanvasFrame(meta, tuple(buffers))


def changed_icon(a: Version, b: Version) -> str | None:
    """Name of the icon that is shown in B; the first one of B that differs from A where that one does not.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.perception import Observer
    >>> rig, person = Rig.load("thenar"), Observer.load()
    >>> texts = [f"cue 1; icon a {{ hold for 1 s }}; icon b {{ hold for {n} s }}" for n in (1, 2)]
    >>> changed_icon(*(Version(text, "a", rig, rig, person) for text in texts))
    'b'
    """
    sets = [read_text(each.text).icons for each in (a, b)]
    if sets[0] is None or sets[1] is None or a.rig != b.rig:
        return b.icon
    before = {icon.name: icon for icon in sets[0]}
    changed = [icon.name for icon in sets[1] if before.get(icon.name) != icon]
    return changed[0] if changed and b.icon not in changed else b.icon


def changed_lines(a: Version, b: Version) -> list[tuple[str, str]]:
    """Lines that only one version has, each with ``A``, ``B`` or a blank for a gap; rigs first where they differ.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.perception import Observer
    >>> rig, person = Rig.load("thenar"), Observer.load()
    >>> first, second = (Version(f"cue 1\\nicon a {{ hold for {n} s }}", "a", rig, rig, person) for n in (1, 2))
    >>> changed_lines(first, second)
    [('A', 'icon a { hold for 1 s }'), ('B', 'icon a { hold for 2 s }')]
    """
    rows = []
    if a.rig_words != b.rig_words:
        rows += [("A", f"rig {a.rig_words}"), ("B", f"rig {b.rig_words}")]
    if a.values.get("age") != b.values.get("age"):
        ages = (("A", a.values.get("age", YOUNG_YEARS)), ("B", b.values.get("age", YOUNG_YEARS)))
        rows += [(letter, f"age {age:g} years") for letter, age in ages]
    for line in difflib.ndiff(a.text.splitlines(), b.text.splitlines()):
        if line[:2] in ("- ", "+ ") and line[2:].strip():
            rows.append(("A" if line[0] == "-" else "B", line[2:].strip()))
    more = len(rows) - MOST_LINES
    return rows if more <= 1 else [*rows[:MOST_LINES], ("", f"and {more} more lines")]


def _traces(version: Version, icon: str | None) -> CanvasFrame | None:
    from ..timeline.scene import draw

    reading = read_text(version.text)
    if reading.icons is None:
        raise ValueError(f"its text has errors, line {reading.troubles[0].line}: {reading.troubles[0].headline}")
    found = reading.find(icon)
    return None if found is None else traces_of(draw(found, version.rig, version.observer, reading))


def _panels(parts: list[tuple[str, CanvasFrame]]) -> tuple[dict[str, Any], list[dict[str, Any]], list[Any]]:
    """Clock, panels and arrays of the versions that can be drawn."""
    if not parts:
        return {"t0": 0.0, "dt": 0.0, "n": 0}, [], []
    clocks = [part.meta["time"] for _, part in parts]
    step = max(clock["dt"] for clock in clocks)
    clock = step * np.arange(max(round(each["dt"] * (each["n"] - 1) / step) for each in clocks) + 1)
    panels: list[dict[str, Any]] = []
    buffers: list[Any] = []
    for key, panel, series, title, role, height in PANELS:
        curves = {letter: values_on(part, panel, series, clock) for letter, part in parts}
        drawn = [
            series_of(letter, letter, values, role, STYLES["AB".index(letter)], buffers)
            for letter, values in curves.items()
            if values is not None
        ]
        if drawn:
            about = {"digits": 1, "terms": terms_of("d′", "sensation ψ")} if panel == "sensation" else {"digits": 2}
            panels.append({"key": key, "label": title, "height": height, "series": drawn, **about})
        if key == "skin" and len(drawn) == 2:
            gap = series_of("gap", "B − A", curves["B"] - curves["A"], "focus", ([], 1.75), buffers)
            panels.append({"key": "gap", "label": "skin, B − A (K)", "height": 0.7, "series": [gap], "digits": 2})
    return {"t0": 0.0, "dt": step, "n": len(clock)}, panels, buffers
