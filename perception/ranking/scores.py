"""Scores of the icons and pairs of a set.

The score by rules is the share of rules passed, all with the same weight. Nothing in it comes from the model.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.words.number_text import decimals, significant

from ..criteria import DISTINGUISHABLE_DPRIME, FELT_FROM
from ..identification.episodes import remembered
from ..identification.tracks import Tracks
from ..observer.observer import CHANNELS, Channel, MemoryForm, Observer
from ..sensation.coverage import outside_data
from ..sensation.detection import channel_name
from ..sensation.features import attack_K_per_s, delay_s, peak_change_K
from ..sensation.percept import Percept
from .batches import PooledResult
from .by_element import PairInputs
from .reasons import DistanceComponent
from .rules_of_thumb import DISTINGUISHABLE, OURS, RuleResult, icon_rules

if TYPE_CHECKING:
    from thermicon.circuit import Trace

AT_RECEPTOR = ("change at the receptor", "rate at the receptor")
"""Rules that an icon passes which is felt."""


@dataclass(frozen=True, slots=True)
class IconScore:
    """One icon of a ranking: detection, onset, channel and proportion named are of the people, the rest is nominal.

    On several elements, changes at the receptors are of the element that changes most, rules of that detected most.

    Attributes
    ----------
    detected_probability
        Probability that a person drawn at random reports the icon, beyond reports of nothing, 0–1.
    onset_s, channel
        Median response time (s) of the trials that end in a report, and the channel that most reports go by; None where
        fewer than half of them do.
    peak_change_K, attack_K_per_s, delay_s
        Largest change in K, steepest rate in K/s, and delay behind the skin in s, at the cold and the warm receptor.
    proportion_correct, felt_and_named
        Share of trials with the right name, where an icon is announced; and share of plays that are reported and named
        correctly, where a play that is not felt is a miss, 0–1.
    reachable, safe, reason
        Whether the rig reaches the icon, whether no hard safety limit is exceeded, and why not; None where it is fine.
    rules, pairs
        Rules of thumb on the icon, and the pairs that it is in.
    cautions, outside_data
        Soft safety limits that it exceeds, and where no data support the prediction.
    duration_s, energy_J
        How long it lasts, s, and what the driver puts into the module until then, J; NaN on a thermode.
    where
        The elements that play it; empty on one element.
    """

    name: str
    detected_probability: float
    onset_s: float | None
    channel: Channel | None
    peak_change_K: tuple[float, float]
    attack_K_per_s: tuple[float, float]
    delay_s: tuple[float | None, float | None]
    proportion_correct: float
    felt_and_named: float
    reachable: bool
    safe: bool
    reason: str | None
    rules: tuple[RuleResult, ...]
    cautions: tuple[str, ...] = ()
    outside_data: tuple[str, ...] = ()
    duration_s: float = math.nan
    energy_J: float = math.nan
    where: tuple[str, ...] = ()
    pairs: tuple[PairScore, ...] = field(default=(), repr=False, compare=False)

    @property
    def rules_score(self) -> float:
        """Share passed of its rules and of its pairs."""
        return icon_score(self.rules, [(pair.rules_pass, pair.rules_margin) for pair in self.pairs])[0]

    @property
    def rules_margin(self) -> float | None:
        """The smallest normalised margin among them; None where nothing has one."""
        return icon_score(self.rules, [(pair.rules_pass, pair.rules_margin) for pair in self.pairs])[1]

    @property
    def playable(self) -> bool:
        """Whether the icon is safe and the rig reaches it."""
        return self.safe and self.reachable


@dataclass(frozen=True)
class PairScore:
    """One pair of icons, `a` and `b`: how far apart they are, how often they are confused, and why.

    `d_prime` is the median from memory over people, `confused_probability` the share of trials in which one is named as
    the other, the mean of both directions (0–1). `why` are reasons in words and `parts` components of the distance, for
    a nominal person. `rules_margin` is that by which `rules` separate the pair, in shares of a threshold; None: by
    direction alone. These four are made when they are read, of the two `places` of what is `compared`.
    """

    a: str
    b: str
    d_prime: float
    confused_probability: float
    places: tuple[int, int] = field(repr=False)
    compared: PairInputs = field(repr=False, compare=False)

    @property
    def why(self) -> tuple[str, ...]:
        """Reasons for the distance of the two, in sentences."""
        return self.compared.why(*self.places)

    @cached_property
    def rules(self) -> tuple[RuleResult, ...]:
        """Rules of thumb on the pair."""
        return self.compared.rules(*self.places)

    @property
    def rules_margin(self) -> float | None:
        """Margin by which rules separate the two."""
        return pair_margin(self.rules)

    @property
    def parts(self) -> tuple[DistanceComponent, ...]:
        """Components of the distance."""
        return self.compared.parts(*self.places)

    @property
    def rules_pass(self) -> bool:
        """Whether the two are distinguishable by rules alone."""
        return any(r.passed for r in self.rules if r.rule == DISTINGUISHABLE)


def counted(results: Iterable[RuleResult]) -> list[RuleResult]:
    """The results that a score by rules may use: those whose value does not come from the model."""
    return [r for r in results if not r.from_model]


def pair_margin(results: Iterable[RuleResult]) -> float | None:
    """Margin by which rules separate a pair: the largest normalised margin, since one rule suffices.

    Negative where no rule does; None where a rule without a size separates them, such as direction.
    """
    ours = [r for r in results if r.quantity in OURS]
    if any(r.passed and (r.quantity == "direction" or r.margin is None) for r in ours):
        return None
    margins = [m for r in ours if r.quantity != "direction" and (m := r.normalised_margin) is not None]
    return max(margins, default=-1.0)


def icon_score(icon: Sequence[RuleResult], pairs: Sequence[tuple[bool, float | None]]) -> tuple[float, float | None]:
    """Share passed of an icon's rules and of its pairs, and the smallest normalised margin of them.

    `pairs` holds (distinguishable, margin) of every pair it is in. Bands have no margin to compare. The margin
    is None where nothing has one.
    """
    own = counted(icon)
    passed = sum(r.passed for r in own) + sum(apart for apart, _ in pairs)
    sized = [r for r in own if r.threshold_low is None]
    margins = [r.normalised_margin for r in sized] + [margin for _, margin in pairs]
    known = [m for m in margins if m is not None]
    return passed / (len(own) + len(pairs)), min(known) if known else None


def disagreements(icons: Sequence[IconScore], pairs: Sequence[PairScore]) -> tuple[dict[str, Any], ...]:
    """Icons and pairs that rules and model judge differently, with both verdicts."""
    found: list[dict[str, Any]] = []
    for icon in icons:
        rules = all(r.passed for r in icon.rules if r.quantity in AT_RECEPTOR)
        model = icon.detected_probability >= FELT_FROM
        if rules != model:
            shown, limit = significant(icon.detected_probability, FELT_FROM, least=2)
            word = "detectable" if rules else "not detectable"
            side = "above" if model else "below"
            text = f"{icon.name}: rules: {word}; model: {shown} detected, {side} the {limit} criterion"
            found.append({"icon": icon.name, "rules": rules, "model": model, "text": text})
    for pair in pairs:
        model = pair.d_prime >= DISTINGUISHABLE_DPRIME
        if pair.rules_pass != model:
            word = "distinguishable" if pair.rules_pass else "not distinguishable"
            side = "above" if model else "below"
            d_prime = f"{pair.d_prime:.{decimals(pair.d_prime, DISTINGUISHABLE_DPRIME, 1)}f}"
            model_says = f"model: d′ {d_prime}, {side} the {DISTINGUISHABLE_DPRIME} criterion"
            text = f"{pair.a} and {pair.b}: rules: {word}; {model_says}"
            found.append({"a": pair.a, "b": pair.b, "rules": pair.rules_pass, "model": model, "text": text})
    return tuple(found)


def assemble(
    tracks: Tracks,
    traces: Sequence[Trace],
    durations_s: Sequence[float],
    percepts: Sequence[Percept],
    all_: PooledResult,
    memory: MemoryForm,
    observer: Observer,
) -> tuple[tuple[IconScore, ...], tuple[PairScore, ...]]:
    """Scores of all icons and of all pairs, in file order, from the traces of the tracks and what they feel like."""
    from thermicon.circuit.safety.verdict import judge_safety

    middle, pooled, detected, alert = all_.middle, all_.pooled, all_.detected, all_.each_felt_and_named.mean(axis=0)
    onsets, channels = all_.detection.onset_s, all_.detection.channel
    names = tracks.names
    compared = PairInputs(tracks, traces, percepts, remembered(percepts, observer), observer, memory)
    pairs = [
        PairScore(
            a=names[i],
            b=names[j],
            d_prime=float(middle[i, j]),
            confused_probability=float(0.5 * (pooled[i, j] + pooled[j, i])),
            places=(i, j),
            compared=compared,
        )
        for i, j in combinations(range(len(names)), 2)
    ]
    of_icon: dict[str, list[PairScore]] = {name: [] for name in names}
    for pair in pairs:
        of_icon[pair.a].append(pair)
        of_icon[pair.b].append(pair)
    scored = []
    for k, (name, lasting) in enumerate(zip(names, durations_s, strict=True)):
        played = tracks.of_icon(k)
        own = [traces[place] for _, place in played]
        most = max((place for _, place in played), key=lambda place: percepts[place].detected_probability)
        safety = [judge_safety(trace) for trace in own]
        objections = list[tuple[str, str]]()
        for (elements, _), verdict, trace in zip(played, safety, own, strict=True):
            objections += [(", ".join(elements), why) for why in (verdict.reason, trace.reason) if why]
        cold, warm = (max(own, key=lambda trace: abs(peak_change_K(trace, channel))) for channel in CHANNELS)
        scored.append(
            IconScore(
                name=name,
                detected_probability=float(detected[k]),
                onset_s=None if math.isnan(onsets[k]) else float(onsets[k]),
                channel=channel_name(int(channels[k])),
                peak_change_K=(peak_change_K(cold, "cold"), peak_change_K(warm, "warm")),
                attack_K_per_s=(attack_K_per_s(cold, "cold"), attack_K_per_s(warm, "warm")),
                delay_s=(delay_s(cold, "cold"), delay_s(warm, "warm")),
                proportion_correct=float(pooled[k, k]),
                felt_and_named=float(alert[k]),
                reachable=all(trace.reachable for trace in own),
                safe=all(verdict.safe for verdict in safety),
                reason="; ".join(f"on {where}: {why}" if where else why for where, why in objections) or None,
                cautions=tuple(dict.fromkeys(caution for verdict in safety for caution in verdict.cautions)),
                rules=icon_rules(traces[most], percepts[most]),
                outside_data=tuple(dict.fromkeys(said for trace in own for said in outside_data(trace))),
                duration_s=lasting,
                energy_J=math.fsum(energy_J(traces[place], lasting) for place in tracks.row(k)),
                where=tuple(element for elements, _ in played for element in elements),
                pairs=tuple(of_icon[name]),
            )
        )
    return tuple(scored), tuple(pairs)


def objection(trace: Trace, soft: bool = False) -> str | None:
    """Why an icon cannot be played: it is not safe, or the rig does not reach it; None where it can be played.

    With `soft` limits, one that passes any of them is objected to as well.
    """
    from thermicon.circuit.safety.verdict import judge_safety

    verdict = judge_safety(trace)
    if not verdict.safe:
        return f"is not safe: {verdict.reason}"
    if not trace.reachable:
        return f"is not reached: {trace.reason}"
    return next((f"is amber: {each}" for each in verdict.cautions), None) if soft else None


def energy_J(trace: Trace, until_s: float) -> float:
    """Energy (J) that the driver puts into the module until a time: ∫ V·I dt, with the current held between rows.

    NaN on a thermode, which states none.
    """
    if not trace.has_current:
        return math.nan
    steps = np.diff(np.minimum(trace.time_s, until_s))
    return float((trace.voltage_V[:-1] * trace.current_A[:-1] * steps).sum())


def worst_of(icons: Sequence[IconScore], pairs: tuple[PairScore, ...]) -> tuple[str, str] | None:
    """The pair most often confused of the icons that can be played, or of all where none can; equal ones by name."""
    fine = {icon.name for icon in icons if icon.playable}
    counting = [pair for pair in pairs if pair.a in fine and pair.b in fine] or pairs
    first = min(counting, key=lambda p: (-p.confused_probability, p.a, p.b), default=None)
    return None if first is None else (first.a, first.b)
