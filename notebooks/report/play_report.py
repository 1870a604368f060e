"""Reports of live play."""

from __future__ import annotations

import math
import shlex
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import number, span

from .blocks import Block, Facts, Text, grid

if TYPE_CHECKING:
    from thermicon.circuit.live.play_live import LiveResult
    from thermicon.circuit.live.play_log import MeasuredPlay

ANOTHER_LOOP_K = 0.2
"""Beyond this a loop is not the one that set-points are shaped for; the play counts, its prediction does not."""


def check_report(result: LiveResult) -> list[Block]:
    """Each demand of the gate with how it is met, and what was shown."""
    rows = [(row.label, row.demand, row.how, row.by) for row in result.demands]
    return [Facts(_ready(result)), grid(("demand", "asked for", "is", "by"), rows)]


def play_report(result: LiveResult) -> list[Block]:
    """The device, what was shown before the first play, and each play with its distance from the prediction."""
    rows = [*_ready(result), *((play.name, _play_text(play)) for play in result.plays)]
    if result.folder is None:
        return [Facts(tuple(rows))]
    files = [name for play in result.plays for name in play.files]
    rows.append(("wrote", f"{result.folder}: {', '.join([*files, 'rig.toml'])}"))
    blocks: list[Block] = [Facts(tuple(rows))]
    played = [play for play in result.plays if not math.isnan(play.rms_K)]
    if played:
        paths = [shlex.quote(f"{result.folder}/{name}") for name in (*played[0].files, "rig.toml")]
        text = f"Next: thermicon compare {paths[1]} {paths[0]}\nthermicon fit {paths[0]} --rig {paths[3]}"
        blocks.append(Text(text))
    return blocks


def _ready(result: LiveResult) -> tuple[tuple[str, str], tuple[str, str]]:
    cut, proofs, parts = result.status["cut_off_display_C"], result.proofs, []
    device = (
        f"{result.status['identity']}; watchdog {result.status['watchdog_s']:g} s, cut-off {number(cut.low, 1)} … "
        f"{number(cut.high, 1)} °C on its second sensor"
    )
    if "silent_s" in proofs:
        parts.append(f"switched off by itself in {proofs['silent_s']:g} s of silence")
    if "fell_K" in proofs:
        parts.append(f"polarity: fell by {number(proofs['fell_K'], 2)} K")
    if "rest_s" in proofs:
        parts.append(f"{number(proofs['rest_s'], 0)} s until rested")
    return ("device", device), ("ready", " · ".join(parts) or "nothing was shown")


def _play_text(play: MeasuredPlay) -> str:
    if math.isnan(play.rms_K):
        return "did not begin"
    display_C = play.columns["probe_loop_C"][play.columns["time_s"] >= 0.0]
    until_s = min(float(play.columns["time_s"][-1]), float(play.predicted.time_s[-1]))
    skin = span(float(play.predicted.skin_C.min()), float(play.predicted.skin_C.max()), "°C", 1)
    shown = span(float(display_C.min()), float(display_C.max()), "°C", 1)
    text = (
        f"{number(until_s, 2)} s{'' if play.ended else ', NOT to its end'}, display {shown}, "
        f"{number(1e3 * play.rms_K, 0)} mK rms from the prediction; skin not measured, predicted {skin}"
    )
    if play.rms_K > ANOTHER_LOOP_K:
        text += "; this loop is not the one that set-points are shaped for: look at its gains and its sensor's lag"
    return text
