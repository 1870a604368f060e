"""What `rank` found: a frozen noun with the contract's JSON, a table and two pictures."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.perception.observer import Channel
from thermicon.perception.receptors import Array
from thermicon.perception.rules import TOLD_APART, RuleResult

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class IconScore:
    """One icon. Probability of detection and per cent correct are means over people; the rest is nominal.

    `onset_s` and `channel` are None where the nominal person feels nothing; peak change (K),
    attack (K/s) and delay (s) are at the cold and the warm receptor. `reason` says why the icon is not
    safe, cannot be reached, or both; `cautions` are the soft limits of safety that it passes.
    """

    name: str
    detected_probability: float
    onset_s: float | None
    channel: Channel | None
    peak_change_K: tuple[float, float]
    attack_K_per_s: tuple[float, float]
    delay_s: tuple[float | None, float | None]
    percent_correct: float
    reachable: bool
    safe: bool
    reason: str | None
    rules: tuple[RuleResult, ...]
    cautions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class PairScore:
    """One pair: median d′ over people, share of confusions (either way, mean of both), why, rules."""

    a: str
    b: str
    d_prime: float
    confused_probability: float
    why: tuple[str, ...]
    rules: tuple[RuleResult, ...]

    @property
    def rules_pass(self) -> bool:
        """Whether the rules alone tell the two apart."""
        return any(r.passed for r in self.rules if r.rule == TOLD_APART)


@dataclass(frozen=True, slots=True)
class Ranking:
    """A predicted experiment: icons in file order, pairs, the pooled confusion matrix, the whole set.

    Per cent correct is 0–1 and information in bits, each with the 2.5–97.5 % interval over people.
    `rig_changes` are what was changed on the rig for this question, such as `contact.area_cm2=4`.
    `stress` and `standard_error` are the accuracy of the confusion matrix, not spread over people.
    """

    version: str
    rig: str
    seed: int
    people: int
    tracking: str
    by: str
    norm: str
    content_hash: str
    icons: tuple[IconScore, ...]
    pairs: tuple[PairScore, ...]
    confusion: Array
    percent_correct: float
    percent_correct_interval: tuple[float, float]
    information_bits: float
    information_bits_interval: tuple[float, float]
    bits_per_s: float
    information_bits_plugin: float
    trials: int
    worst_pair: tuple[str, str] | None
    rules_disagree: tuple[dict[str, Any], ...]
    norm_sensitivity: dict[str, float]
    stress: float
    standard_error: float
    rig_changes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        own = np.array(self.confusion, dtype=np.float64)
        if own.shape != (len(self.icons),) * 2 or not np.allclose(own.sum(axis=1), 1.0, rtol=0, atol=1e-12):
            raise ValueError("the confusion matrix must have a row and a column for each icon, and rows that sum to 1")
        own.setflags(write=False)
        object.__setattr__(self, "confusion", own)

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the icons, in file order."""
        return tuple(icon.name for icon in self.icons)

    @property
    def d_prime(self) -> Array:
        """Median d′ of every pair as a matrix (icons, icons), zero on the diagonal."""
        place = {name: k for k, name in enumerate(self.labels)}
        matrix = np.zeros((len(place), len(place)))
        for pair in self.pairs:
            i, j = place[pair.a], place[pair.b]
            matrix[i, j] = matrix[j, i] = pair.d_prime
        return matrix

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each icon, the best first: by per cent correct, or by its rules when `by` is rules."""
        return [
            {
                "icon": icon.name,
                "percent_correct": icon.percent_correct,
                "detected_probability": icon.detected_probability,
                "onset_s": icon.onset_s,
                "channel": icon.channel,
                "peak_change_cold_K": icon.peak_change_K[0],
                "peak_change_warm_K": icon.peak_change_K[1],
                "rules_passed": sum(r.passed for r in icon.rules),
                "rules": len(icon.rules),
                "pairs_apart_by_rules": self._pairs_apart(icon.name),
                "reachable": icon.reachable,
                "safe": icon.safe,
                "reason": icon.reason,
            }
            for icon in sorted(self.icons, key=self._order)
        ]

    def to_frame(self) -> pd.DataFrame:
        """The rows as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def to_dict(self) -> dict[str, Any]:
        """The contract of `rank --json` as plain data: what does not exist is None, never NaN."""
        many = len(self.icons) > 1
        made: dict[str, Any] = _plain(
            {
                "thermicon": self.version,
                "rig": self.rig,
                "rig_changes": list(self.rig_changes),
                "seed": self.seed,
                "people": self.people,
                "tracking": self.tracking,
                "by": self.by,
                "norm": self.norm,
                "content_hash": self.content_hash,
                "icons": [_icon(icon) for icon in self.icons],
                "pairs": [_pair(pair) for pair in self.pairs],
                "confusion": {"labels": list(self.labels), "probability": self.confusion.tolist()},
                "set": {
                    "percent_correct": self.percent_correct,
                    "percent_correct_interval": list(self.percent_correct_interval),
                    "information_bits": self.information_bits if many else None,
                    "information_bits_interval": list(self.information_bits_interval) if many else None,
                    "bits_per_s": self.bits_per_s if many else None,
                    "information_bits_plugin": self.information_bits_plugin if many else None,
                    "trials": self.trials,
                    "worst_pair": None if self.worst_pair is None else list(self.worst_pair),
                    "rules_disagree": list(self.rules_disagree),
                    "norm_sensitivity": self.norm_sensitivity,
                },
                "chosen": None,
            }
        )
        return made

    def to_json(self) -> str:
        """That contract as text, the same bytes for the same arguments."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1, allow_nan=False)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the pooled confusion matrix; returns the axes."""
        from thermicon.perception.draw import plot_confusion

        return plot_confusion(self, ax)

    def __repr__(self) -> str:
        low, high = self.percent_correct_interval
        icons = "1 icon" if len(self.icons) == 1 else f"{len(self.icons)} icons"
        crowd = "1 person" if self.people == 1 else f"{self.people} people"
        spread = "" if self.people == 1 else f" [{100 * low:.0f}, {100 * high:.0f}]"
        bits = f", {self.information_bits:.2f} bits" if len(self.icons) > 1 else ""
        worst = "" if self.worst_pair is None else f", worst pair {self.worst_pair[0]} and {self.worst_pair[1]}"
        return (
            f"Ranking(predicted: {icons} on {with_changes(self.rig, self.rig_changes)}, {crowd}, "
            f"{100 * self.percent_correct:.1f} % correct{spread}{bits}{worst})"
        )

    def _repr_html_(self) -> str:
        from thermicon.perception.draw import as_svg, plot_confusion

        return as_svg(plot_confusion(self, None))

    def _pairs_apart(self, name: str) -> int:
        return sum(pair.rules_pass for pair in self.pairs if name in (pair.a, pair.b))

    def _order(self, icon: IconScore) -> tuple[float, float, str]:
        if self.by == "rules":
            return (-self._pairs_apart(icon.name), -sum(r.passed for r in icon.rules), icon.name)
        return (-icon.percent_correct, 0.0, icon.name)


def with_changes(rig: str, changes: Sequence[str]) -> str:
    """A rig's name with what was changed on it.

    >>> with_changes("thenar", ["contact.area_cm2=4"]), with_changes("thenar", [])
    ('thenar with contact.area_cm2=4', 'thenar')
    """
    return f"{rig} with {', '.join(changes)}" if changes else rig


def _icon(icon: IconScore) -> dict[str, Any]:
    def both(values: tuple[float | None, float | None]) -> dict[str, float | None]:
        return {"cold_receptor": values[0], "warm_receptor": values[1]}

    return {
        "name": icon.name,
        "detected_probability": icon.detected_probability,
        "onset_s": icon.onset_s,
        "channel": icon.channel,
        "peak_change_K": both(icon.peak_change_K),
        "attack_K_per_s": both(icon.attack_K_per_s),
        "delay_s": both(icon.delay_s),
        "percent_correct": icon.percent_correct,
        "reachable": icon.reachable,
        "safe": icon.safe,
        "reason": icon.reason,
        "cautions": list(icon.cautions),
        "rules": [r.to_dict() for r in icon.rules],
    }


def _pair(pair: PairScore) -> dict[str, Any]:
    return {
        "a": pair.a,
        "b": pair.b,
        "d_prime": pair.d_prime,
        "confused_probability": pair.confused_probability,
        "why": list(pair.why),
        "rules": [r.to_dict() for r in pair.rules],
        "edit": None,
    }


def _plain(held: Any) -> Any:
    """Plain JSON data: a number that is not finite does not exist."""
    if isinstance(held, dict):
        return {str(key): _plain(value) for key, value in held.items()}
    if isinstance(held, list | tuple):
        return [_plain(value) for value in held]
    if isinstance(held, bool | np.bool_):
        return bool(held)
    if isinstance(held, int | np.integer):
        return int(held)
    if isinstance(held, float | np.floating):
        return float(held) if math.isfinite(held) else None
    return held
