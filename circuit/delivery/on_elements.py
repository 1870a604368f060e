"""Export of icons on several elements with each track on each rig judged together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from thermicon.icons import Icon, SpatialIcon
from thermicon.icons.model.statements import Rest, Statement

from ..rig.layout import Layout
from ..rig.rig import Rig
from ..safety.demands import Demands
from ..safety.gate import Gate
from ..safety.repeated import check_pause
from ..safety.whole import Whole, judge_whole
from ..solver.simulate import duration_s
from .delivered_drive import DeliveredDrive
from .device import Device
from .formats import Format, FormatError
from .loads import loads_of
from .prepare import Judge, Prepared, judged_set
from .sinks import judged_rigs
from .ways import deliver, worst_cases

Course = tuple[tuple[Statement, ...], float]
"""What an element plays, and the time in s at which all elements end."""


@dataclass(frozen=True, slots=True)
class DeliveredTracks:
    """What each element of a layout plays of each icon; one that an icon leaves out rests as long."""

    layout: Layout
    icons: tuple[SpatialIcon, ...]
    tail_s: float = 0.0

    def of(self, icon: SpatialIcon, element: str) -> Icon:
        """The icon of one element."""
        still = Icon(icon.name, (Rest(icon.duration_s),), replace(icon.context, elements=()), icon.metadata)
        return icon.tracks.get(element, still)

    def course(self, icon: SpatialIcon, element: str) -> Course:
        """What tells the track of an element from others; no name is part of it."""
        return self.of(icon, element).statements, icon.duration_s + self.tail_s

    @property
    def distinct(self) -> dict[Course, Icon]:
        """Each track once."""
        every = [(icon, element.name) for icon in self.icons for element in self.layout.elements]
        return {self.course(*each): self.of(*each) for each in reversed(every)}


def prepare_elements(
    tracks: DeliveredTracks,
    device: Device,
    form: Format,
    *,
    judge: Judge = worst_cases,
    pause_s: float | None = None,
    step: Callable[[int, int], None] | None = None,
) -> tuple[tuple[Prepared, ...], ...]:
    """For each element each icon as delivered, with its verdict.

    On each distinct rig all distinct tracks are judged together, in any order, so that exchanged channels are covered.
    """
    check_pause(pause_s)
    form.check(device)
    if form.player is not None and form.elements_player is None:
        raise FormatError(
            f"{form.name}: its player plays one element, and one cut-off must stop them all; use psychopy, csv, tdms, "
            "setpoint-csv or tcs2-serial"
        )
    rigs = judged_rigs(tracks.layout, tracks.distinct.values(), device)
    delivered = _delivered(tracks, rigs.values(), device, step)
    played = {
        name: [
            replace(delivered[rig, tracks.course(icon, name)], icon=tracks.of(icon, name), element=name)
            for icon in tracks.icons
        ]
        for name, rig in rigs.items()
    }
    for together in zip(*played.values(), strict=True):  # refused before the gate, which takes longer
        if form.together is not None:
            form.together.write(together)
        for one in together if form.together is None else ():
            form.write(one)
    known: dict[tuple[Rig, Course], Prepared] = {}
    for rig in dict.fromkeys(rigs.values()):
        courses = [course for own, course in delivered if own == rig]
        drives = [delivered[rig, course] for course in courses]
        ready = judged_set(drives, _strictest(judge(drives, pause_s)))
        known |= {(rig, course): one for course, one in zip(courses, ready, strict=True)}
    return tuple(
        tuple(
            replace(known[rigs[name], tracks.course(icon, name)], delivery=one)
            for icon, one in zip(tracks.icons, drives, strict=True)
        )
        for name, drives in played.items()
    )


def _strictest(verdicts: Sequence[Gate]) -> Sequence[Gate]:
    """Verdicts on one rig, each with the demands of all: what keeps a track safe must be there if it is exchanged."""
    strict = Demands.strictest([verdict.demands for verdict in verdicts])
    return [
        replace(verdict, demands=replace(strict, faults=verdict.demands.faults))
        if isinstance(verdict, Gate) and verdict.safe
        else verdict
        for verdict in verdicts
    ]


def judged_together(layout: Layout, ready: Sequence[Sequence[Prepared]]) -> Whole | None:
    """The verdict on all elements together; None where an icon is not safe by itself."""
    if any(one.verdict.colour == "red" for own in ready for one in own):
        return None
    return judge_whole(layout, loads_of(ready))


def _delivered(
    tracks: DeliveredTracks, rigs: Iterable[Rig], device: Device, step: Callable[[int, int], None] | None
) -> dict[tuple[Rig, Course], DeliveredDrive]:
    """Every distinct track on every distinct rig of a layout as delivered."""
    delivered: dict[tuple[Rig, Course], DeliveredDrive] = {}
    each, distinct = tuple(dict.fromkeys(rigs)), tracks.distinct
    for rig in each:
        for course, track in distinct.items():
            tail_s = max(0.0, course[1] - duration_s(track, rig))
            delivered[rig, course] = deliver(track, rig, device, tail_s=tail_s)
            if step is not None:
                step(len(delivered), len(each) * len(distinct))
    return delivered
