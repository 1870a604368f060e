"""A sealed prediction: the log score of a `rank` file on later answers.

Its best possible score is the one expected if its own matrix is true.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from thermicon.base.files.inputs import InputError, quoted, read_bytes
from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.program import own_version
from thermicon.circuit import Rig
from thermicon.icons import IconSet

from ..identification.skin_alone import skin_alone
from ..ranking.rank import digests_of
from .prediction import EXPERIMENTS, share_as_far
from .trials import Trials

WHAT, MOST_MB = "sealed prediction", 200
LEAST = 1e-6
"""Probability that counts in place of 0, so that no single answer decides alone."""


class SealedError(InputError):
    """A sealed prediction cannot be opened; the message says what, where and the cure."""


@dataclass(frozen=True, slots=True)
class SealedPrediction:
    """A prediction as it was sealed: file, its SHA-256, version of the program, names, confusions (icons, icons).

    `felt_and_named` (icons,) is None in files of before it was predicted.
    """

    source: str
    sha256: str
    version: str
    labels: tuple[str, ...]
    confusion: Array
    felt_and_named: Array | None = None


@dataclass(frozen=True, slots=True)
class SealedScores:
    """Bits a trial and share correct of each score; `chance_bits` is the SD of the prediction's, were it the truth.

    `felt_and_named` is observed, predicted, and the p of its icons in independent trials; None where nobody could say
    that nothing was felt, or where the prediction does not have it.
    """

    sealed: SealedPrediction
    trials: int
    observed_correct: float
    scores: dict[str, tuple[float, float]]
    chance_bits: float
    unanswered: int = 0
    felt_and_named: tuple[float, float, float] | None = None

    def to_json(self) -> str:
        """Every number as JSON text."""
        return json.dumps(asdict(self), default=np.ndarray.tolist, ensure_ascii=False, indent=1)


def read_sealed(path: str | Path, icons: IconSet, rig: Rig) -> SealedPrediction:
    """Read the JSON of a ranking of these icons on this rig; a `SealedError` says what does not fit."""
    data, again = read_bytes(Path(path), WHAT, MOST_MB, SealedError), "give the JSON of a ranking, as it was written"
    try:
        held = json.loads(data)
        version, digests, named = str(held["thermicon"]), dict(held["sha256"]), held["confusion"]
        labels, confusion = tuple(named["labels"]), np.array(named["probability"], dtype=np.float64)
        shares = {icon["name"]: icon.get("felt_and_named") for icon in held.get("icons", ())}
        known = bool(shares) and None not in shares.values()
        alert = np.array([shares[name] for name in labels], dtype=np.float64) if known else None
        newest, own = ([int(part) for part in re.findall(r"\d+", text)[:3]] for text in (version, own_version()))
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as wrong:
        why = f"it has no {wrong}" if isinstance(wrong, KeyError) else quoted(str(wrong))
        raise SealedError(f"{path}: not a {WHAT}: {why}; {again}") from None
    if own and newest > own:
        raise SealedError(f"{path}: written by thermicon {version}, and this is {own_version()}; update to open it")
    if labels != tuple(icon.name for icon in icons):
        shown = ", ".join(map(str, labels[:6]))
        raise SealedError(f"{path}: predicts other icons than those given ({shown}); give those, in their order")
    for name, digest in digests_of(icons, rig).items():
        if digest != digests.get(name):
            cure = "the cue files unchanged" if name == "icons" else "the same rig and changes"
            raise SealedError(f"{path}: sealed for other {name}; give {cure}, or open it with thermicon {version}")
    if confusion.shape != (len(labels),) * 2 or not (confusion >= 0).all() or (abs(confusion.sum(1) - 1) > 1e-6).any():
        raise SealedError(f"{path}: confusion.probability has no row of probabilities for each icon; {again}")
    if alert is not None and (alert.shape != (len(labels),) or not ((alert >= 0) & (alert <= 1)).all()):
        raise SealedError(f"{path}: icons[].felt_and_named is no probability for each icon; {again}")
    return SealedPrediction(Path(path).name, hashlib.sha256(data).hexdigest(), version, labels, confusion, alert)


def opened(sealed: SealedPrediction, trials: Trials, icons: IconSet, rig: Rig) -> SealedScores:
    """Score a sealed prediction on answers to its icons; trials without an answer count for felt and named alone."""
    counts, own = trials.pooled, sealed.confusion
    number, shown, logs = float(counts.sum()), counts.sum(axis=1), np.log2(own.clip(LEAST))

    def score(confusion: Array, answers: Array = counts) -> tuple[float, float]:
        bits = (answers * np.log2(confusion.clip(LEAST))).sum() / number
        return float(bits), float(shown @ confusion.diagonal() / number)

    spread = (own * np.square(logs - (own * logs).sum(axis=1, keepdims=True))).sum(axis=1)
    scores = {
        "prediction": score(own),
        "guessing": score(np.full_like(own, 1.0 / len(own))),
        "skin temperature alone": score(skin_alone(list(icons), rig)),
        "best that its matrix allows": score(own, shown[:, None] * own),
    }
    chance = math.sqrt(float(shown @ spread)) / number
    silent, both = int(trials.unanswered.sum()), None
    if silent and (alert := sealed.felt_and_named) is not None:
        plays, chances = trials.presented.sum(axis=0), alert.clip(LEAST, 1.0 - LEAST)
        hits = np.random.default_rng(0).binomial(plays.astype(np.int64), chances, (EXPERIMENTS, len(own)))
        shown = plays > 0.0
        expected = (plays * chances)[shown]
        off = np.vstack([counts.diagonal(), hits])[:, shown] - expected
        far = (np.square(off) / (expected * (1.0 - chances[shown]))).sum(axis=1).tolist()
        both = float(counts.trace() / trials.total), float(plays @ alert / trials.total), share_as_far(far)
    return SealedScores(sealed, int(number), float(counts.trace() / number), scores, chance, silent, both)
