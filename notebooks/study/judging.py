"""The judgement of a study's drives and sessions."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from thermicon.base.checks.arguments import advised
from thermicon.circuit import Device, Export, Rig, Session, SessionPlan, export, play_session, simulate_current
from thermicon.circuit.safety.exposure import cem43_min
from thermicon.circuit.safety.playmap import UnjudgedError
from thermicon.circuit.safety.sessionplay import WorstCase, drive_of, worst_case_of
from thermicon.icons import Icon
from thermicon.perception.identification.exported import felt_in

from .schedule import Schedule
from .study_file import Study, StudyError
from .timing import Gap

NUMBER = re.compile(r"\d+(\.\d+)?")
ALL_JUDGED = 4
"""Participants up to whom every session is judged in all corners; of more, those whose run is the most extreme."""

KEYS: Mapping[str, Callable[[float], str]] = {"pause_s": "timing.gap_s = {:g}".format}
"""How a study file writes what to change."""
Progress = Callable[[int, int], None]


class StudyRefused(Exception):
    """A study that is not safe, or whose drives are refused; `reasons` say why, one a line."""

    def __init__(self, reasons: Sequence[str]) -> None:
        super().__init__("\n".join(reasons))
        self.reasons = tuple(reasons)


@dataclass(frozen=True, slots=True)
class JudgedStudy:
    """Drives that may be written, the gap between them, and the sessions judged in the worst case, by participant.

    `drift_K` is the largest of the baseline; `after_breaks` the blocks, each from rest; both may be empty.
    """

    ready: Export
    gap: Gap
    sessions: Mapping[str, Session]
    drift_K: Mapping[str, float]
    after_breaks: Mapping[str, WorstCase] = field(default_factory=dict)

    @property
    def cautions(self) -> tuple[str, ...]:
        """Soft limits that a session exceeds, each once with whose sessions; those after breaks where they are new."""
        whose: dict[str, tuple[str, list[str]]] = {}
        for label, session in self.sessions.items():
            for text in session.cautions:
                whose.setdefault(NUMBER.sub("#", text), (text, []))[1].append(label)
        lines = [
            f"session of participant {first}{' (alike ' * bool(others)}{', '.join(others)}{')' * bool(others)}: {text}"
            for text, (first, *others) in whose.values()
        ]
        for label, blocks in self.after_breaks.items():
            known = {(finding.quantity, finding.upper) for finding in self.sessions[label].findings}
            new = [each for each in blocks.findings if (each.quantity, each.upper) not in known]
            lines += [f"blocks of participant {label}, each from rest: {finding}" for finding in new]
        return tuple(lines)


def judge_drives(
    icons: Sequence[Icon], rig: Rig, study: Study, gap: Gap, device: Device, step: Progress | None = None
) -> tuple[Export, Gap]:
    """Deliver and judge every drive, repeated in any order with the gap; a derived gap grows until that is safe."""
    stimuli, timing = study.stimuli, study.timing

    def prepared(pause_s: float) -> Export:
        try:
            return export(icons, rig, device, stimuli.format, pause_s=pause_s, felt=felt_in, step=step)
        except UnjudgedError as problem:
            raise StudyRefused([str(problem)]) from None

    ready = prepared(gap.gap_s)
    if timing.gap_s is None:
        longer = _longer_gap(ready, gap, timing.wait_for_skin)
        if longer != gap:
            ready, gap = prepared(longer.gap_s), longer
    if ready.refused:
        raise StudyRefused([f"{name}: {advised(one.text, one.changes, KEYS)}" for name, one in ready.refused])
    return ready, gap


def _longer_gap(ready: Export, gap: Gap, wait_for_skin: bool) -> Gap:
    """The gap that the gate asks for, where it is longer; carry-over is only less then."""
    wanted = [
        (one.verdict.repeated.shortest_pause_s or 0.0, "the shortest pause that is safe") for one in ready.prepared
    ]
    for one in ready.prepared if wait_for_skin else ():
        if one.verdict.repeated.recovery_s is None:
            raise StudyError(
                "timing.wait_for_skin: after an icon the skin needs more than 10 min to return; leave it out, or take "
                "smaller or shorter icons"
            )
        back = "skin and display are back within 0.1 K in every corner"
        wanted.append((one.verdict.repeated.recovery_s, back))
    longest, why = max(wanted)
    return replace(gap, gap_s=longest, reason=why) if longest > gap.gap_s else gap


def judge_sessions(
    courses: Sequence[Schedule], icons: Sequence[Icon], rig: Rig, held: bool, gap_s: float, step: Progress | None = None
) -> tuple[dict[str, Session], dict[str, float], dict[str, WorstCase]]:
    """Judge whole sessions in the worst case; return them, every participant's drift of the baseline, and the blocks.

    Every order is run on the rig as given; in all corners those of up to four participants, or the most extreme ones.
    Where there are breaks, each is run without them, and with every block from rest. Raises StudyRefused if one is red.
    """
    if rig.thermode is not None:
        return {}, {}, {}
    tracking, known = "display" if held else "replay", {icon.name: icon for icon in icons}
    extremes: dict[str, tuple[float, ...]] = {}
    for course in courses:
        whole = _nominal(course.order, known, rig, gap_s, tracking)
        parts = [_nominal(order, known, rig, gap_s, tracking) for order in course.sittings] if course.breaks else []
        extremes[course.label] = _farthest(whole, parts)
    chosen = [course for course in courses if course.label in _extreme(extremes)]
    sessions: dict[str, Session] = {}
    after_breaks: dict[str, WorstCase] = {}
    for done, course in enumerate(chosen):
        sessions[course.label] = play_session(icons, SessionPlan(course.order, gap_s), rig, tracking=tracking)
        if course.breaks:
            blocks = [drive_of(SessionPlan(order, gap_s), known, rig, tracking) for order in course.sittings]
            after_breaks[course.label] = worst_case_of(blocks, rig, rig.limits)
        if step is not None:
            step(done + 1, len(chosen))
    red = [
        f"session of participant {label}: NOT SAFE: {session.reason}"
        for label, session in sessions.items()
        if session.verdict == "red"
    ]
    red += [
        f"blocks of participant {label}, each from rest: NOT SAFE: {worst.findings[0]}"
        for label, worst in after_breaks.items()
        if worst.colour == "red" and sessions[label].verdict != "red"
    ]
    if red:
        raise StudyRefused(red)
    return sessions, {label: values[3] for label, values in extremes.items()}, after_breaks


def _farthest(
    whole: tuple[float, float, float, float], parts: Sequence[tuple[float, ...]]
) -> tuple[float, float, float, float]:
    """Coldest and warmest skin and most dose of a run and of its blocks from rest; the drift is that of the run."""
    if not parts:
        return whole
    coldest, warmest, dose, _ = zip(*parts, strict=True)
    return min(whole[0], *coldest), max(whole[1], *warmest), max(whole[2], sum(dose)), whole[3]


def _nominal(
    order: tuple[str, ...], known: Mapping[str, Icon], rig: Rig, gap_s: float, tracking: str
) -> tuple[float, float, float, float]:
    """Coldest and warmest skin in °C, dose in min CEM43 and largest drift in K of an order on the rig as given."""
    played = drive_of(SessionPlan(order, gap_s), known, rig, tracking)
    trace = simulate_current(played.drive, rig, rate_Hz=played.rate_Hz, start_C=played.start_C)
    before = trace.skin_C[np.rint(np.array(played.starts_s) * played.rate_Hz).astype(np.int64)] - trace.skin_C[0]
    drift = float(before[np.abs(before).argmax()])
    dose = float(cem43_min(trace.time_s, trace.skin_C)[-1])
    return float(trace.skin_C.min()), float(trace.skin_C.max()), dose, drift


def _extreme(values: Mapping[str, tuple[float, ...]]) -> set[str]:
    """Labels of the participants whose sessions are judged in all corners."""
    if len(values) <= ALL_JUDGED:
        return set(values)
    outermost: tuple[Callable[[tuple[float, ...]], float], ...]
    outermost = (lambda run: -run[0], lambda run: run[1], lambda run: run[2], lambda run: abs(run[3]))
    return {max(values, key=lambda label: far(values[label])) for far in outermost}
