"""Reports of live play."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import number, span

from .blocks import Block, Facts, Text, grid

if TYPE_CHECKING:
    from thermicon.circuit.live.play_live import LiveResult
    from thermicon.circuit.live.play_log import MeasuredPlay
    from thermicon.circuit.solver.trace import Trace

ANOTHER_LOOP_K = 0.2
"""Beyond this a loop is not the one that set-points are shaped for; the play counts, its prediction does not."""


def check_report(result: LiveResult) -> list[Block]:
    """Each demand of the gate with how it is met, and what was shown."""
    rows = [(row.label, row.demand, row.how, row.by) for row in result.demands]
    return [Facts((_device(result), ("shown", _shown(result)))), grid(("demand", "asked for", "is", "by"), rows)]


def play_report(result: LiveResult, predicted: dict[str, Trace]) -> list[Block]:
    """The device, what was shown before the first play, and each play with its distance from the prediction."""
    rows = [_device(result), ("ready", _shown(result))]
    rows += [(play.name, _play_text(play, predicted[play.name])) for play in result.plays]
    blocks: list[Block] = []
    if result.folder is not None:
        files = [name for play in result.plays for name in play.files]
        rows.append(("wrote", f"{result.folder}: {', '.join([*files, 'rig.toml'])}"))
        played = [play for play in result.plays if play.rms_K == play.rms_K]
        if played:
            log, expected, _ = (shlex.quote(f"{result.folder}/{name}") for name in played[0].files)
            rig = shlex.quote(f"{result.folder}/rig.toml")
            following = [f"thermicon compare {expected} {log}", f"thermicon fit {log} --rig {rig}"]
            blocks = [Text("\n".join([f"Next: {following[0]}", following[1]]))]
    return [Facts(tuple(rows)), *blocks]


def _device(result: LiveResult) -> tuple[str, str]:
    cut = result.status["cut_off_display_C"]
    held = f"watchdog {result.status['watchdog_s']:g} s, cut-off {cut[0]:g} … {cut[1]:g} °C on its second sensor"
    return "device", f"{result.status['identity']}; {held}"


def _shown(result: LiveResult) -> str:
    proofs, parts = result.proofs, []
    if proofs.silent_s:
        parts.append(f"switched off by itself in {proofs.silent_s:g} s of silence")
    if proofs.fell_K:
        least_K = min(proofs.fell_K.values())
        parts.append(f"polarity: fell by {number(least_K, 2)} K, {proofs.fall_needed_K:g} needed")
    if result.plays and proofs.rest_s:
        parts.append(f"{number(proofs.rest_s, 0)} s until rested")
    return " · ".join(parts) or "nothing"


def _play_text(play: MeasuredPlay, predicted: Trace) -> str:
    if play.rms_K != play.rms_K:
        return "did not begin"
    until_s = min(float(play.columns["time_s"][-1]), float(predicted.time_s[-1]))
    skin = span(float(predicted.skin_C.min()), float(predicted.skin_C.max()), "°C", 1)
    text = (
        f"{number(until_s, 2)} s{'' if play.ended else ', NOT to its end'}, display {span(*play.display_C, '°C', 1)}, "
        f"{number(1e3 * play.rms_K, 0)} mK rms from the prediction; skin not measured, predicted {skin}"
    )
    if play.rms_K > ANOTHER_LOOP_K:
        text += "; this loop is not the one that set-points are shaped for: look at its gains and its sensor's lag"
    return text
