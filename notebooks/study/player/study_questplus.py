"""A threshold by QUEST+ (Watson 2017) and its package questplus: each trial plays the level that teaches most.

Levels are drives that were exported and judged one by one; nothing between them or beyond is ever played.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .study_answers import HERE, Row, write_whole

if TYPE_CHECKING:
    from .study_run import ParticipantRun

CATCH = "nothing"
SLOPES, FALSE_ALARMS, LAPSES = (1.0, 1.5, 2.0, 3.0, 4.5, 7.0), (0.01, 0.05, 0.1, 0.2, 0.3), (0.01, 0.03, 0.06)
"""Values of the other parameters that are thought possible, each as likely as the next."""
STEPS_PER_DECADE = 40
FELT, UNFELT = "felt", "not-felt"


def quest(levels_K: Sequence[float]) -> Any:
    """QUEST+ over the levels, with thresholds from half the smallest to twice the greatest."""
    import questplus

    low, high = np.log10(0.5 * min(levels_K)), np.log10(2.0 * max(levels_K))
    thresholds = np.linspace(low, high, 1 + math.ceil((high - low) * STEPS_PER_DECADE))
    parameters = {"slope": SLOPES, "lower_asymptote": FALSE_ALARMS, "lapse_rate": LAPSES}
    return questplus.QuestPlus(
        stim_domain={"intensity": np.log10(levels_K)}, param_domain={"threshold": thresholds, **parameters},
        outcome_domain={"response": [FELT, UNFELT]}, func="weibull", stim_scale="log10",
        stim_selection_method="min_entropy", param_estimation_method="mean",
    )  # fmt: skip


def estimate(qp: Any, target: float) -> tuple[float, tuple[float, float]]:
    """Threshold in K at a probability, and its 95 % interval, from the whole posterior."""
    joint = qp.posterior.sum(dim=("lower_asymptote", "lapse_rate")).transpose("threshold", "slope").values
    scale, slope = np.meshgrid(qp.param_domain["threshold"], SLOPES, indexing="ij")
    at = (scale + math.log10(-math.log(1.0 - target)) / slope).ravel()
    order = np.argsort(at)
    total = np.cumsum(joint.ravel()[order])
    low, middle, high = (10.0 ** at[order][np.searchsorted(total, q * total[-1])] for q in (0.025, 0.5, 0.975))
    return float(middle), (float(low), float(high))


def nearest(rows: Sequence[Row], intensity: float) -> Row:
    """The row of a level."""
    return min(rows, key=lambda row: abs(math.log10(float(row["change_K"])) - intensity))


def go(run: ParticipantRun, rows: Sequence[Row]) -> None:
    """Run the trials of one participant, and write the threshold when they are done."""
    wanted = run.study["threshold"]
    levels_K = [float(row["change_K"]) for row in rows]
    qp = quest(levels_K)
    longest_s = max(float(row["duration_s"]) for row in rows)  # when the question comes tells nothing of the level
    rng = random.Random(f"{run.study['seed']} {run.who}")
    planned = [rng.random() < wanted["catch_share"] for _ in range(wanted["trials"])]
    for presented, said in run.given.values():
        if said:
            learn(qp, rows, presented, said)
    left = [number for number in range(1, wanted["trials"] + 1) if number not in run.given]
    for number in left:
        run.stop_here()
        level = None if planned[number - 1] else nearest(rows, float(qp.next_stim["intensity"]))
        row = dict(level or rows[-1], trial=str(number), block="1", ask_after_s=f"{longest_s:.9g}")
        if level is None:
            row.update(icon=CATCH, drive_file="", marker=str(len(rows) + 1))
        if number == left[0]:
            run.block(1, None, str(HERE / rows[0]["drive_file"]))
        answer = run.trial(row)
        if answer is not None:
            learn(qp, rows, row["icon"], answer)
    report(qp, run, levels_K)


def learn(qp: Any, rows: Sequence[Row], presented: str, said: str) -> None:
    """Let QUEST+ know of an answer; to nothing, it teaches the rate of false alarms alone."""
    if presented == CATCH:
        alarm = qp.posterior.coords["lower_asymptote"]
        posterior = qp.posterior * (alarm if said == FELT else 1.0 - alarm)
        qp.posterior = posterior / posterior.sum()
        return
    level = next(place for place, row in enumerate(rows) if row["icon"] == presented)
    qp.update(stim={"intensity": qp.stim_domain["intensity"][level]}, outcome={"response": said})


def report(qp: Any, run: ParticipantRun, levels_K: Sequence[float]) -> None:
    """Write the threshold with its interval, and what the answers to nothing were."""
    wanted = run.study["threshold"]
    threshold_K, interval_K = estimate(qp, wanted["target"])
    given = [pair for pair in run.given.values() if pair[1]]
    who, nothing = run.who, [said for presented, said in given if presented == CATCH]
    at_edge = not min(levels_K) < interval_K[0] <= interval_K[1] < max(levels_K)
    facts = {
        "participant": who, "direction": wanted["direction"], "threshold_K": threshold_K, "interval_95_K": interval_K,
        "felt_with_probability": wanted["target"], "trials": len(given), "catch_trials": len(nothing),
        "false_alarms": nothing.count(FELT), "beyond_the_levels": at_edge, "slope": float(qp.param_estimate["slope"]),
    }  # fmt: skip
    write_whole(run.files.threshold_file(who), (json.dumps(facts, indent=1) + "\n").encode("utf-8"))
    print(f"{who}: threshold {threshold_K:.3g} K, 95 % interval {interval_K[0]:.3g} to {interval_K[1]:.3g} K")


def threshold_person(
    seed: str, threshold_K: float | None, study: Mapping[str, Any]
) -> Callable[[str, Sequence[str]], tuple[str, float]]:
    """Feels a change with a probability that a Weibull function gives: slope 3, 5 % false alarms, 2 % lapses."""
    wanted, rng = study["threshold"], random.Random(seed)
    if threshold_K is None:
        threshold_K = math.sqrt(wanted["least_K"] * wanted["most_K"])
    shape = -math.log(1.0 - wanted["target"])

    def answers(presented: str, choices: Sequence[str]) -> tuple[str, float]:
        change_K = study["levels"].get(presented, 0.0)
        above = 1.0 - math.exp(-shape * (change_K / threshold_K) ** 3.0)
        felt = rng.random() < 0.05 + (1.0 - 0.05 - 0.02) * above
        return (FELT if felt else UNFELT), rng.lognormvariate(0.2, 0.4)

    return answers
