"""The writer of the observer's parameter file.

Constants are those of the maximum, since no draw is near the middle of them all; intervals cover 95 % of the draws.
"""

import math
from dataclasses import replace

from thermicon.base.files.records import Record, RecordTable
from thermicon.circuit import Rig
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import steady_state

from ..experiments.published import STRIPS
from ..identification.task import memory_noise, memory_record
from ..observer.channels import CHANNELS, VARIABLES, Channel, Variable, receptor_column, source_of
from ..observer.constants import names_of, quantity_of, record_of
from ..observer.draws import PosteriorDraws
from ..observer.observer import Observer, load_thresholds
from .pairs import pair_spread
from .results import UNMOVED_SD, Constant, load_constants
from .rows import load_evidence

DIGITS = 4
COMMENT = """Constants of the nominal observer, written by `python -m thermicon.perception.evidence observer`.
Inferred from published evidence (`data/constants.csv`), or taken over from thresholds.toml; low and high are 95 %.
`use = "assumed"`: no data behind it, or data that say nothing of it. Nothing here was set on a predicted record.
Numbers `from heat flow` are those of the other variant.
Written by a program: change the evidence or the priors and run it again."""


def calibrate(thresholds: RecordTable | None = None) -> RecordTable:
    """Records of the observer and its variants, with thresholds from the shipped table or another one like it."""
    table = load_thresholds() if thresholds is None else thresholds
    known = RecordTable(table.name, tuple(r for r in table if r.use in ("calibrate", "assumed")))
    shared = (
        *_taken_over(known),
        *(_neutral_flux(known, channel) for channel in CHANNELS),
        *(record for variant in VARIABLES for record in _inferred(variant)),
    )
    noise = []
    for variant in VARIABLES:  # by the rate task through its own distance
        unset = memory_record(source_of(variant), 1.0, 1.0, 1.0)
        draft = Observer.from_table(RecordTable("draft", (*shared, unset)), variable=variant)
        noise.append(memory_noise(known, draft))
    return RecordTable("observer.toml", tuple(_rounded(r) for r in (*shared, *noise)))


def _inferred(variable: Variable) -> list[Record]:
    """Constants of one variant, but for offsets of single laboratories."""
    draws, variant = PosteriorDraws.load(variable=variable), source_of(variable)
    constants = [each for each in load_constants(variable) if each.mechanism != "laboratories"]
    return [_record(each, draws.interval(each.name), variant) for each in constants]


def _record(each: Constant, interval: tuple[float, float, float], variant: str) -> Record:
    low, _, high = interval
    channel, quantity = quantity_of(each.name)
    return Record(
        quantity=f"{quantity}{variant}",
        unit=each.unit,
        source=f"inferred from published evidence; prior: {each.source}",
        value=each.value,
        low=min(low, each.value),
        high=max(high, each.value),
        channel=channel,
        method="maximum a posteriori, 95 % of the draws of the posterior",
        conditions=f"SD {each.narrowed:.2f} times the prior's, {each.prior_low:.3g} to {each.prior_high:.3g}",
        confidence="low" if each.narrowed > UNMOVED_SD else "medium",
        use="assumed" if each.narrowed > UNMOVED_SD else "calibrate",
    )


def _taken_over(known: RecordTable) -> tuple[Record, ...]:
    """Records that enter as they are, under the observer's own names."""
    zone, area = known.one("complete adaptation"), known.one("thermode area of the forced-choice thresholds")
    (neutral, reference), (low, high) = names_of(Observer, "neutral_C", "reference_area_m2"), zone.interval
    same = "path_hand_m", "path_forearm_m", "lapse", "rated_share", "missing_cost", "episode_bar"
    return (
        replace(zone, quantity=neutral, low=low, high=high),
        replace(area, quantity=reference),
        *(record_of(known, Observer, field) for field in same),
        pair_spread(known),
        *(_mean_rating(channel) for channel in CHANNELS),
    )


def _mean_rating(channel: Channel) -> Record:
    """Geometric mean of the ratings of E2 over its areas, at which their pooled scatter is taken to hold."""
    evidence = load_evidence()
    found = [evidence.find("E2", f"rating_mean_{strips}strip", channel) for strips in STRIPS]
    logs = [math.log(each.place) for each in found]
    return Record(
        quantity=quantity_of(names_of(Observer, "mean_rating")[0])[1],
        unit="points of 100",
        source="statistics of open trial data, experiment E2 of evidence.csv",
        value=math.exp(sum(logs) / len(logs)),
        channel=channel,
        site="forearm",
        conditions=(
            "geometric mean over 1 to 5 strips of 1.96 cm²; only sets where the scatter of ratings is taken to hold"
        ),
        confidence="medium",
        use="calibrate",
    )


def _rounded(record: Record) -> Record:
    def short(number: float | None) -> float | None:
        return None if number is None else float(f"{number:.{DIGITS}g}")

    return replace(record, value=short(record.value), low=short(record.low), high=short(record.high))


RIG = "thenar"


def _neutral_flux(known: RecordTable, channel: Channel) -> Record:
    """Heat flow at receptor depth while the skin rests at the ends of complete adaptation."""
    zone = known.one("complete adaptation")
    rig = Rig.load(RIG)
    network, column = network_of(rig), receptor_column("heat flow", channel)
    low, high = (network.read(steady_state(rig, "skin", level)[1], column) for level in zone.interval)
    return Record(
        quantity=quantity_of(names_of(Observer, "neutral_flux")[0])[1],
        unit="W/m²",
        source=f"computed from the neutral zone ({zone.source})",
        low=low,
        high=high,
        channel=channel,
        site=RIG,
        method=f"steady heat flow into the skin at receptor depth on the {RIG} rig",
        conditions=f"skin held at {zone.interval[0]:g} and {zone.interval[1]:g} °C",
        confidence="low",
        use="calibrate",
    )
