"""Words of the field that the workbench uses, each in one sentence, as in the glossary of the documentation."""

from __future__ import annotations

TERMS = {
    "d′": "distance in units of noise; two icons at d′ 0 cannot be distinguished",
    "sensation ψ": "strength of feeling, in units of sensory noise",
    "clock": "which event time counts from: receptor, percept or response",
    "onset": "median response time of the trials that end in a report: first passage, conduction and decision",
    "detected": "probability that a trial ends in a report of the icon, beyond reports of nothing: mean over the "
    "virtual people (`rank`, `export`, set view), or of the nominal person (`perceive`, design view)",
    "felt": "detected with a probability of at least 0.5; only then there are an onset and a channel",
    "nominal person": "the observer itself, between the virtual people: every multiplier is 1",
    "confusion matrix": "how often each presented icon (row) gets each name (column)",
    "proportion correct": "share of trials with the right name, 0 to 1",
    "middle 95 % of people": "the range without the lowest and the highest 2.5 % of the virtual people, at the nominal "
    "constants; a goal for 95 % of people is about what all but 5 % reach, with the uncertainty of the model",
    "bits": "information from icon to response; 2.58 bits name six icons without error",
    "gate": "the safety check that every exported drive passes",
}
"""Word and meaning."""
SIMULATED = "limits of this simulation"
LIMITS = (
    "safety limits judged on the one run that is shown, of the nominal rig; whether a drive is safe is for the gate to "
    "say, at export, in the worst cases"
)


def terms_of(*names: str) -> list[list[str]]:
    """Words with their meanings, as the canvas takes them.

    >>> terms_of("clock")
    [['clock', 'which event time counts from: receptor, percept or response']]
    """
    return [[name, (TERMS | {SIMULATED: LIMITS})[name].replace("`", "")] for name in names]


def glossary() -> list[str]:
    """All words, one a line."""
    return [f"{name}: {meaning}" for name, meaning in terms_of(*TERMS, SIMULATED)]
