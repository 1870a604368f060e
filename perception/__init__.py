"""thermicon.perception: receptor temperature → percept → distance → confusion matrix → ranking.

Everything here is light to import; compiled kernels and matplotlib load when first used.
"""

from .observer.observer import (
    CHANNELS,
    NORMS,
    Channel,
    Norm,
    Observer,
    Receptor,
    load_thresholds,
)
from .observer.variants import MODELS, VARIABLES, VARIANTS, Model, Variable, receptor_column
from .sensation.receptors import receptor_drive
from .sensation.sensation import amplitude_jnd, psi_of_multiple, sensation
from .sensation.detection import Detection, criterion_of, detect, false_alarms, forced_choice_dprime
from .sensation.percept import Percept, perceive, perceive_many
from .identification.distance import (
    back_to_back_dprime,
    percept_distance,
    difference_trace,
    percept_distances,
    identification_dprime,
)
from .identification.confusion import Confusion, confuse, equal_proportion_correct
from .identification.measures import PluginInformation, information_bits, proportion_correct, plugin_bits
from .observer.people import People, age_factor, draw_people, people_records
from .sensation.bench import Bench, Stimulus
from .sensation.first_passage import ResponseTimes, response_times
from .validation.measured import Measurement
from .validation.procedures import (
    choice_reaction_time,
    forced_choice,
    method_of_levels,
    method_of_limits,
    yes_no,
)
from .sensation.features import attack_K_per_s, delay_s, excursion_K, onset_s, peak_change_K
from .comparison.rules import RuleResult, icon_rules, load_rules, pair_rules, rig_rules
from .sensation.coverage import load_coverage, outside_data
from .comparison.reasons import Reason, largest_difference, pair_reasons
from .comparison.distance_components import DistanceComponent, distance_components
from .sensation.parameters import ObserverParameter, observer_at, observer_parameters
from .identification.intervals import ParameterIntervals
from .selection.appraise import Appraisal, appraise
from .selection.request import ChoiceError, Selection, energy_J
from .selection.choose import Choice, choose
from .selection.edit import Edit, NoEdit, cheapest_edit
from .selection.search import SearchResult, search
from .selection.robust import SetComparison, SetRobustness, compare_sets, best_set_probability
from .ranking.ranking import IconScore, PairScore, Ranking
from .identification.task import Task
from .identification.carry_over import CarryOver, carry_over
from .ranking.rank import rank
from .identification.map import PerceptualMap, map_of, perceptual_map
from .sensitivity.sensitivity import Effect, Sensitivity, sensitivity
from .validation.validate import ValidationReport, validate
from .identification.delivered import DeliveredChange, PerceivedChange, judge_delivered

# The order is that of the flow, which is not the alphabet's.
__all__ = [
    "CHANNELS",
    "NORMS",
    "Channel",
    "Norm",
    "Observer",
    "Receptor",
    "load_thresholds",
    "MODELS",
    "VARIABLES",
    "VARIANTS",
    "Model",
    "Variable",
    "receptor_column",
    "receptor_drive",
    "sensation",
    "psi_of_multiple",
    "amplitude_jnd",
    "detect",
    "Detection",
    "criterion_of",
    "false_alarms",
    "forced_choice_dprime",
    "perceive",
    "perceive_many",
    "Percept",
    "percept_distance",
    "difference_trace",
    "percept_distances",
    "identification_dprime",
    "back_to_back_dprime",
    "confuse",
    "Confusion",
    "equal_proportion_correct",
    "proportion_correct",
    "information_bits",
    "plugin_bits",
    "PluginInformation",
    "draw_people",
    "age_factor",
    "people_records",
    "People",
    "Bench",
    "Stimulus",
    "forced_choice",
    "yes_no",
    "method_of_limits",
    "method_of_levels",
    "choice_reaction_time",
    "Measurement",
    "response_times",
    "ResponseTimes",
    "peak_change_K",
    "attack_K_per_s",
    "delay_s",
    "onset_s",
    "excursion_K",
    "icon_rules",
    "pair_rules",
    "rig_rules",
    "load_rules",
    "RuleResult",
    "outside_data",
    "load_coverage",
    "pair_reasons",
    "largest_difference",
    "Reason",
    "distance_components",
    "DistanceComponent",
    "ObserverParameter",
    "observer_parameters",
    "observer_at",
    "ParameterIntervals",
    "appraise",
    "Appraisal",
    "Selection",
    "ChoiceError",
    "energy_J",
    "choose",
    "Choice",
    "cheapest_edit",
    "Edit",
    "NoEdit",
    "search",
    "SearchResult",
    "compare_sets",
    "SetComparison",
    "best_set_probability",
    "SetRobustness",
    "Task",
    "carry_over",
    "CarryOver",
    "rank",
    "Ranking",
    "IconScore",
    "PairScore",
    "perceptual_map",
    "map_of",
    "PerceptualMap",
    "sensitivity",
    "Sensitivity",
    "Effect",
    "validate",
    "ValidationReport",
    "DeliveredChange",
    "PerceivedChange",
    "judge_delivered",
]
