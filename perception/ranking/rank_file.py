"""A ranking as the plain data of `rank --json`.

Edits, goals and choices that are asked for later are written likewise.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from ..identification.new_laboratory import NEW_LABORATORY
from .assumptions import doubts

if TYPE_CHECKING:
    from ..identification.new_laboratory import NewLaboratory
    from .ranking import Ranking
    from .scores import IconScore


ICON_KEYS = (
    *("name", "detected_probability", "onset_s", "channel", "peak_change_K", "attack_K_per_s", "delay_s"),
    *(
        "felt_and_named",
        "proportion_correct",
        "reachable",
        "safe",
        "reason",
        "cautions",
        "rules",
        "rules_score",
        "rules_margin",
    ),
    "outside_data",
)
TWO_NUMBERS = ("peak_change_K", "attack_K_per_s", "delay_s")
CARRIED = ("after", "d_prime")
AT_RECEPTORS = ("cold_receptor", "warm_receptor")
OFTEN_CONFUSED = 0.05
"""Pairs confused more often than this have an interval of it."""


def ranking_file(ranking: Ranking) -> dict[str, Any]:
    """The keys of the contract, in their order."""
    asked, left, played = ranking.new_laboratory, ranking.carry_over, (ranking.job.forms[0], ranking.task.counted)
    elsewhere: list[dict[str, Any]] = (
        asked.rows(ranking.labels) if asked else [dict.fromkeys(NEW_LABORATORY) for _ in ranking.icons]
    )
    made: dict[str, Any] = plain(
        {
            "thermicon": ranking.version,
            "rig": ranking.rig,
            "rig_changes": list(ranking.rig_changes),
            "rig_text": ranking.job.layout.toml,
            **({"place": place.to_dict()} if (place := ranking.place) else {}),
            "observer": ranking.observer,
            "warnings": [],
            "seed": ranking.seed,
            "people": ranking.people,
            "tracking": ranking.tracking,
            "by": "model",
            "memory": ranking.memory,
            "content_hash": ranking.content_hash,
            "sha256": ranking.digests,
            "task": {"gap_s": ranking.task.gap_s},
            "icons": [
                {
                    **_icon(icon),
                    **intervals,
                    "carry_over": left and dict(zip(CARRIED, left.worst_of(place, *played), strict=True)),
                }
                for place, (icon, intervals) in enumerate(zip(ranking.icons, elsewhere, strict=True))
            ],
            "pairs": _pairs(ranking),
            "confusion": {
                "labels": list(ranking.labels),
                "probability": ranking.confusion.tolist(),
                "standard_error": ranking.felt.standard_error,
                "person_standard_error": ranking.felt.person_standard_error,
            },
            "set": _set(ranking, asked),
            "persons": {
                "proportion_correct": list(ranking.persons),
                "felt_and_named": ranking.felt.felt_and_named.tolist(),
            },
            "assumptions": asdict(ranking.assumptions),
            "goal": None,
            "chosen": None,
            "map": _map(ranking) if len(ranking.icons) > 1 else None,
        }
    )
    return made


def as_text(made: dict[str, Any]) -> str:
    """JSON text of plain data: one key per line, and one entry per line where a key holds a list of objects."""
    lines = []
    for key, value in made.items():
        if isinstance(value, list) and any(isinstance(thing, dict) for thing in value):
            text = "[\n  " + ",\n  ".join(_one_line(thing) for thing in value) + "\n ]"
        else:
            text = _one_line(value)
        lines.append(f" {_one_line(key)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}"


def _one_line(held: Any) -> str:
    return json.dumps(held, ensure_ascii=False, allow_nan=False)


def plain(held: Any) -> Any:
    """Plain JSON data: a number that is not finite does not exist.

    >>> plain({"a": float("nan"), "b": np.float64(1.5)})
    {'a': None, 'b': 1.5}
    """
    # The most frequent come first, and in tuples: a union of classes would be made anew for each of a million values.
    if held is None or isinstance(held, (str, bool)):
        return held
    if isinstance(held, (float, np.floating)):
        return float(held) if math.isfinite(held) else None
    if isinstance(held, dict):
        return {str(key): plain(value) for key, value in held.items()}
    if isinstance(held, (list, tuple)):
        return [plain(value) for value in held]
    if isinstance(held, (int, np.integer)):
        return int(held)
    return bool(held) if isinstance(held, np.bool_) else held


def _set(ranking: Ranking, asked: NewLaboratory | None) -> dict[str, Any]:
    many = len(ranking.icons) > 1
    return {
        "felt_and_named": ranking.felt_and_named,
        "felt_and_named_interval": list(ranking.felt_and_named_interval),
        "proportion_correct": ranking.proportion_correct,
        "proportion_correct_interval": list(ranking.proportion_correct_interval),
        "information_bits": ranking.information_bits if many else None,
        "information_bits_interval": list(ranking.information_bits_interval) if many else None,
        "bits_per_s": ranking.bits_per_s if many else None,
        "information_bits_plugin": float(ranking.felt.plugin.mean()) if many else None,
        "trials": ranking.job.trials,
        "total_s": ranking.total_s,
        "total_J": ranking.total_J,
        "worst_pair": None if ranking.worst_pair is None else list(ranking.worst_pair),
        "rules_disagree": list(ranking.rules_disagree),
        "proportion_correct_by_memory": ranking.by_form,
        "memory_changes": ranking.form_changes,
        "felt_and_named_interval_new_laboratory": asked.felt_and_named if asked else None,
        "proportion_correct_interval_new_laboratory": asked.proportion_correct if asked else None,
        "information_bits_interval_new_laboratory": asked.information_bits if asked and many else None,
        "posterior_draws": asked.draws if asked else None,
        "posterior": asked.posterior if asked else None,
        "new_laboratory_people": asked.people if asked else None,
        "new_laboratory_covers": list(asked.covers) if asked else None,
        "pair_spread": asked.pair_spread if asked else None,
        "own_laboratory": ranking.own_laboratory,
        "doubt": doubts(asked.each) if asked else [],
        "rules_score": ranking.rules_score,
        "rules": [r.to_dict() for r in ranking.rules],
    }


def _icon(icon: IconScore) -> dict[str, Any]:
    held: dict[str, Any] = {key: getattr(icon, key) for key in ICON_KEYS}
    held |= {key: dict(zip(AT_RECEPTORS, held[key], strict=True)) for key in TWO_NUMBERS}
    where = {"where": list(icon.where)} if icon.where else {}
    return {**held, "rules": [rule.to_dict() for rule in icon.rules], **where}


def _map(ranking: Ranking) -> dict[str, Any]:
    """The perceptual map: one point per icon, in d′, and where it lies for single people as a covariance in d′²."""
    from ..identification.map import map_of

    found = map_of(ranking)
    spread = [None] * len(found.labels) if found.covariance is None else found.covariance.tolist()
    points = zip(found.labels, found.points.tolist(), spread, strict=True)
    return {
        "stress": found.stress,
        "people": found.people,
        "points": [{"icon": name, "x": x, "y": y, "covariance": covariance} for name, (x, y), covariance in points],
    }


def _pairs(ranking: Ranking) -> list[dict[str, Any]]:
    place, elsewhere = {name: k for k, name in enumerate(ranking.labels)}, ranking.new_laboratory
    return [
        {
            "a": pair.a,
            "b": pair.b,
            "d_prime": pair.d_prime,
            "d_prime_interval_new_laboratory": elsewhere and elsewhere.pair(place[pair.a], place[pair.b]),
            "confused_probability": pair.confused_probability,
            "confused_interval_new_laboratory": elsewhere.pair(place[pair.a], place[pair.b], "confused")
            if elsewhere and pair.confused_probability > OFTEN_CONFUSED
            else None,
            "why": list(pair.why),
            "rules": [rule.to_dict() for rule in pair.rules],
            "edit": None,
            "distinguishable_by_rules": pair.rules_pass,
            "rules_margin": pair.rules_margin,
            "no_edit": None,
            "parts": [part.to_dict() for part in pair.parts],
        }
        for pair in ranking.pairs
    ]
