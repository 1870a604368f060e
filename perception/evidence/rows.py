"""Published statistics as the rows of the likelihood.

`data/evidence.csv` has one row per statistic and `data/evidence.toml` one table per experiment; no trial data.
"""

import csv
import math
import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from thermicon.base.files.records import RecordError
from thermicon.base.words.near_words import did_you_mean

from ..experiments.tasks import DISCREPANCY, UNSTATED, Key
from ..observer.channels import CHANNELS
from ..observer.observer import DATA, load_thresholds

Number = Annotated[float | None, BeforeValidator(lambda text: None if text == "" else text)]


class Statistic(BaseModel):
    """One published number. On a log scale `value` is a geometric mean and `se` is in natural-log units."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    experiment: str = Field(min_length=1)
    statistic: str = Field(min_length=1)
    channel: Literal["cold", "warm", "both"]
    value: float
    se: float = Field(ge=0.0)
    unit: str
    scale: Literal["linear", "log"]
    n_people: Number
    n_trials: Number
    between_people_sd: Number
    site: str
    area_cm2: str
    baseline_C: Number
    rate_K_per_s: str
    stimulus: str

    @property
    def place(self) -> float:
        """The value on its own scale: its natural logarithm where that is the scale."""
        return math.log(self.value) if self.scale == "log" else self.value


class Experiment(BaseModel):
    """The publication of an experiment, its licence, its method."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    key: str = Field(min_length=1)
    title: str
    citation: str = Field(min_length=1)
    repository: str
    commit: str
    licence: str
    method: str
    notes: str


@dataclass(frozen=True, slots=True)
class Evidence:
    """All published statistics, the experiments that rows come from by their keys, and what is suspected of misses.

    >>> load_evidence().find("E3", "threshold_gm", "warm").value
    1.859
    """

    statistics: tuple[Statistic, ...]
    experiments: dict[str, Experiment]
    suspected: dict[Key, str]

    def find(self, experiment: str, statistic: str, channel: str) -> Statistic:
        """One statistic; a RecordError names the nearest where it is not there."""
        for row in self.statistics:
            if (row.experiment, row.statistic, row.channel) == (experiment, statistic, channel):
                return row
        near = did_you_mean(statistic, {row.statistic for row in self.statistics if row.experiment == experiment})
        raise RecordError(f"evidence.csv: experiment {experiment!r} has no statistic {statistic!r} ({channel}): {near}")


@lru_cache(maxsize=1)
def load_evidence() -> Evidence:
    """The shipped evidence."""
    return read_evidence(DATA / "evidence.csv", DATA / "evidence.toml")


def read_evidence(statistics: Path, experiments: Path) -> Evidence:
    """Evidence from a table of statistics and a file of experiments; raises RecordError with row and column."""
    tree = tomllib.loads(experiments.read_text("utf-8"))
    by_key = {row["key"]: Experiment.model_validate(row) for row in tree["experiment"]}
    missed = {(row["experiment"], row["statistic"], row["channel"]): row["mechanism"] for row in tree["suspected"]}
    rows = []
    with statistics.open(encoding="utf-8", newline="") as file:
        for line, row in enumerate(csv.DictReader(file), start=2):
            try:
                rows.append(Statistic.model_validate(row))
            except ValidationError as fault:
                first = fault.errors()[0]
                column = ".".join(str(part) for part in first["loc"])
                raise RecordError(f"{statistics.name}, line {line}: {column}: {first['msg']}") from None
            if rows[-1].experiment not in by_key:
                raise RecordError(f"{statistics.name}, line {line}: {experiments.name} has no {rows[-1].experiment!r}")
    return Evidence(tuple(rows), by_key, missed)


Kind = Literal["level", "ratio", "share", "spread", "correlation", "sign"]
DISCREPANCIES: dict[Kind, float] = {
    "level": DISCREPANCY,
    "ratio": DISCREPANCY,
    "share": DISCREPANCY,
    "spread": 0.35,
    "correlation": 0.05,
    "sign": 0.0,
}
"""What a model of this kind may miss a row by, as a share of it (a correlation: by itself); assumed.

That of spreads between and within people was chosen on left-out rows: coverage of spreads is not a test of the model.
"""
WARM_WIDTH_BIAS, WARM_WIDTH_SPREAD_BIAS = 0.14, -0.05
"""What the fit of E4 adds to warm ln σ and to its spread in log10, found on simulated sets (evidence.toml)."""


SAME_PEOPLE = {"E2": "E1", "E8": "E1"}
"""Experiments with the people of another one (evidence.toml)."""


@dataclass(frozen=True, slots=True)
class Row:
    """A published number on the scale of its prediction; `sd` holds its error and the model's discrepancy."""

    key: Key
    value: float
    sd: float
    log: bool
    unit: str
    label: str
    kind: Kind

    @property
    def experiment(self) -> str:
        """The experiment."""
        return self.key[0]

    @property
    def people(self) -> str:
        """The experiment by whose name its people are known; all rows of the same people are left out together."""
        return SAME_PEOPLE.get(self.experiment, self.experiment)

    @property
    def judges(self) -> bool:
        """Whether coverage is judged by it: no form or number of the model was chosen by such rows."""
        return self.kind not in ("spread", "sign") and self.experiment != "E8"

    def shown(self, place: float) -> float:
        """A value or prediction in the row's own unit."""
        return math.exp(min(place, 20.0)) if self.log else place


@lru_cache(maxsize=1)
def load_rows() -> tuple[Row, ...]:
    """All rows of the likelihood, experiment by experiment."""
    evidence = load_evidence()
    return (*_from_statistics(evidence), *_in_haste(evidence), *_from_thresholds())


def _from_statistics(evidence: Evidence) -> list[Row]:
    rows = []
    for experiment, statistic, channels, label, kind in STATISTICS:
        for channel in channels:
            found = evidence.find(experiment, statistic, channel)
            value, error = found.place, found.se
            log = found.scale == "log"
            if statistic.startswith("rating_mean") or statistic == "rating_within_sd_pooled":
                value, error, log = math.log(value), error / value, True
            if channel == "warm" and statistic == "sigma_gm_age30":
                value -= WARM_WIDTH_BIAS
            if channel == "warm" and statistic == "sigma_between_sd_log10_noise_removed":
                value -= WARM_WIDTH_SPREAD_BIAS
            more = DISCREPANCIES[kind] * (1.0 if log or kind == "correlation" else abs(value))
            sd = math.hypot(error, max(more, LEAST))
            rows.append(Row((experiment, statistic, channel), value, sd, log, found.unit, f"{label}, {channel}", kind))
    # The spread between people stands in a column of its own row.
    young = evidence.find("E5", "cold_change_at_report_peak1_age_lt36", "cold")
    spread = young.between_people_sd
    if spread is not None and young.n_people is not None:
        error = spread / math.sqrt(2.0 * young.n_people)
        sd = math.hypot(error, DISCREPANCIES["spread"] * spread)
        label = "between people, ln of cooling after warmth"
        rows.append(Row(("E5", "between_people_sd_peak1_age_lt36", "cold"), spread, sd, False, "ln", label, "spread"))
    return rows


LEAST = 0.01
"""No row is taken for more certain than this, on its own scale."""


HASTE_DISCREPANCY = 0.003
"""What a model of this kind may miss a share of wrong qualities by; assumed."""


def _in_haste(evidence: Evidence) -> list[Row]:
    """Shares of wrong qualities in a speeded choice, over all areas."""
    rows = []
    for channel, wrong in zip(CHANNELS, ("cold called warm", "warm called cold"), strict=True):
        found = evidence.find("E8", f"share_{wrong.replace(' ', '_')}_all_fast", channel)
        sd = math.hypot(found.se, HASTE_DISCREPANCY)
        rows.append(
            Row(("E8", found.statistic, channel), found.value, sd, False, found.unit, f"{wrong} in haste", "share")
        )
    return rows


def _from_thresholds() -> list[Row]:
    table, rows = load_thresholds(), []
    for channel in CHANNELS:
        thenar = table.one("detection threshold", channel=channel, site="thenar")
        rows.append(_threshold("thenar", channel, math.log(thenar.central), UNSTATED))
        wrist = table.one("detection threshold", channel=channel, site="wrist")
        spread = 0.5 * math.log(wrist.interval[1] / wrist.interval[0])
        rows.append(_threshold("wrist", channel, math.log(wrist.central), spread / math.sqrt(PEOPLE_WRIST)))
        sd = math.hypot(spread / math.sqrt(2.0 * PEOPLE_WRIST), DISCREPANCIES["spread"] * spread)
        label = f"between people, ln of forced choice at the wrist, {channel}"
        rows.append(Row(("wrist", "spread of detection thresholds", channel), spread, sd, False, "ln", label, "spread"))
        band = table.one("amplitude difference threshold", channel=channel).interval
        key = ("amplitudes", "amplitude difference threshold", channel)
        middle, error = 0.5 * math.log(band[0] * band[1]), 0.5 * math.log(band[1] / band[0])
        rows.append(
            Row(key, middle, math.hypot(error, PEDESTAL_ERROR), True, "K", f"amplitude difference, {channel}", "level")
        )
    key = ("steps", "steps from threshold to pain", "warm")
    rows.append(Row(key, math.log(STEPS), STEPS_ERROR, True, "1", "steps from threshold to pain, warm", "level"))
    return rows


def _threshold(place: str, channel: str, log_threshold: float, error: float) -> Row:
    """A forced-choice threshold: the prediction is how far the published one is from one multiple of threshold."""
    key = (place, "detection threshold", channel)
    sd = math.hypot(error, DISCREPANCY)
    return Row(
        key, 0.0, sd, True, f"times {math.exp(log_threshold):.2g} K", f"forced choice, {place}, {channel}", "level"
    )


PEOPLE_WRIST = 106
PEDESTAL_ERROR = 0.35
"""The amplitudes compared are not stated: the pedestal is assumed, and moves the row by this, ln."""
STEPS, STEPS_ERROR = 30.0, 0.3
"""Herget et al. 1941, forehead, radiant; the error is assumed."""

BOTH = ("cold", "warm")
STATISTICS: tuple[tuple[str, str, tuple[str, ...], str, Kind], ...] = (
    ("E1", "rt_gm_5strip_onset_clock", BOTH, "choice reaction time", "level"),
    ("E1", "rt_area_exponent_onset_clock", BOTH, "area exponent of reaction time", "ratio"),
    ("E1", "rt_between_sd_ln_5strip_onset_clock", BOTH, "between people, ln of reaction time", "spread"),
    ("E1", "rt_within_sd_ln_5strip_onset_clock", BOTH, "within people, ln of reaction time", "spread"),
    ("E1", "rt_cold_warm_correlation_5strip_onset_clock", ("both",), "correlation of reaction times",
     "correlation"),
    ("E2", "rating_mean_5strip", BOTH, "rating of five strips", "level"),
    ("E2", "rating_area_exponent_group", BOTH, "area exponent of ratings", "ratio"),
    ("E2", "rating_within_sd_pooled", BOTH, "within people, ratings", "spread"),
    ("E3", "threshold_gm", BOTH, "limits", "level"),
    ("E3", "between_sd_log10_noise_removed", BOTH, "between people, log10 of limits", "spread"),
    ("E3", "within_sd_log10_median_person", BOTH, "within people, log10 of limits", "spread"),
    ("E3", "cold_warm_correlation_log", ("both",), "correlation of limits", "correlation"),
    ("E4", "threshold50_gm_age30", BOTH, "yes/no at 30 years", "level"),
    ("E4", "threshold50_ln_per_decade", BOTH, "yes/no, ln per decade of age", "ratio"),
    ("E4", "sigma_gm_age30", BOTH, "width of yes/no at 30 years", "spread"),
    ("E4", "threshold_between_sd_log10_noise_removed", BOTH, "between people, log10 of yes/no", "spread"),
    ("E4", "sigma_between_sd_log10_noise_removed", BOTH, "between people, log10 of width", "spread"),
    ("E4", "cold_warm_threshold_correlation_person_fits", ("both",), "correlation of yes/no", "correlation"),
    ("E5", "cold_change_at_report_peak1_age_lt36", ("cold",), "cooling after a pulse to 35 °C", "level"),
    ("E5", "ratio_to_lowest_peak2_age_lt36", ("cold",), "after 38 °C, ratio", "ratio"),
    ("E5", "ratio_to_lowest_peak3_age_lt36", ("cold",), "after 45 °C, ratio", "ratio"),
    ("E5", "ratio_to_lowest_peak4_age_lt36", ("cold",), "after 47 °C, ratio", "ratio"),
    ("E5", "within_sd_ln_peak1", ("cold",), "within people, ln of cooling after warmth", "spread"),
    ("E5", "share_called_warm_peak1_age_lt36", ("cold",), "cooling called warm after 35 °C", "share"),
    ("E5", "share_called_warm_peak2_age_lt36", ("cold",), "cooling called warm after 38 °C", "share"),
    ("E5", "share_called_warm_peak3_age_lt36", ("cold",), "cooling called warm after 45 °C", "share"),
    ("E5", "share_called_warm_peak4_age_lt36", ("cold",), "cooling called warm after 47 °C", "share"),
    ("E6", "rating_local_exponent_mean", BOTH, "exponent of ratings by size", "ratio"),
    ("E9 Greenspan", "ratio_limits_thenar_over_forearm", ("cold",), "limits, thenar over forearm", "sign"),
    ("E9 Hagander", "ratio_limits_thenar_over_wrist", BOTH, "limits, thenar over wrist", "sign"),
    ("E9 Wakolbinger", "ratio_limits_palm_over_dorsum", BOTH, "limits, palm over back of the hand", "sign"),
    ("E10", "ratio_limits_palm_over_finger", BOTH, "limits, palm over fingers", "sign"),
    ("E11", "three_fingers_match_two", BOTH, "change of three fingers over two", "ratio"),
    ("E12", "ratio_zone_width_cool_over_warm_skin", ("both",), "width from cool to warm, rest at 27 over 32 °C",
     "sign"),
    ("E13", "ratio_thresholds_from_40_over_36", ("warm",), "forced choice, rest at 40 over 36 °C", "sign"),
)  # fmt: skip
