"""The cheapest edit that separates a pair.

An edit costs the |log| of the ratio of the new number to the old, plus a tenth for every second that it adds, so that
a second is worth about 10 % of a number. Candidates are tried on the nominal person at the range and clock of the set,
by bisection for every number in both directions; the cheapest one that the virtual people confirm is returned.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.near_words import did_you_mean
from thermicon.icons import Icon, parse

from ..criteria import DISTINGUISHABLE_DPRIME
from ..identification.carry_over import prepare_task
from ..identification.population import memory_dprime, run_end_s
from ..identification.task import USUAL, Task
from ..kernels.cluster import on_cluster
from ..observer.people import People
from ..ranking.collected import collect_batches
from ..ranking.ranking import Ranking
from .appraise import population_response
from .candidate_edits import CandidateEdit, Rejections, Screening, offers, worse
from .pool import POOL_HZ, Pool

LARGEST, FARTHEST = 4.0, 256.0
"""A number becomes at most four times larger or smaller; where that separates no pair, up to 256 times."""
MOST_NEAR, NEAR = 5, 3.0
"""Up to 5 icons that an edit brings nearer are checked with people, if they end within three times the wanted d′."""
MOST_CONFIRMED = 8
"""Edits that are checked with people before the search gives up."""
MOST_RECOUNTED = 50
"""People who meet the set, and whose episodes are counted, again with the edit."""
ROUNDING = 0.005
"""Felt and named is printed in whole per cent: an edit that changes it by no more than half of one is none."""
EDITS = ("worst", "all", "none")


@dataclass(frozen=True, slots=True)
class Edit:
    """One line of one icon, `old` and `new`, and the icon after it, `edited`.

    `cost` is |log| of the ratio of the new number to the old, plus a tenth for every second that it adds, of which
    there are `added_s`; `d_prime` the median of the pair after the edit. `recounted` is the share of people who
    remember another number of episodes after it; between 0 and 1 some gain much and others little.
    """

    icon: str
    old: str
    new: str
    cost: float
    added_s: float
    d_prime: float
    edited: Icon
    recounted: float = 0.0

    @property
    def text(self) -> str:
        """One line: old → new, and the resulting d′ of the pair."""
        added = f", {self.added_s:+.1f} s" if abs(self.added_s) >= 0.05 else ""
        return f"{self.icon}: {self.old} → {self.new}{added}: d′ {self.d_prime:.1f}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`."""
        told = {name: getattr(self, name) for name in ("icon", "old", "new", "cost", "added_s", "d_prime")}
        return {**told, "recounted_share": self.recounted}


@dataclass(frozen=True, slots=True)
class NoEdit:
    """Why no single edit is offered, in one sentence."""

    reason: str


@checked
def cheapest_edit(ranking: Ranking, a: str, b: str, *, wanted: float = DISTINGUISHABLE_DPRIME) -> Edit | NoEdit:
    """Find the cheapest edit of one of two icons that separates them by a median d′.

    Every edit that is offered is read back from its text, simulated, safe and reachable, and makes no other pair worse
    by more than 0.1 d′ below twice `wanted`, and raises felt and named of the set by more than half a point.
    The people of the ranking confirm it, in its task.

    Parameters
    ----------
    ranking
        The set as it was ranked.
    a, b
        Names of the two.
    wanted
        Median d′ to be reached; by default that of a distinguishable pair.

    Returns
    -------
    Edit or NoEdit
        The edit, or why there is none.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> cheapest_edit(ranking, "cooling-step", "warming-step").reason
    'the pair is distinguishable already: d′ ..., criterion 2.56'
    """
    if not 0 < wanted < math.inf:
        raise ValueError(f"a pair is separated by a d′ above 0, not {wanted:g}")
    if a == b:
        raise ValueError(f"a pair is two icons, not {a} twice")
    names = ranking.labels
    for name in (a, b):
        if name not in names:
            raise InputError(f"no icon is called {name!r}; {did_you_mean(name, names)}")
    i, j = names.index(a), names.index(b)
    if (apart := ranking.d_prime[i, j]) >= wanted:
        return NoEdit(f"the pair is distinguishable already: d′ {apart:.1f}, criterion {wanted:.3g}")
    return _searched(ranking, (i, j), wanted)


def cheapest_edits(
    ranking: Ranking, which: str = "worst", workers: int | str | None = None
) -> dict[tuple[str, str], Edit | NoEdit]:
    """An edit, by names, for the `worst` pair, for `all` that are not distinguishable, or for `none`.

    Each is sought on a worker of its own where `workers` is the address of a cluster.
    """
    if which not in EDITS:
        raise ValueError(f"edits are of {', '.join(EDITS)}, not {which!r}")
    near = [(p.a, p.b) for p in ranking.pairs if which == "all" and p.d_prime < DISTINGUISHABLE_DPRIME]
    worst = [] if ranking.worst_pair is None or which == "none" else [ranking.worst_pair]
    pairs = list(dict.fromkeys([*near, *worst]))

    def edit(number: int) -> Edit | NoEdit:
        return cheapest_edit(ranking, *pairs[number])

    if not isinstance(workers, str):
        return {pair: edit(number) for number, pair in enumerate(pairs)}
    found = dict(on_cluster(edit, len(pairs), workers, f"{ranking.job.key}-{which}"))
    return {pair: found[number] for number, pair in enumerate(pairs)}


def _searched(ranking: Ranking, pair: tuple[int, int], wanted: float) -> Edit | NoEdit:
    """The cheapest offer that people confirm; each one that they do not confirm moves the target of the next."""
    (i, j), job, before, nominal = pair, ranking.job, ranking.d_prime, ranking.model.nominal
    kept = Pool.of(job.icons, job.rig, nominal)
    now = kept.dprimes(kept, job.forms[0], nominal)
    screening, rejected = Screening(kept, now, pair, wanted, job.forms[0], nominal), Rejections()
    crowd = ranking.model.people(job.people, job.seed)
    target = wanted * now[i, j] / before[i, j] if now[i, j] > 0 and before[i, j] > 0 else wanted
    largest, confirmed = LARGEST, 0.0
    refused: set[tuple[int, str]] = set()

    def untried() -> list[CandidateEdit]:
        return [edit for edit in offers(screening, target, largest, rejected) if (edit.place, edit.new) not in refused]

    for _ in range(MOST_CONFIRMED):
        offered = untried()
        if not offered and largest < FARTHEST:
            largest = FARTHEST  # icons that nobody feels need more than four times a number
            offered = untried()
        if not offered:
            break
        edit = offered[0]
        end_s = max(kept.end_s, run_end_s([float(kept.durations_s[edit.place]) + edit.added_s], POOL_HZ))
        parted, harmed = _with_people(ranking, screening, edit, crowd, end_s)
        if parted >= wanted and not harmed and parse(str(edit.icon))[edit.icon.name].statements == edit.icon.statements:
            # In batches, as the set itself was ranked: of many icons and people at once there is no room.
            people = min(job.people, MOST_RECOUNTED)
            few = replace(job, members=tuple(_edited(ranking, edit)), end_s=end_s, people=people)
            new = collect_batches(few, 1, lambda: None).felt_and_named
            gain = float(new.mean() - ranking.felt.felt_and_named[: few.people].mean())
            if gain <= ROUNDING:
                return NoEdit(f"separating them changes felt and named of the set by {100 * gain:+.1f} points only")
            recounted = _recounted(ranking, edit, crowd, end_s)
            return Edit(edit.icon.name, edit.old, edit.new, edit.cost, edit.added_s, parted, edit.icon, recounted)
        rejected.opposed |= harmed
        refused.add((edit.place, edit.new))
        if parted < wanted:
            confirmed = max(confirmed, parted)
            target *= 1.002 * min(wanted / max(parted, 1e-6), 1.5)
    if rejected.opposed:
        reason = "each one that separates them makes another pair worse"
    else:
        # A nominal person short of the target is people short of what is wanted: rounding up would say otherwise.
        reached = math.floor(10.0 * max(confirmed, rejected.closest * wanted / target)) / 10.0
        most = f"with numbers up to {largest:g} times larger or smaller"
        reason = f"the largest d′ of a safe and reachable one, {most}, is about {reached:.1f}"
    return NoEdit(f"no single edit separates them to d′ {wanted:.3g}: {reason}")


def _with_people(
    ranking: Ranking, screening: Screening, one: CandidateEdit, crowd: People, end_s: float
) -> tuple[float, bool]:
    """Median d′ of the pair with an edit, and whether another pair becomes worse, for the people of the ranking."""
    job, before, nominal = ranking.job, ranking.d_prime, ranking.model.nominal

    def medians(icons: Sequence[Icon], task: Task) -> Array:
        batches, found = replace(job, members=tuple(icons), end_s=end_s), []
        for number in range(batches.batches):
            some = crowd.part(*batches.span(number))
            felt, _ = population_response(icons, job.rig, some, job.tracking, end_s=end_s, observer=nominal)
            found.append(memory_dprime(felt, job.forms[0], some.memory, nominal, task))
        return np.asarray(np.median(np.concatenate(found), axis=0))

    i, j = screening.pair
    if job.task.gap_s is None:
        # Icons that the edit brings nearer for the nominal person, those that end nearest.
        row, now, most = one.apart, screening.now[one.place], NEAR * screening.wanted
        nearer = [k for k in range(len(row)) if k not in screening.pair and row[k] < now[k] and row[k] < most]
        near = sorted(nearer, key=lambda k: (float(row[k]), k))[:MOST_NEAR]
        others = [j if one.place == i else i, *near]
        after = medians([one.icon, *(job.icons[k] for k in others)], USUAL)[0, 1:]
        return float(after[0]), bool(worse(before[one.place, others[1:]], after[1:], screening.wanted).any())
    # The range, and what is left behind, move every pair of the set.
    edited = _edited(ranking, one)
    task, _ = prepare_task(job.task, edited, job.rig, end_s, job.task.counted, job.tracking, nominal)
    after = medians(edited, task)
    rest = np.triu(np.ones_like(after, dtype=bool), 1)
    rest[min(i, j), max(i, j)] = False
    return float(after[i, j]), bool(worse(before[rest], after[rest], screening.wanted).any())


def _edited(ranking: Ranking, one: CandidateEdit) -> list[Icon]:
    return [one.icon if k == one.place else icon for k, icon in enumerate(ranking.job.icons)]


def _recounted(ranking: Ranking, one: CandidateEdit, crowd: People, end_s: float) -> float:
    """Share of the first people whose number of episodes of the icon changes with the edit."""
    job, few = ranking.job, crowd.part(0, min(len(crowd), MOST_RECOUNTED))
    felt, _ = population_response(
        [job.icons[one.place], one.icon],
        job.rig,
        few,
        job.tracking,
        rate_Hz=POOL_HZ,
        end_s=end_s,
        observer=ranking.model.nominal,
    )
    before, after = felt.episodes.counts.T
    return float((before != after).mean())
