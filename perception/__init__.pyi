# The names of this package in the order of the flow; each is imported when it is first asked for.
from .selection.goal import Goal as Goal
from .observer.observer import Observer as Observer, CHANNELS as CHANNELS, NORMS as NORMS
from .observer.people import draw_people as draw_people
from .sensation.percept import perceive as perceive, Percept as Percept
from .identification.from_memory import dprime_from_memory as dprime_from_memory
from .ranking.distance_components import (
    distance_components as distance_components,
    DistanceComponent as DistanceComponent,
)
from .identification.confusion import confuse as confuse, Confusion as Confusion
from .identification.measures import information_bits as information_bits, proportion_correct as proportion_correct
from .ranking.rank import rank as rank
from .ranking.ranking import Ranking as Ranking
from .ranking.scores import IconScore as IconScore, PairScore as PairScore
from .identification.task import Task as Task
from .selection.request import Selection as Selection, ChoiceError as ChoiceError
from .selection.choose import choose as choose, Choice as Choice
from .selection.edit import cheapest_edit as cheapest_edit
from .selection.edit_result import Edit as Edit, NoEdit as NoEdit
from .selection.frontier import frontier as frontier, Frontier as Frontier
from .selection.search import search as search, SearchResult as SearchResult
from .selection.robust import compare_sets as compare_sets, SetComparison as SetComparison
from .identification.map import perceptual_map as perceptual_map, map_of as map_of, PerceptualMap as PerceptualMap
from .pilot.observed import observed as observed
from .pilot.plan import plan as plan
from .ranking.sensitivity import sensitivity as sensitivity, Sensitivity as Sensitivity
from .evidence.validate import validate as validate, ValidationReport as ValidationReport
from .identification.delivered import judge_delivered as judge_delivered, PerceivedChange as PerceivedChange
from .sensation.bench import Bench as Bench, Stimulus as Stimulus
from .experiments.classical import (
    forced_choice as forced_choice,
    yes_no as yes_no,
    method_of_limits as method_of_limits,
)
from .experiments.levels import method_of_levels as method_of_levels
from .experiments.classical import choice_reaction_time as choice_reaction_time
from .experiments.psychometric import (
    psychometric_function as psychometric_function,
    PsychometricFunction as PsychometricFunction,
)
from .experiments.repeated_limits import repeated_limits as repeated_limits, RepeatedLimits as RepeatedLimits
from .experiments.rating import magnitude_rating as magnitude_rating, Ratings as Ratings
from .experiments.prepulse import cooling_after_pulse as cooling_after_pulse, CoolingAfterPulse as CoolingAfterPulse
from .experiments.thermode_lag import thermode_lag as thermode_lag, ThermodeLag as ThermodeLag
