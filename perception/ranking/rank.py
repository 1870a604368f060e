"""Rank a set: icons on a rig → percepts → confusions → a ranking."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from typing import Unpack

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.numbers.program import own_version
from thermicon.circuit.rig.layout import AnyLayout, Layout
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.rigfile import RigError
from thermicon.icons import IconSet, SpatialIcon
from thermicon.icons.files.shipped import Icons, set_of

from ..identification.carry_over import prepare_task
from ..identification.new_laboratory import DRAWS, Nominal, new_laboratory
from ..identification.population import RATE_HZ, run_end_s
from ..identification.task import USUAL, Task
from ..identification.tracks import Members, Tracks
from ..kernels.kept_parts import kept_until_done
from ..kernels.parallel import Progress, step_counter
from ..observer.observer_model import EVERYBODY, Crowd, CrowdWords
from ..sensation.percept import perceive
from .batches import TRIALS, Job
from .collected import collect_batches
from .ranking import Ranking
from .rules_of_thumb import rig_rules
from .scores import assemble, objection, worst_of


@kept_until_done()
@checked
def rank(
    icons: Icons,
    rig: AnyLayout = None,
    *,
    crowd: Crowd = EVERYBODY,
    trials: int = TRIALS,
    parameters: int | None = None,
    task: Task = USUAL,
    workers: int | str | None = None,
    progress: Progress | None = None,
    **words: Unpack[CrowdWords],
) -> Ranking:
    """Predict how well people identify the icons of a set from memory.

    Every icon is simulated to one common end, the longest icon plus 10 s, on the nominal rig and on that of each
    virtual person. The d′ of a pair is the median over people. Icons that are not safe or not reached are ranked last.

    Parameters
    ----------
    icons
        The set, its name or file, or its icons.
    rig
        The rig, or its name or file; None: the shipped rig of the icons' site, else thenar. For icons on several
        elements a layout that has them on surfaces apart, or its name or file.
    crowd
        Who feels and remembers the icons.
    trials
        Trials of the predicted experiment.
    parameters
        Draws from the posterior of the constants, for the intervals that a new laboratory will find (None: 128, or as
        many as the observer has; 0: none).
    task
        The identification task, which may have so short a gap between icons that the previous one is still felt.
    workers
        Threads (None: one per core), or the address of the scheduler of a dask cluster.
    progress
        Called with (steps done, steps in all).
    **words
        Single words of the crowd, such as ``people=50``.

    Returns
    -------
    Ranking
        The same bytes for the same arguments, wherever the work is done.

    Raises
    ------
    ValueError
        For a set without icons, unknown names, a single draw, a layout that lacks an element or has them on one piece
        of skin, and a gap between icons on several elements.

    See Also
    --------
    choose, judge_goal, cheapest_edit : What to ask of a ranking next.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> ranking.worst_pair
    ('warming-step', 'linear-warming')
    """
    from thermicon.circuit.solver.simulate import duration_s, simulate_all

    icons, crowd = set_of(icons, spatial=True), crowd.but(**words)
    layout, model = Layout.of(rig, icons.context.site), crowd.model
    members: Members = icons.spatial if icons.spatial else tuple(icons)
    if icons.spatial:
        _check_apart(icons, layout, task)
    draws = model.draw_count(parameters, DRAWS)
    if isinstance(workers, int) and workers < 1:
        raise ValueError(f"at least one worker is needed, not {workers}")
    nominal = model.nominal
    tracks = Tracks.of(members, layout)
    durations = [
        icon.duration_s if isinstance(icon, SpatialIcon) else duration_s(icon, layout.alone) for icon in members
    ]
    end = run_end_s(durations)
    traces = [trace for rig, own in tracks.by_rig for trace in simulate_all(list(own), rig, end_s=end, rate_Hz=RATE_HZ)]
    if task.gap_s is None:
        task, left = USUAL, None
    else:
        fine = [k for k, trace in enumerate(traces) if objection(trace) is None]
        task, left = prepare_task(task, list(icons), layout.alone, end, fine, crowd.tracking, nominal)
    job = Job.of(members, layout, crowd, end, trials, task)
    report = step_counter(progress, 2 + job.batches + draws)
    percepts = [perceive(trace, nominal) for trace in traces]
    report()

    felt = collect_batches(job, workers, report)
    scored, pairs = assemble(tracks, traces, durations, percepts, felt, job.forms[0], nominal)
    ranking = Ranking(
        version=own_version(),
        content_hash=hashlib.sha256("\0".join([str(icons), layout.document, model.digest]).encode("utf-8")).hexdigest(),
        digests={**digests_of(icons, layout), "observer": model.digest},
        job=job,
        model=model,
        felt=felt,
        icons=scored,
        pairs=pairs,
        worst_pair=worst_of(scored, pairs),
        rules=tuple(rule for rig, _ in tracks.by_rig for rule in rig_rules(rig)),
        carry_over=left,
    )
    report()
    return with_intervals(ranking, draws, report, workers) if draws else ranking


def _check_apart(icons: IconSet, layout: Layout, task: Task) -> None:
    """Raise an InputError, with a cure, for a layout and a task that icons on several elements are not ranked with."""
    layout.check_elements(icons.context.elements)
    if layout.surfaces == "one":
        here = f"the elements of {layout.name or 'this layout'} are on one piece of skin"
        cure = 'take elements that are apart (surfaces = "apart"), such as those of wheel'
        raise RigError(f'{here} (surfaces = "one"), where places are not predicted yet: {cure}')
    if task.gap_s is not None:
        told = "what an icon leaves behind for the next is not predicted on several elements yet"
        raise InputError(f"{told}: leave out the gap of the task")


def digests_of(icons: IconSet, rig: Rig | Layout) -> dict[str, str]:
    """SHA-256 of the canonical text of icons, and of a rig with its changes, or a layout."""
    held = {"icons": str(icons), "rig": rig.document}
    return {name: hashlib.sha256(text.encode("utf-8")).hexdigest() for name, text in held.items()}


def with_intervals(
    ranking: Ranking, draws: int, step: Callable[[], None] | None = None, workers: int | str | None = None
) -> Ranking:
    """A ranking with what a new laboratory will find, from draws of the posterior; `step` is called after each.

    They are computed on all cores, or on the cluster whose address `workers` is.
    """
    job, felt, model = ranking.job, ranking.felt, ranking.model
    onsets = felt.detection.onset_s
    scores, confused = (ranking.proportion_correct, ranking.information_bits), 0.5 * (felt.pooled + felt.pooled.T)
    whole = Nominal(*scores, felt.detected, felt.middle, onsets, confused, felt.each_felt_and_named.mean(axis=0))
    crowd = model.people(job.people, job.seed)
    cluster = (workers, f"{job.key}-{draws}") if isinstance(workers, str) else None
    found = new_laboratory(
        job.tracks, job.end_s, crowd, whole, job.memory,
        tracking=job.tracking, model=model, draws=draws, seed=job.seed, task=job.task, step=step,
        cluster=cluster,
    )  # fmt: skip
    return replace(ranking, new_laboratory=found)
