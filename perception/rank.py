"""The main job: icons on a rig → what people feel → who is confused with whom → a ranking."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.perception.confusion import SAMPLES, Confusion, confuse
from thermicon.perception.detection import detect
from thermicon.perception.digits import decimals, significant
from thermicon.perception.distance import differences, identification_dprime
from thermicon.perception.features import attack_K_per_s, delay_s, peak_change_K
from thermicon.perception.measures import information_bits, percent_correct, plugin_bits
from thermicon.perception.observer import DATA, NORMS, Norm, Observer, check_norm
from thermicon.perception.people import People, draw_people
from thermicon.perception.percept import Percept, perceive, perceive_many, uniform_clock
from thermicon.perception.ranking import IconScore, PairScore, Ranking
from thermicon.perception.reasons import pair_reasons
from thermicon.perception.receptors import Array
from thermicon.perception.rules import icon_rules, pair_rules, passes

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon, IconSet

RATE_HZ = 100.0
TAIL_S = 10.0
EXPERIMENTS = 20
APART_DPRIME = 2.563
"""The model calls a pair apart from here on: two icons on their own would be named 90 % correctly, Φ(d′/2) = 0.9."""
FELT = 0.9
RANKED_BY = ("model", "rules")

Progress = Callable[[int, int], None]


def rank(
    icons: IconSet,
    rig: Rig,
    *,
    people: int = 200,
    seed: int = 0,
    trials: int = 48,
    tracking: str | None = None,
    norm: str = "max",
    by: str = "model",
    progress: Progress | None = None,
) -> Ranking:
    """Predict how well people tell the icons of a set apart when they name them from memory.

    Every icon is simulated to one common end, the longest icon plus 10 s, on the nominal rig and on
    that of each virtual person. `tracking` is `replay`, `display` or `ideal` (None: what suits the
    icon's control); `norm` is `max`, `rms` or `integral`; `by` orders the rows. `progress` is called
    with (steps done, steps in all). A pair's d′ is the median over people. Same arguments, same bytes.
    Raises `ValueError` for a set without icons and for unknown names.
    """
    from thermicon.circuit import duration_s, simulate_all, simulate_many

    members = list(icons)
    if not members:
        raise ValueError("there is no icon to rank: the set is empty")
    chosen = check_norm(norm)
    if by not in RANKED_BY:
        raise ValueError(f"a ranking is by {' or '.join(RANKED_BY)}, not by {by!r}")
    report = _steps(progress, 4)
    observer = Observer.load()
    crowd = draw_people(people, seed)
    durations = [duration_s(icon, rig) for icon in members]
    end = math.ceil((max(durations) + TAIL_S) * RATE_HZ - 1e-6) / RATE_HZ
    traces = list(simulate_all(members, rig, end_s=end, rate_Hz=RATE_HZ))
    percepts = [perceive(trace, observer) for trace in traces]
    report()

    batch = simulate_many(members, crowd.rigs(rig), nominal=rig, end_s=end, rate_Hz=RATE_HZ, tracking=tracking)
    report()
    felt = _felt(batch.cold_C, batch.warm_C, batch.time_s, rig, crowd, observer)
    report()

    judged = {n: _judged(felt, n, crowd, observer, seed, SAMPLES if n == chosen else SAMPLES // 4) for n in NORMS}
    made = _assemble(members, traces, percepts, felt, judged, chosen, observer)
    confusion = judged[chosen][1]
    correct, bits = percent_correct(confusion.probability), information_bits(confusion.probability)
    ranking = Ranking(
        version=_version(),
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        seed=seed,
        people=people,
        tracking=_tracking(members, tracking),
        by=by,
        norm=chosen,
        content_hash=_hash(icons, rig),
        icons=made.icons,
        pairs=made.pairs,
        confusion=confusion.pooled,
        percent_correct=float(correct.mean()),
        percent_correct_interval=_interval(correct),
        information_bits=float(bits.mean()),
        information_bits_interval=_interval(bits),
        bits_per_s=float(bits.mean()) / (sum(durations) / len(durations)),
        information_bits_plugin=plugin_bits(confusion.probability, trials, seed, EXPERIMENTS).mean,
        trials=trials,
        worst_pair=_worst(made.pairs),
        rules_disagree=_disagree(made.icons, made.pairs),
        norm_sensitivity={n: float(percent_correct(judged[n][1].probability).mean()) for n in NORMS if n != chosen},
        stress=float(np.median(confusion.stress)),
        standard_error=confusion.standard_error,
    )
    report()
    return ranking


@dataclass(frozen=True, slots=True)
class _Felt:
    """Differences (people, icons, icons) for each norm, detection probabilities (people, icons), duration s."""

    apart: dict[Norm, Array]
    probability: Array
    duration_s: float


@dataclass(frozen=True, slots=True)
class _Scores:
    icons: tuple[IconScore, ...]
    pairs: tuple[PairScore, ...]


def _felt(cold_C: Array, warm_C: Array, time_s: Array, rig: Rig, crowd: People, observer: Observer) -> _Felt:
    dt, rows = uniform_clock(time_s)
    cold, warm = perceive_many(
        cold_C[..., :rows],
        warm_C[..., :rows],
        dt,
        observer,
        area_m2=rig.contact.area_m2,
        threshold_cold=crowd.threshold_cold[:, None],
        threshold_warm=crowd.threshold_warm[:, None],
    )
    found = detect(
        cold,
        warm,
        dt,
        observer,
        path_m=observer.path_m(rig.site) * crowd.path[:, None],
        velocity_cold_m_per_s=crowd.velocity_cold_m_per_s[:, None],
        velocity_warm_m_per_s=crowd.velocity_warm_m_per_s[:, None],
        decision_s=crowd.decision_s[:, None],
    )
    return _Felt(differences(cold, warm, dt, observer), found.probability, dt * (rows - 1))


def _judged(
    felt: _Felt, norm: Norm, crowd: People, observer: Observer, seed: int, samples: int
) -> tuple[Array, Confusion]:
    memory = crowd.memory[:, None, None]
    d_prime = identification_dprime(felt.apart[norm], observer, norm, felt.duration_s, memory)
    return d_prime, confuse(d_prime, lapse=crowd.lapse, seed=seed, samples=samples)


def _assemble(
    icons: Sequence[Icon],
    traces: Sequence[Trace],
    percepts: Sequence[Percept],
    felt: _Felt,
    judged: dict[Norm, tuple[Array, Confusion]],
    norm: Norm,
    observer: Observer,
) -> _Scores:
    d_prime, confusion = judged[norm]
    middle, pooled = np.median(d_prime, axis=0), confusion.pooled
    detected = felt.probability.mean(axis=0)
    scored = []
    for k, (icon, trace, percept) in enumerate(zip(icons, traces, percepts, strict=True)):
        safe, reason, cautions = _verdict(trace)
        scored.append(
            IconScore(
                name=icon.name,
                detected_probability=float(detected[k]),
                onset_s=percept.onset_s,
                channel=percept.channel,
                peak_change_K=(peak_change_K(trace, "cold"), peak_change_K(trace, "warm")),
                attack_K_per_s=(attack_K_per_s(trace, "cold"), attack_K_per_s(trace, "warm")),
                delay_s=(delay_s(trace, "cold"), delay_s(trace, "warm")),
                percent_correct=float(pooled[k, k]),
                reachable=bool(trace.reachable),
                safe=safe,
                reason=reason,
                cautions=cautions,
                rules=icon_rules(trace, percept),
            )
        )
    pairs = []
    for i, j in combinations(range(len(icons)), 2):
        why = pair_reasons(traces[i], traces[j], percepts[i], percepts[j], observer, norm)
        pairs.append(
            PairScore(
                a=icons[i].name,
                b=icons[j].name,
                d_prime=float(middle[i, j]),
                confused_probability=float(0.5 * (pooled[i, j] + pooled[j, i])),
                why=tuple(reason.text for reason in why),
                rules=pair_rules(traces[i], traces[j], percepts[i], percepts[j]),
            )
        )
    return _Scores(tuple(scored), tuple(pairs))


def _verdict(trace: Trace) -> tuple[bool, str | None, tuple[str, ...]]:
    """Safe, every reason why it is not safe or cannot be played, and what is amber: soft limits that it passes."""
    from thermicon.circuit import judge_safety

    safety = judge_safety(trace)
    against = [reason for reason in (safety.reason if not safety.safe else None, trace.reason) if reason]
    amber = tuple(str(finding) for finding in safety.findings if finding.severity != "hard")
    return bool(safety.safe), "; ".join(against) or None, amber


def _tracking(icons: Sequence[Icon], asked: str | None) -> str:
    from thermicon.circuit import usual_tracking

    return asked or ", ".join(sorted({usual_tracking(icon) for icon in icons}))


def _worst(pairs: Sequence[PairScore]) -> tuple[str, str] | None:
    """The pair most often confused; equal ones by name."""
    if not pairs:
        return None
    first = min(pairs, key=lambda p: (-p.confused_probability, p.a, p.b))
    return first.a, first.b


def _disagree(icons: Sequence[IconScore], pairs: Sequence[PairScore]) -> tuple[dict[str, Any], ...]:
    """Icons and pairs that rules and model judge differently, with what each says."""
    found: list[dict[str, Any]] = []
    for icon in icons:
        rules = passes(icon.rules, "change at the receptor", "rate at the receptor")
        model = icon.detected_probability >= FELT
        if rules != model:
            shown, limit = significant(icon.detected_probability, FELT, least=2)
            said = f"{icon.name}: rules say {_felt_word(rules)}, the model {shown} detected (felt from {limit})"
            found.append({"icon": icon.name, "rules": rules, "model": model, "text": said})
    for pair in pairs:
        apart = pair.d_prime >= APART_DPRIME
        if pair.rules_pass != apart:
            word = "told apart" if pair.rules_pass else "not told apart"
            shown = f"{pair.d_prime:.{decimals(pair.d_prime, APART_DPRIME, 1)}f}"
            said = f"{pair.a} and {pair.b}: rules say {word}, the model d′ {shown} (apart from {APART_DPRIME})"
            found.append({"a": pair.a, "b": pair.b, "rules": pair.rules_pass, "model": apart, "text": said})
    return tuple(found)


def _felt_word(rules: bool) -> str:
    return "felt" if rules else "not felt"


def _interval(values: Array) -> tuple[float, float]:
    low, high = np.percentile(values, [2.5, 97.5])
    return float(low), float(high)


def _steps(progress: Progress | None, total: int) -> Callable[[], None]:
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, total)

    return step


def _version() -> str:
    try:
        return version("thermicon")
    except PackageNotFoundError:
        return "unknown"


def _hash(icons: IconSet, rig: Rig) -> str:
    """Hash of everything that was ranked: the icons' canonical text, the rig and the observer's numbers."""
    observer = (DATA / "observer.toml").read_text(encoding="utf-8")
    held = "\0".join([str(icons), rig.document, observer])
    return hashlib.sha256(held.encode("utf-8")).hexdigest()
