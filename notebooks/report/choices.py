"""The text of a goal, and of the choice of the best few icons of a set."""

from collections.abc import Iterator
from typing import Any

from thermicon.icons.number_text import count_of, number, percent, percent_span

SHARE = "For a share of people: what at least so many reach, with the uncertainty of the model."
MOST_EXCLUDED = 5


def goal_lines(goal: dict[str, Any] | None, verdict: str = "") -> Iterator[str]:
    """Report whether a goal is met, or another `verdict`: what was predicted of each part, and what is in the way.

    What a share of people means is said too, unless a `verdict` is given, whose command says it with its table.
    """
    if goal is None:
        return
    yield f"Goal: {verdict or ('met' if goal['met'] else 'NOT met')}"
    for part in goal["parts"]:
        yield f"  {'✓' if part['met'] else '✗'} {part['text']}: {_goal_value(part)}"
    if not verdict and any(part["text"].endswith(" of people") for part in goal["parts"]):
        yield f"  {SHARE}"
    if goal["binding"]:
        yield f"  In the way: {'; '.join(goal['binding'])}"
    if names := goal.get("not_reached"):
        yield f"  Not reached, and judged as the rig would play them: {', '.join(names)}; export refuses them"


def _goal_value(part: dict[str, Any]) -> str:
    """What was predicted of a part, in its unit, and how far that is from what is wanted."""
    value, gap = goal_value(part)
    if isinstance(part["value"], str):
        return f"{value} in this simulation; export judges the worst case"
    return value if part["met"] or not gap else f"{value}, missed by {gap}"


def goal_value(part: dict[str, Any]) -> tuple[str, str]:
    """What was predicted of a part of a goal and its distance from what is wanted, with units; empty where none.

    >>> goal_value({"text": "time <= 10 s", "met": True, "value": 8.5, "wanted": 10.0})
    ('8.5 s', '1.5 s')
    """
    value, wanted = part["value"], part["wanted"]
    if isinstance(value, str):
        return value, ""
    if value is None:
        return "none", ""
    unit = part["text"].split(" for ")[0].split()[-1]
    share = unit == "%"
    shown, gap = (100.0 * value, 100.0 * abs(value - wanted)) if share else (value, abs(value - wanted))
    words = "" if unit[0].isdigit() else f" {unit}"
    if share:
        return f"{shown:.1f}{words}", f"{gap:.1f} points"
    return f"{number(shown, 2)}{words}", f"{number(gap, 2)}{words}"


def laboratory(observer: str, own: bool) -> str:
    """Which laboratory an interval is for: a new one, or the one whose draws an observer's file holds."""
    return f"your laboratory, {observer}" if own else "a new laboratory"


def choice_lines(chosen: dict[str, Any], where: str = "a new laboratory") -> Iterator[str]:
    """Report what was chosen, how certain that is, its scores as a set of its own, and the excluded icons."""
    objective, count = chosen["objective"], len(chosen["icons"])
    yield f"Best {count} of {chosen['pool']}, by {NAMES[objective]}: {', '.join(chosen['icons'])}"
    score = f"within the range of all {chosen['pool']}: {scored(objective, chosen['value'])}"
    if objective == "worst":
        score += f" ({' and '.join(chosen['worst_pair'])})"
    yield score
    if chosen["optimal"]:
        yield f"no other choice is better: {_searched(chosen)}"
    else:
        yield (
            f"the best choice found; none exceeds {scored(objective, chosen['bound'])}, a bound that may be loose "
            f"({count_of(chosen['looked_at'], 'choice')} examined)"
        )
    own = chosen["at_own_range"]
    yield (
        f"as a set of their own: {scored('worst', own['d_prime'])} ({' and '.join(own['worst_pair'])}), "
        f"{scored('correct', own['proportion_correct'])}, {scored('bits', own['information_bits'])}, "
        f"{scored('bits-per-s', own['bits_per_s'])}"
    )
    if own["proportion_correct_interval_new_laboratory"]:
        low, high = own["proportion_correct_interval_new_laboratory"]
        least, most = own["information_bits_interval_new_laboratory"]
        yield f"for {where} (95 %): {percent_span(low, high)} correct, {least:.2f}–{most:.2f} bits"
    energy = "" if chosen["total_J"] is None else f", total energy {number(chosen['total_J'])} J"
    yield f"total duration {number(chosen['total_s'])} s{energy}"
    for icon in chosen["excluded"][:MOST_EXCLUDED]:
        yield f"excluded: {icon['icon']} {icon['reason']}"
    if len(chosen["excluded"]) > MOST_EXCLUDED:
        yield f"and {len(chosen['excluded']) - MOST_EXCLUDED} more excluded; --json lists all"


NAMES = {"worst": "the worst pair", "correct": "proportion correct", "bits": "bits", "bits-per-s": "bits per second"}


def scored(objective: str, value: float) -> str:
    """Write the value of an objective with its meaning."""
    if objective == "worst":
        return f"d′ {number(value)} in the worst pair"
    if objective == "correct":
        return f"{percent(value)} correct"
    return f"{value:.2f} {'bits' if objective == 'bits' else 'bits/s'}"


def _searched(chosen: dict[str, Any]) -> str:
    if chosen["objective"] == "worst":
        return f"proven by bisection over d′ ({count_of(chosen['looked_at'], 'threshold')})"
    people = count_of(chosen["people"], "person", "people")
    if chosen["looked_at"] == 1:
        return f"it is the only one, evaluated with {people}"
    return f"all {chosen['looked_at']} choices were evaluated, with {people}"
