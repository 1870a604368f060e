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
from thermicon.perception.people import People, draw_people, people_records
from thermicon.perception.features import attack_K_per_s, delay_s, excursion_K, onset_s, peak_change_K
from thermicon.perception.rules import RuleResult, icon_rules, load_rules, pair_rules
from thermicon.perception.reasons import Reason, largest_difference, pair_reasons
from thermicon.perception.ranking import IconScore, PairScore, Ranking
from thermicon.perception.rank import rank
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
    "people_records",
    "People",
    "peak_change_K",
    "attack_K_per_s",
    "delay_s",
    "onset_s",
    "excursion_K",
    "icon_rules",
    "pair_rules",
    "load_rules",
    "RuleResult",
    "pair_reasons",
    "largest_difference",
    "Reason",
    "rank",
    "Ranking",
    "IconScore",
    "PairScore",
    "Change",
    "FeltChange",
    "judge_delivered",
]
