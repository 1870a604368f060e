"""Forms of memory compared on published results that no noise of memory was set on.

Each form predicts the six icons, the three waveforms and the ratings of E6 with the draws of its constants; its log
score is the log density of what was published. The shipped table is written by
``python -m thermicon.perception.evidence.memory_forms``, which keeps the rows of forms that are no longer norms.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from statistics import NormalDist

import numpy as np

from thermicon.circuit import Rig

from ..arrays import Array
from ..experiments.published import E6_K_PER_S, E6_SIZES
from ..experiments.skin_modes import skin_modes
from ..identification.episodes import Episodes, distance_shares
from ..identification.laboratory import DRAWS
from ..observer.channels import CHANNELS, NORMS, Channel, Norm, sign_of
from ..observer.observer import DATA, Observer
from ..sensation.percept import perceive_many
from .identified import show, six_icons, wave_shapes
from .plausible import plausible_observers
from .predicted import Predicted
from .shown import SIX
from .statistics import load_evidence
from .table_text import number
from .targets import Row, load_targets
from .waves import LIBRARY, likeness, skin_waves, with_others

TABLE = "memory_forms.csv"
PEOPLE, TRIALS = 200, 48
NUMBERS = ("proportion correct", "plug-in information")
"""Published numbers of the six icons; the intervals of targets.toml are taken as 95 %."""
MAIN_CONFUSIONS = (
    "confusion of square and sine over any other",
    "confusion of square and triangle over any other",
    "confusion of sine and triangle over any other",
)
"""Published as the main confusions: at least twice as often as with any other icon."""
STEP_S, END_S, BASELINE_C, CONTACT_M2K_PER_W = 0.01, 3.0, 30.0, 2e-4
"""Play of E6: 30 °C under a strapped thermode, whose contact is the one inferred."""
RATIO = (0.8, 1.25)
NUMERIC = ("predicted", "low", "high", "log_score")


@dataclass(frozen=True, slots=True)
class FormScore:
    """One published row as one form of memory predicts it: value, 95 % of draws, and log score."""

    norm: str
    row: str
    published: str
    predicted: float
    low: float
    high: float
    log_score: float


def compare_forms(
    people: int = PEOPLE, draws: int = DRAWS, seed: int = 0, norms: Sequence[Norm] = NORMS
) -> tuple[FormScore, ...]:
    """Scores of forms of memory on the judged rows of the six icons and the waveforms, and on ratings.

    The two numbers of the six icons share their people, so that their scores are not independent.
    """
    from thermicon.icons import load_library

    rig, library = Rig.load("thenar"), load_library(SIX)
    alike = likeness(skin_waves(rig))
    six = show(library, rig, people, seed)
    waves = show(with_others(load_library(LIBRARY), library), rig, people, seed)
    published = {row.quantity: row for target in load_targets() for row in target.rows if row.judged}
    scores = []
    for norm in norms:
        identified = (
            *six_icons(six.identify("temperature", draws, norm), TRIALS, seed),
            *wave_shapes(waves.identify("temperature", draws, norm), alike),
        )
        predicted = {one.quantity: one for one in identified}
        scores += [_number(norm, predicted[quantity], published[quantity]) for quantity in NUMBERS]
        scores += [_event(norm, predicted[quantity], published[quantity]) for quantity in MAIN_CONFUSIONS]
        scores += [_rated(norm, channel, draws, seed) for channel in CHANNELS]
    return tuple(scores)


def rating_dprime(channel: Channel, observer: Observer, norm: Norm) -> float:
    """d′ of ratings of two sizes about the median one of E6, over their log ratio; intensity alone is rated."""
    change, area_cm2 = E6_SIZES[channel]
    sizes = [sign_of(channel) * times * change for times in RATIO]
    at_cold, at_warm = (_received("forearm", each, sizes) for each in CHANNELS)
    cold, warm = perceive_many(at_cold, at_warm, STEP_S, observer, area_m2=area_cm2 * 1e-4, site="forearm")
    episodes = Episodes.of(cold[None], warm[None], STEP_S, observer)
    apart = math.sqrt(distance_shares(episodes, 0, episodes, 1, observer, norm)["intensity"])
    return apart / math.log(RATIO[1] / RATIO[0])


def _received(rig: str, channel: Channel, sizes: Sequence[float]) -> Array:
    """Temperatures (sizes, rows) at the receptors of a channel under held changes."""
    modes, skin = skin_modes(rig, CONTACT_M2K_PER_W), Rig.load(rig).skin
    depth = skin.cold_receptor_m if channel == "cold" else skin.warm_receptor_m
    rows = round(END_S / STEP_S) + 1
    return np.stack([modes.course(depth, BASELINE_C, [(abs(size) / E6_K_PER_S, size)], STEP_S, rows) for size in sizes])


def _rated(norm: Norm, channel: Channel, draws: int, seed: int) -> FormScore:
    """E6: d′ of ratings for each unit of ln K; only the exponent of these ratings was conditioned on."""
    statistic = load_evidence().find("E6", "dprime_per_ln_change", channel)
    each = [rating_dprime(channel, observer, norm) for observer in plausible_observers(draws, seed, norm)]
    value = rating_dprime(channel, Observer.load(), norm)
    said = f"{statistic.value:.3g} ± {statistic.se:.2g}"
    return _scored(norm, f"d′ of ratings per ln K, {channel}", said, value, each, (statistic.value, statistic.se))


def _number(norm: Norm, predicted: Predicted, row: Row) -> FormScore:
    low, high = row.low or 0.0, row.high or 1.0
    said = f"{0.5 * (low + high):.3g} [{low:.3g}, {high:.3g}]"
    measured = 0.5 * (low + high), (high - low) / (2.0 * 1.96)
    return _scored(norm, predicted.quantity, said, float(predicted.value or 0.0), predicted.draws, measured)


def _scored(
    norm: Norm, row: str, said: str, value: float, draws: Sequence[float], measured: tuple[float, float]
) -> FormScore:
    """A published number with a normal error; the draws are taken as normal too."""
    each = np.array(draws)
    sd = math.hypot(float(each.std(ddof=1)), measured[1])
    score = math.log(NormalDist(float(each.mean()), sd).pdf(measured[0]))
    low, high = np.percentile(each, [2.5, 97.5]).tolist()
    return FormScore(norm, row, said, value, low, high, score)


def _event(norm: Norm, predicted: Predicted, row: Row) -> FormScore:
    """Share of draws in which it happens, with half a draw for either side."""
    least, draws = row.value or 1.0, np.array(predicted.draws)
    share = (float((draws >= least).sum()) + 0.5) / (draws.size + 1.0)
    low, high = np.percentile(draws, [2.5, 97.5]).tolist()
    value = float(predicted.value or 0.0)
    return FormScore(norm, predicted.quantity, f"at least {least:g}", value, low, high, math.log(share))


def totals(scores: Sequence[FormScore]) -> dict[str, float]:
    """Log score of each form over all rows, in the order of the table."""
    forms = dict.fromkeys(one.norm for one in scores)
    return {form: sum(one.log_score for one in scores if one.norm == form) for form in forms}


def to_csv(scores: Sequence[FormScore]) -> str:
    """The table as text."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([field.name for field in fields(FormScore)])
    for one in scores:
        table.writerow([one.norm, one.row, one.published, *(f"{getattr(one, name):.4g}" for name in NUMERIC)])
    return text.getvalue()


def load_forms() -> tuple[FormScore, ...]:
    """The shipped table."""
    with (DATA / TABLE).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return tuple(
        FormScore(row["norm"], row["row"], row["published"], *map(float, (row[name] for name in NUMERIC)))
        for row in rows
    )


def forms_table() -> str:
    """The shipped table for the documentation, in Markdown, with the sum of each form."""
    scores = load_forms()
    lines = [("norm", "row", "published", "predicted", "95 %", "log score"), ("---",) * 6]
    for norm, total in totals(scores).items():
        for one in (each for each in scores if each.norm == norm):
            ends = f"{number(one.low)} to {number(one.high)}"
            lines.append((f"`{norm}`", one.row, one.published, number(one.predicted), ends, f"{one.log_score:.1f}"))
        lines.append((f"`{norm}`", "**all rows**", "", "", "", f"**{total:.1f}**"))
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main() -> None:
    """Write the shipped table, with the rows of forms that are kept as numbers."""
    kept = [one for one in load_forms() if one.norm not in NORMS]
    head = f"# written by python -m thermicon.perception.evidence.memory_forms, {PEOPLE} people, {DRAWS} draws\n"
    (DATA / TABLE).write_text(head + to_csv((*compare_forms(), *kept)), encoding="utf-8")


if __name__ == "__main__":
    main()
