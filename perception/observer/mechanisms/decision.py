"""Decision: from the brain's signal to the answer."""

from dataclasses import dataclass

from ..constants import FROM_0, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Decision(Mechanism):
    """A simple reaction, what a choice adds to it, and how both differ between people and trials."""

    equation = "decision time · e^(between · z + within · z′)"
    source = "Donders 1868 for the time of a choice"
    decision_s: float = constant("decision time")
    choice_s: float = constant("choice time", FROM_0)
    decision_noise: float = constant("decision time between trials", FROM_0)
    decision_between: float = constant("decision time between people", FROM_0)
