"""thermicon.perception: receptor temperature → percept → distance → confusion matrix → ranking.

Everything here is light to import; compiled kernels and matplotlib load when first used.
"""

from thermicon.perception.observer import (
    CHANNELS,
    NORMS,
    Channel,
    Norm,
    Observer,
    Receptor,
    load_thresholds,
)
from thermicon.perception.variants import MODELS, VARIABLES, VARIANTS, Model, Variable, receptor_column
from thermicon.perception.receptors import receptor_drive
from thermicon.perception.sensation import amplitude_jnd, psi_of_multiple, sensation
from thermicon.perception.detection import Detection, criterion_of, detect, false_alarms, forced_choice_dprime
from thermicon.perception.percept import Percept, perceive, perceive_many
from thermicon.perception.distance import (
    back_to_back_dprime,
    difference,
    difference_trace,
    differences,
    identification_dprime,
)
from thermicon.perception.confusion import Confusion, confuse, equal_percent_correct
from thermicon.perception.measures import Plugin, information_bits, percent_correct, plugin_bits
from thermicon.perception.people import People, age_factor, draw_people, people_records
from thermicon.perception.bench import Bench, Stimuli
from thermicon.perception.passage import ResponseTimes, response_times
from thermicon.perception.measured import Measured
from thermicon.perception.procedures import (
    choice_reaction_time,
    forced_choice,
    method_of_levels,
    method_of_limits,
    yes_no,
)
from thermicon.perception.features import attack_K_per_s, delay_s, excursion_K, onset_s, peak_change_K
from thermicon.perception.rules import RuleResult, icon_rules, load_rules, pair_rules, rig_rules
from thermicon.perception.coverage import load_coverage, outside_data
from thermicon.perception.reasons import Reason, largest_difference, pair_reasons
from thermicon.perception.parts import Part, distance_parts
from thermicon.perception.parameters import Parameter, observer_at, observer_parameters
from thermicon.perception.intervals import ParameterIntervals
from thermicon.perception.appraise import Appraisal, appraise
from thermicon.perception.request import ChoiceError, Choosing, energy_J
from thermicon.perception.choose import Choice, choose
from thermicon.perception.edit import Edit, NoEdit, cheapest_edit
from thermicon.perception.search import Searched, search
from thermicon.perception.robust import Duel, Survival, beats, survives
from thermicon.perception.ranking import IconScore, PairScore, Ranking
from thermicon.perception.task import Task
from thermicon.perception.carryover import CarryOver, carry_over
from thermicon.perception.rank import rank
from thermicon.perception.map import PerceptualMap, map_of, perceptual_map
from thermicon.perception.designs import MissingError
from thermicon.perception.sensitivity import Effect, Sensitivity, sensitivity
from thermicon.perception.validate import ValidationReport, validate
from thermicon.perception.realised import Change, FeltChange, judge_delivered

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
    "difference",
    "difference_trace",
    "differences",
    "identification_dprime",
    "back_to_back_dprime",
    "confuse",
    "Confusion",
    "equal_percent_correct",
    "percent_correct",
    "information_bits",
    "plugin_bits",
    "Plugin",
    "draw_people",
    "age_factor",
    "people_records",
    "People",
    "Bench",
    "Stimuli",
    "forced_choice",
    "yes_no",
    "method_of_limits",
    "method_of_levels",
    "choice_reaction_time",
    "Measured",
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
    "distance_parts",
    "Part",
    "Parameter",
    "observer_parameters",
    "observer_at",
    "ParameterIntervals",
    "appraise",
    "Appraisal",
    "Choosing",
    "ChoiceError",
    "energy_J",
    "choose",
    "Choice",
    "cheapest_edit",
    "Edit",
    "NoEdit",
    "search",
    "Searched",
    "beats",
    "Duel",
    "survives",
    "Survival",
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
    "MissingError",
    "validate",
    "ValidationReport",
    "Change",
    "FeltChange",
    "judge_delivered",
]
