"""A share of the export evidence on random drives."""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from tests.circuit.delivery.adversarial import Case, some_case
from tests.circuit.delivery.exported_files import Course, read_file, sidecar_in
from tests.circuit.delivery.followed import followed, followed_in_order
from tests.circuit.delivery.independent import Json
from tests.circuit.delivery.one_drive import Judge
from tests.circuit.delivery.replay import Held, Player, Skin, Worst, in_any_order, judged, shown
from thermicon.circuit.delivery.formats import Format, FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.prepare import Prepared

PER_PART = 100
LOOKED_AT = 6
"""One in so many refused drives is replayed as well, to see how many were refused though they are safe."""
LAGS_S = (0.12, 0.21, 0.32)


@dataclass
class Told:
    """What a part counted, what of it was unsafe, and margins (K, or tenths of a rate or dose) of what was refused."""

    counts: Counter[str] = field(default_factory=Counter)
    unsafe: list[str] = field(default_factory=list)
    refused_margins: list[float] = field(default_factory=list)

    def add(self, other: Told) -> None:
        """Add another part."""
        self.counts += other.counts
        self.unsafe += other.unsafe
        self.refused_margins += other.refused_margins


def replayed(files: Mapping[str, bytes], stems: list[str], rng: np.random.Generator) -> Worst:
    """Replay the files of one export: each by itself with several pauses, and those of a set in any order."""
    worst, told = Worst(), [sidecar_in(files, stem) for stem in stems]
    rig, played = told[0]["rig"]["document"], [read_file(files, stem) for stem in stems]
    least = max(float(each["hardware_must_prevent"]["pause_at_least_s"] or 0.0) for each in told)
    judged_s = float(told[0]["safety"]["repeated"]["pause_s"])
    if any(each["safety"]["shortest_pause_s"] is None for each in told):
        least = judged_s
    other = float(np.exp(rng.uniform(np.log(max(least, 0.5)), np.log(600))))
    pauses = sorted({least, judged_s, round(other, 2)})
    chain = [float(rng.choice([least, other, rng.uniform(least, least + 20)])) for _ in range(6)]
    for course in played:
        if isinstance(course, Course):
            as_shown(rig, course, pauses, rng, worst)
            if course.held:
                followed(rig, course, [judged_s, least], rng, worst)
    regulated = [one for one in played if isinstance(one, Course) and one.held]
    if len(regulated) > 1:
        order = [(int(rng.integers(len(regulated))), float(rng.choice([judged_s, least]))) for _ in range(6)]
        followed_in_order(rig, regulated, order, rng, worst)
    currents = [one for one in played if isinstance(one, Held)]
    player = Player(rig, rng) if currents else None
    for held in currents:
        assert player is not None
        judged(player, held, pauses, chain, worst)
    if len(currents) > 1:
        assert player is not None
        order = [(int(rng.integers(len(currents))), float(rng.choice([judged_s, other]))) for _ in range(12)]
        in_any_order(player, currents, [(which, max(pause, least)) for which, pause in order], worst)
    return worst


def as_shown(rig: Json, course: Course, pauses: list[float], rng: np.random.Generator, worst: Worst) -> None:
    """A display that is prescribed: a thermode's, or the set-points of a controller, exactly reached, without rates."""
    skin = Skin(rig, rng)
    if not course.held:
        shown(skin, course.display_C, course.step_s, pauses, (LAGS_S[1], float(rng.choice(LAGS_S))), worst)
        return
    fine = max(1, int(np.ceil(course.step_s / 0.01 - 1e-9)))
    levels = np.append(np.repeat(course.display_C[:-1], fine), course.display_C[-1])
    shown(skin, levels, course.step_s / fine, pauses, (), worst, rates=False, held=True)


def run_part(part: int, count: int = PER_PART, gate: Judge | None = None, look: int = LOOKED_AT) -> Told:
    """Judge the drives of a part, and replay all that is written, and some of what is not."""
    found, number = Told(), 0
    with tempfile.TemporaryDirectory() as folder:
        while found.counts["judged"] < count:
            rng = np.random.default_rng([21, part, number])
            case = some_case(rng, number, Path(folder), gate)
            number += 1
            if case is None:
                found.counts["cannot be played at all"] += 1
                continue
            found.counts["judged"] += len(case.ready)
            form, device = load_format(case.form), case.ready[0].delivery.device
            kind = f"{device.name.split('-')[0]} {case.form}"
            found.counts["gated " + kind] += 1
            _follow(case, form, found, rng, part, look, kind)
    return found


def _follow(case: Case, form: Format, found: Told, rng: np.random.Generator, part: int, look: int, kind: str) -> None:
    safe = [one for one in case.ready if all(each.forcible for each in one.refusals)]
    for one in case.ready:
        found.counts[one.verdict.colour] += 1
        if one not in safe:
            found.counts["refused: " + str(one.verdict.reason).split(" reaches")[0]] += 1
            if "repeated plays" in str(one.verdict.reason):
                found.counts["refused for repetition"] += 1
    try:
        if not safe:
            if rng.random() < 1 / look:
                ready = [replace(one, refusals=()) for one in case.ready]
                found.refused_margins.append(_replay(ready, form, rng).margin)
            return
        worst = _replay(safe, form, rng)
    except FormatError:
        found.counts["format cannot hold it"] += len(safe)
        return
    found.counts["written"] += len(safe)
    found.counts["written " + kind] += len(safe)
    if worst.unsafe:
        where = {rule: worst.world[rule] for rule in worst.unsafe}
        found.unsafe.append(f"part {part}: {worst.unsafe} in {where}: {case!r}; {case.ready[0].verdict!r}")


def _replay(ready: list[Prepared], form: Format, rng: np.random.Generator) -> Worst:
    files = pack(ready, form)
    stems = [form.stem(one.delivery.icon.name) for one in ready]
    return replayed(files, stems, rng)
