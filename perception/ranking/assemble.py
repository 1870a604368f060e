"""Scores of icons and pairs from what people felt: the parts of a ranking, before anything is said of the set."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ..identification.episodes import remembered
from ..observer.observer import Norm, Observer
from ..sensation.coverage import outside_data
from ..sensation.detection import channel_name
from ..sensation.features import attack_K_per_s, delay_s, peak_change_K
from ..sensation.percept import Percept
from .batches import PooledResult
from .distance_components import components_of
from .reasons import pair_reasons
from .rules import icon_rules, pair_rules
from .scores import IconScore, PairScore, icon_score, pair_margin

if TYPE_CHECKING:
    from thermicon.circuit import Trace
    from thermicon.icons import Icon


@dataclass(frozen=True, slots=True)
class Assembled:
    """Scores of all icons and of all pairs, in file order."""

    icons: tuple[IconScore, ...]
    pairs: tuple[PairScore, ...]


def assemble(
    icons: Sequence[Icon],
    traces: Sequence[Trace],
    durations_s: Sequence[float],
    percepts: Sequence[Percept],
    all_: PooledResult,
    norm: Norm,
    observer: Observer,
) -> Assembled:
    """Score every icon and every pair."""
    middle, pooled, detected = all_.middle, all_.pooled, all_.detected
    onsets, channels = all_.detection.onset_s, all_.detection.channel
    pairs = []
    episodes = remembered(percepts, observer)
    for i, j in combinations(range(len(icons)), 2):
        why = pair_reasons(traces[i], traces[j], percepts[i], percepts[j], observer, norm, episodes, (i, j))
        rules = pair_rules(traces[i], traces[j])
        pairs.append(
            PairScore(
                a=icons[i].name,
                b=icons[j].name,
                d_prime=float(middle[i, j]),
                confused_probability=float(0.5 * (pooled[i, j] + pooled[j, i])),
                why=tuple(reason.text for reason in why),
                rules=rules,
                rules_margin=pair_margin(rules),
                parts=components_of(episodes, i, j, observer),
            )
        )
    of_icon: dict[str, list[PairScore]] = {icon.name: [] for icon in icons}
    for pair in pairs:
        of_icon[pair.a].append(pair)
        of_icon[pair.b].append(pair)
    scored = []
    for k, (icon, trace, lasting, percept) in enumerate(zip(icons, traces, durations_s, percepts, strict=True)):
        safe, reason, cautions = _verdict(trace)
        own = icon_rules(trace, percept)
        share, margin = icon_score(own, [(pair.rules_pass, pair.rules_margin) for pair in of_icon[icon.name]])
        scored.append(
            IconScore(
                name=icon.name,
                detected_probability=float(detected[k]),
                onset_s=None if math.isnan(onsets[k]) else float(onsets[k]),
                channel=channel_name(int(channels[k])),
                peak_change_K=(peak_change_K(trace, "cold"), peak_change_K(trace, "warm")),
                attack_K_per_s=(attack_K_per_s(trace, "cold"), attack_K_per_s(trace, "warm")),
                delay_s=(delay_s(trace, "cold"), delay_s(trace, "warm")),
                proportion_correct=float(pooled[k, k]),
                reachable=bool(trace.reachable),
                safe=safe,
                reason=reason,
                cautions=cautions,
                rules=own,
                rules_score=share,
                rules_margin=margin,
                outside_data=outside_data(trace),
                duration_s=lasting,
                energy_J=energy_J(trace, lasting),
            )
        )
    return Assembled(tuple(scored), tuple(pairs))


def _verdict(trace: Trace) -> tuple[bool, str | None, tuple[str, ...]]:
    """Safe, every reason why it is not safe or cannot be played, and what is amber: soft limits that it passes."""
    from thermicon.circuit.safety.limits import judge_safety

    safety = judge_safety(trace)
    objection = [reason for reason in (safety.reason if not safety.safe else None, trace.reason) if reason]
    amber = tuple(str(finding) for finding in safety.findings if finding.severity != "hard")
    return bool(safety.safe), "; ".join(objection) or None, amber


def objection(trace: Trace) -> str | None:
    """Why an icon cannot be played: it is not safe, or the rig does not reach it; None where it can be played."""
    from thermicon.circuit.safety.limits import judge_safety

    verdict = judge_safety(trace)
    if not verdict.safe:
        return f"is not safe: {verdict.reason}"
    if not trace.reachable:
        return f"is not reached: {trace.reason}"
    return None


def energy_J(trace: Trace, until_s: float) -> float:
    """Energy (J) that the driver puts into the module until a time: ∫ V·I dt, with the current held between rows.

    NaN on a thermode, which states none.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import read_cue
    >>> trace = simulate(read_cue("six-icons")["cooling-step"], Rig.load("thenar"))
    >>> energy_J(trace, 4.0) < energy_J(trace, 8.0)
    True
    """
    if not trace.has_current:
        return math.nan
    steps = np.diff(np.minimum(trace.time_s, until_s))
    return float((trace.voltage_V[:-1] * trace.current_A[:-1] * steps).sum())


def playable_pairs(made: Assembled) -> tuple[PairScore, ...]:
    """The pairs of icons that can be played; all pairs where there is none of them."""
    fine = {icon.name for icon in made.icons if icon.playable}
    return tuple(pair for pair in made.pairs if pair.a in fine and pair.b in fine) or made.pairs


def worst_of(pairs: Sequence[PairScore]) -> tuple[str, str] | None:
    """The pair most often confused; equal ones by name."""
    if not pairs:
        return None
    first = min(pairs, key=lambda p: (-p.confused_probability, p.a, p.b))
    return first.a, first.b
