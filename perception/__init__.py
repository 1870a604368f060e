"""thermicon.perception: receptor temperature → percept → distance → confusion matrix → ranking.

The front door holds what a script or a notebook needs; everything else is in the rooms, such as
`thermicon.perception.sensation.detection`. Compiled kernels and matplotlib load when they are first used.
"""

from typing import TYPE_CHECKING

from thermicon.icons.front_door import door

# Bound at once: the function has the name of its room, which would take its place.
from .ranking.sensitivity import Sensitivity, sensitivity

if TYPE_CHECKING:
    from .observer.observer import CHANNELS, NORMS, Observer
    from .sensation.percept import Percept, perceive
    from .identification.from_memory import dprime_from_memory
    from .identification.confusion import Confusion, confuse
    from .identification.measures import information_bits, proportion_correct
    from .observer.people import draw_people
    from .sensation.bench import Bench, Stimulus
    from .experiments.classical import choice_reaction_time, forced_choice, method_of_limits, yes_no
    from .experiments.levels import method_of_levels
    from .experiments.prepulse import CoolingAfterPulse, cooling_after_pulse
    from .experiments.psychometric import PsychometricFunction, psychometric_function
    from .experiments.rating import Ratings, magnitude_rating
    from .experiments.repeated_limits import RepeatedLimits, repeated_limits
    from .experiments.thermode_lag import ThermodeLag, thermode_lag
    from .ranking.distance_components import DistanceComponent, distance_components
    from .selection.goal import Goal
    from .selection.request import ChoiceError, Selection
    from .selection.choose import Choice, choose
    from .selection.goal_result import judge_goal
    from .selection.edit import cheapest_edit
    from .selection.edit_result import Edit, NoEdit
    from .selection.search import SearchResult, search
    from .selection.robust import SetComparison, compare_sets
    from .ranking.ranking import Ranking
    from .ranking.scores import IconScore, PairScore
    from .identification.task import Task
    from .ranking.rank import rank
    from .selection.frontier import Frontier, frontier
    from .identification.map import PerceptualMap, map_of, perceptual_map
    from .pilot.observed import observed
    from .pilot.plan import plan
    from .evidence.validate import ValidationReport, validate
    from .identification.delivered import PerceivedChange, judge_delivered

# In the order of the flow.
__all__ = [
    "Goal",
    "Observer",
    "CHANNELS",
    "NORMS",
    "draw_people",
    "perceive",
    "Percept",
    "dprime_from_memory",
    "distance_components",
    "DistanceComponent",
    "confuse",
    "Confusion",
    "information_bits",
    "proportion_correct",
    "rank",
    "Ranking",
    "IconScore",
    "PairScore",
    "Task",
    "Selection",
    "ChoiceError",
    "choose",
    "Choice",
    "judge_goal",
    "cheapest_edit",
    "Edit",
    "NoEdit",
    "frontier",
    "Frontier",
    "search",
    "SearchResult",
    "compare_sets",
    "SetComparison",
    "perceptual_map",
    "map_of",
    "PerceptualMap",
    "observed",
    "plan",
    "sensitivity",
    "Sensitivity",
    "validate",
    "ValidationReport",
    "judge_delivered",
    "PerceivedChange",
    "Bench",
    "Stimulus",
    "forced_choice",
    "yes_no",
    "method_of_limits",
    "method_of_levels",
    "choice_reaction_time",
    "psychometric_function",
    "PsychometricFunction",
    "repeated_limits",
    "RepeatedLimits",
    "magnitude_rating",
    "Ratings",
    "cooling_after_pulse",
    "CoolingAfterPulse",
    "thermode_lag",
    "ThermodeLag",
]

if not TYPE_CHECKING:
    __getattr__ = door(
        __name__,
        {
            "observer.observer": "CHANNELS NORMS Observer",
            "sensation.percept": "Percept perceive",
            "identification.from_memory": "dprime_from_memory",
            "identification.confusion": "Confusion confuse",
            "identification.measures": "information_bits proportion_correct",
            "observer.people": "draw_people",
            "sensation.bench": "Bench Stimulus",
            "experiments.classical": "choice_reaction_time forced_choice method_of_limits yes_no",
            "experiments.levels": "method_of_levels",
            "experiments.prepulse": "CoolingAfterPulse cooling_after_pulse",
            "experiments.psychometric": "PsychometricFunction psychometric_function",
            "experiments.rating": "Ratings magnitude_rating",
            "experiments.repeated_limits": "RepeatedLimits repeated_limits",
            "experiments.thermode_lag": "ThermodeLag thermode_lag",
            "ranking.distance_components": "DistanceComponent distance_components",
            "selection.goal": "Goal",
            "selection.request": "ChoiceError Selection",
            "selection.choose": "Choice choose",
            "selection.goal_result": "judge_goal",
            "selection.edit": "cheapest_edit",
            "selection.edit_result": "Edit NoEdit",
            "selection.search": "SearchResult search",
            "selection.robust": "SetComparison compare_sets",
            "ranking.ranking": "Ranking",
            "ranking.scores": "IconScore PairScore",
            "identification.task": "Task",
            "ranking.rank": "rank",
            "selection.frontier": "Frontier frontier",
            "identification.map": "PerceptualMap map_of perceptual_map",
            "pilot.observed": "observed",
            "pilot.plan": "plan",
            "evidence.validate": "ValidationReport validate",
            "identification.delivered": "PerceivedChange judge_delivered",
        },
    )


def __dir__() -> list[str]:
    """Return the names of the front door, whether loaded yet or not."""
    return sorted({*globals(), *__all__})
