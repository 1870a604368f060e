"""Rank a set: icons on a rig → percepts → confusions → a ranking."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.program import own_version

from ..arrays import Array
from ..identification.carry_over import CarryOver, prepare_task, task_among
from ..identification.laboratory import DRAWS, Nominal, new_laboratory
from ..identification.map import spread_over_people
from ..identification.run_end import RATE_HZ, run_end_s
from ..identification.task import USUAL, Task
from ..kernels.parallel import beside
from ..observer.channels import USUAL_NORM
from ..observer.observer import Norm, check_norm
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from ..progress import Progress, step_counter
from ..selection.choose import Choice, choose
from ..selection.goal import NEEDS_DRAWS, Goal, GoalError
from ..selection.goal_result import judge_goal
from ..selection.pair_edits import with_edits
from ..selection.request import Selection, check_selection, energy_J, objection
from ..sensation.percept import perceive
from .assemble import assemble, playable_pairs, worst_of
from .assumptions import assumptions_of
from .batches import Execution, Job, PooledResult, collect_batches
from .outcome import outcome_of_choice, outcome_of_set
from .ranking import Ranking
from .rule_score import disagreements, worst_by_rules
from .rules import rig_rules

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet

RANKED_BY = ("model", "rules")
EDITS = ("worst", "all", "none")


def rank(
    icons: IconSet,
    rig: Rig,
    *,
    people: int = 200,
    seed: int = 0,
    trials: int = 48,
    tracking: str | None = None,
    norm: str = USUAL_NORM,
    by: str = "model",
    parameters: int | None = None,
    choosing: Selection | None = None,
    goal: Goal | str | None = None,
    edits: str = "none",
    task: Task = USUAL,
    observer: ObserverModel | Path | str | None = None,
    warnings: tuple[str, ...] = (),
    workers: int | None = None,
    cluster: str | None = None,
    keep: Path | None = None,
    progress: Progress | None = None,
) -> Ranking:
    """Predict how well people identify the icons of a set from memory.

    Every icon is simulated to one common end, the longest icon plus 10 s, on the nominal rig and on that of each
    virtual person. The d′ of a pair is the median over people. Icons that are not safe or not reached are ranked last.

    Parameters
    ----------
    icons
        The set.
    rig
        The rig that plays it.
    people, seed
        Number of virtual people, and the seed they and all noise are drawn from.
    trials
        Trials of the predicted experiment.
    tracking
        `replay`, `display` or `ideal` (None: what suits the control of each icon).
    norm
        How episodes are remembered: `episodes` (compared in logarithms) or `naming` (as ratings, each trial named
        directly).
    by
        `model`, or `rules`: then rules of thumb alone rank the icons, and the model reports only where it disagrees.
    parameters
        Draws from the posterior of the constants, for the intervals that a new laboratory will find (None: 128, or as
        many as the observer has; 0: none).
    choosing
        Request for the best subset; the intervals are then those of the chosen icons.
    goal
        What is wanted of the set, or of what is chosen, as a `Goal` or its text; None: nothing in particular.
    edits
        Find the cheapest edit of the `worst` pair, of `all` pairs that are not distinguishable, or of `none`.
    task
        The identification task: memory noise that follows the range of the set, a short gap, favoured names.
    observer
        Another posterior or observer in place of the shipped one: `ObserverModel`, or its file. One without draws
        gives no intervals for a new laboratory.
    warnings
        What was said of files and rig before, to be kept with the result.
    workers, cluster
        Threads (None: one per core), or the address of the scheduler of a dask cluster.
    keep
        Folder that keeps finished batches, so that an interrupted run continues from them.
    progress
        Called with (steps done, steps in all).

    Returns
    -------
    Ranking
        The same bytes for the same arguments, wherever the work is done.

    Raises
    ------
    ValueError
        For a set without icons, unknown names, a single draw, and a choice that cannot be made.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> ranking.worst_pair
    ('warming-step', 'linear-warming')
    """
    from thermicon.circuit.solver.simulate import duration_s, simulate_all

    members = list(icons)
    if not members:
        raise ValueError("there is no icon to rank: the set is empty")
    chosen = check_norm(norm)
    if by not in RANKED_BY:
        raise ValueError(f"a ranking is by {' or '.join(RANKED_BY)}, not by {by!r}")
    if edits not in EDITS:
        raise ValueError(f"edits are of {', '.join(EDITS)}, not {edits!r}")
    if choosing is not None:
        check_selection(choosing, [icon.name for icon in members])
    wanted = Goal.parse(goal) if isinstance(goal, str) else goal
    model = ObserverModel.of(observer)
    draws = model.draw_count(parameters, DRAWS) * (by == "model")
    if wanted is not None and choosing is not None:
        wanted.check_count(choosing.count)
    if wanted is not None and wanted.single_people and not draws:
        raise GoalError(NEEDS_DRAWS)
    execution = Execution(workers, cluster, keep)
    nominal, crowd = model.nominal, model.people(people, seed)
    durations = [duration_s(icon, rig) for icon in members]
    end = run_end_s(durations)
    traces = list(simulate_all(members, rig, end_s=end, rate_Hz=RATE_HZ))
    fine = [] if task.plain else [k for k, trace in enumerate(traces) if objection(trace) is None]
    task, left = prepare_task(task, members, rig, end, fine, tracking, nominal)
    job = Job(tuple(members), rig, end, people, seed, trials, tracking, chosen, task, model.for_jobs())
    report = step_counter(progress, 2 + job.batches + draws + (choosing is not None))
    percepts = [perceive(trace, nominal) for trace in traces]
    report()

    all_ = collect_batches(job, execution, report)
    made = assemble(members, traces, percepts, all_, chosen, nominal)
    counted = playable_pairs(made)
    worst = worst_of(counted) if by == "model" else worst_by_rules(counted)
    # One edit takes as long as the draws, mostly on one core; more of them would keep an interrupted run waiting.
    edited = beside(
        lambda: with_edits(edits, made.pairs, worst, members, rig, crowd, tracking, chosen, all_.middle, task, nominal),
        workers if edits == "worst" else 1,
    )
    picked = None
    if choosing is not None:
        picked = choose(
            choosing,
            members,
            rig,
            traces,
            all_.d_prime,
            crowd,
            seed=seed,
            tracking=tracking,
            norm=chosen,
            task=task,
            left=left,
            observer=nominal,
        )
        report()
    elsewhere = None
    if draws and picked is None:
        whole = Nominal(
            float(all_.correct.mean()), float(all_.bits.mean()), all_.detected, all_.middle, all_.detection.onset_s
        )
        elsewhere = new_laboratory(
            all_.thin, crowd, whole, chosen, model=model, draws=draws, seed=seed, task=task, step=report
        )
    elif draws and picked is not None:
        picked = _with_interval(
            picked, [icon.name for icon in members], all_, crowd, chosen, model, draws, seed, (task, left), report
        )
    pairs = edited()
    energies = [energy_J(trace, lasting) for trace, lasting in zip(traces, durations, strict=True)]
    reached = None
    if wanted is not None:
        outcome = outcome_of_set(made, all_, durations, energies, worst, elsewhere)
        reached = judge_goal(wanted, outcome if picked is None else outcome_of_choice(outcome, picked))
    ranking = Ranking(
        version=own_version(),
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        seed=seed,
        people=people,
        tracking=_tracking(members, tracking),
        by=by,
        norm=chosen,
        content_hash=_hash(icons, rig, model),
        observer=model.name,
        own_laboratory=model.posterior is not None and model.posterior.one_laboratory,
        rig_text=rig.toml,
        persons=tuple(all_.correct.tolist()),
        total_s=math.fsum(durations),
        total_J=math.fsum(energies),
        goal=reached,
        warnings=warnings,
        assumptions=assumptions_of(all_.correct, crowd, rig, nominal, None if elsewhere is None else elsewhere.each)
        if by == "model"
        else None,
        icons=made.icons,
        pairs=pairs,
        confusion=all_.pooled,
        proportion_correct=float(all_.correct.mean()),
        proportion_correct_interval=_interval(all_.correct),
        information_bits=float(all_.bits.mean()),
        information_bits_interval=_interval(all_.bits),
        bits_per_s=float(all_.bits.mean()) / (sum(durations) / len(durations)),
        information_bits_plugin=float(all_.plugin.mean()),
        trials=trials,
        worst_pair=worst,
        rules_disagree=disagreements(made.icons, made.pairs),
        by_norm={norm: tuple(each.tolist()) for norm, each in all_.by_norm.items()},
        stress=float(np.median(all_.stress)),
        standard_error=all_.standard_error,
        person_standard_error=all_.person_standard_error,
        rules=rig_rules(rig),
        new_laboratory=elsewhere,
        chosen=picked,
        spread=spread_over_people(all_.d_prime, all_.each_correct),
        task=task,
        carry_over=left,
    )
    report()
    return ranking


def _tracking(icons: Sequence[Icon], asked: str | None) -> str:
    from thermicon.circuit.solver.batch import usual_tracking

    return asked or ", ".join(sorted({usual_tracking(icon) for icon in icons}))


def _with_interval(
    picked: Choice,
    names: Sequence[str],
    all_: PooledResult,
    crowd: People,
    norm: Norm,
    model: ObserverModel,
    draws: int,
    seed: int,
    asked: tuple[Task, CarryOver | None],
    step: Callable[[], None],
) -> Choice:
    """A choice with the intervals for a new laboratory: of the chosen, since nobody will name all of the pool."""
    places = [names.index(name) for name in picked.icons]
    own = picked.at_own_range
    middle = all_.middle[np.ix_(places, places)]
    alone = Nominal(
        own.proportion_correct, own.information_bits, all_.detected[places], middle, all_.detection.onset_s[places]
    )
    found = new_laboratory(
        all_.thin.of(places),
        crowd,
        alone,
        norm,
        model=model,
        draws=draws,
        seed=seed,
        task=task_among(*asked, places),
        step=step,
    )
    return replace(picked, new_laboratory=found)


def _interval(values: Array) -> tuple[float, float]:
    low, high = np.percentile(values, [2.5, 97.5])
    return float(low), float(high)


def _hash(icons: IconSet, rig: Rig, model: ObserverModel) -> str:
    """Hash of everything that was ranked: the icons' canonical text, the rig and the observer's file."""
    held = "\0".join([str(icons), rig.document, model.digest])
    return hashlib.sha256(held.encode("utf-8")).hexdigest()
