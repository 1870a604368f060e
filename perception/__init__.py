"""thermicon.perception: receptor temperature → percept → distance → confusion matrix → ranking.

The front door holds what a script or a notebook needs; everything else is in the rooms, such as
`thermicon.perception.sensation.detection`. Compiled kernels and matplotlib load when they are first used.
"""

from .observer.observer import CHANNELS, NORMS, Observer
from .sensation.percept import Percept, perceive
from .identification.distance import percept_distance
from .identification.from_memory import dprime_from_memory
from .identification.confusion import Confusion, confuse
from .identification.measures import information_bits, proportion_correct
from .observer.people import draw_people
from .sensation.bench import Bench, Stimulus
from .procedures.classical import choice_reaction_time, forced_choice, method_of_limits, yes_no
from .procedures.levels import method_of_levels
from .procedures.prepulse import CoolingAfterPulse, cooling_after_pulse
from .procedures.psychometric import PsychometricFunction, psychometric_function
from .procedures.rating import Ratings, magnitude_rating
from .procedures.repeated_limits import RepeatedLimits, repeated_limits
from .procedures.thermode_lag import ThermodeLag, thermode_lag
from .comparison.distance_components import DistanceComponent, distance_components
from .selection.goal import Goal
from .selection.request import ChoiceError, Selection
from .selection.choose import Choice, choose
from .selection.edit import cheapest_edit
from .selection.edit_result import Edit, NoEdit
from .selection.search import SearchResult, search
from .selection.robust import SetComparison, compare_sets
from .ranking.ranking import Ranking
from .ranking.scores import IconScore, PairScore
from .identification.task import Task
from .ranking.rank import rank
from .ranking.frontier import Frontier, frontier
from .identification.map import PerceptualMap, map_of, perceptual_map
from .pilot.observed import observed
from .pilot.plan import plan
from .sensitivity.sensitivity import Sensitivity, sensitivity
from .validation.validate import ValidationReport, validate
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
    "percept_distance",
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
