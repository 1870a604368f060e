"""Frames for the canvas: a scene as plain data with one float32 array for every curve.

Colours are named by role only; which they are is for the canvas and its themes to say.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import asdict, dataclass, field
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermicon.base.words.number_text import signed
from thermicon.circuit.solver.simulate import duration_s
from thermicon.perception.sensation.received import uniform_clock

from .marks import FELT_DPRIME
from .scene import Drawing, Scene

Floats = NDArray[np.float32]
MOST_POINTS = 3_000
"""Intervals that a curve is drawn with, at most; a long run is thinned to every k-th row."""
DRAGGED_POINTS = 750
"""The same while a corner is dragged, which is more than the plot has pixels; the last frame of a drag is whole."""
DASHED, DASH_DOT = [7, 3], [8, 3, 2, 3]
WORDS: dict[str, Any] = tomllib.loads(
    (files("thermicon.notebooks") / "data" / "workbench.toml").read_text(encoding="utf-8")
)
"""What words of the field mean, and what is said behind "?"."""


def terms_of(*names: str) -> list[list[str]]:
    """Words with their meanings, as the canvas takes them.

    >>> terms_of("clock")
    [['clock', 'which event time counts from: receptor, percept or response']]
    """
    meanings = WORDS["terms"] | WORDS["simulated"]
    return [[name, meanings[name].replace("`", "")] for name in names]


@dataclass(frozen=True, slots=True)
class CanvasFrame:
    """A message to the canvas: ``meta`` for JSON, and the arrays in the order of their ``buffer`` numbers."""

    meta: dict[str, Any]
    buffers: tuple[Floats, ...]

    def numbered(self, seq: int, ms: float, text: str | None, can_undo: bool, can_redo: bool) -> CanvasFrame:
        """The frame as the answer to a message: its number, what it took, the text if the editor is to take it."""
        own = {"seq": seq, "ms": _number(ms), "text": text, "can_undo": can_undo, "can_redo": can_redo}
        return CanvasFrame({**self.meta, **own}, self.buffers)


@dataclass(slots=True)
class _Curves:
    """Arrays on one clock, taken in one by one."""

    rows: slice
    buffers: list[Floats] = field(default_factory=list)

    def take(self, key: str, label: str, values: NDArray[np.float64], role: str, **look: Any) -> dict[str, Any]:
        """Take the values of a curve, and return the series that stands for it; ``look``: dash, width, step."""
        self.buffers.append(np.ascontiguousarray(values[self.rows], dtype=np.float32))
        return {"key": key, "label": label, "buffer": len(self.buffers) - 1, "role": role, **look}


def frame_of(scene: Scene, points: int = MOST_POINTS) -> CanvasFrame:
    """Return the frame of a scene in the design view; ``numbered`` makes it the answer to a message.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.notebooks.timeline.scene import scene
    >>> made = frame_of(scene("cue 1; icon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s }", Rig.load("thenar")))
    >>> [panel["key"] for panel in made.meta["panels"]], made.meta["time"]["n"], len(made.buffers)
    (['temperature', 'heat', 'current', 'sensation'], 1401, 11)
    """
    badge = scene.badge
    meta: dict[str, Any] = {
        "type": "frame",
        "view": "design",
        "icons": list(scene.names),
        "icon": scene.icon,
        "of": scene.text,
        "troubles": [asdict(each) for each in scene.troubles],
        "stale": scene.stale,
        "badge": {"colour": badge.colour, "text": badge.text, "more": list(badge.more)},
        "notes": list(scene.notes),
        "handles": [],
    }
    if (drawing := scene.drawing) is None:
        return CanvasFrame({**meta, "time": {"t0": 0.0, "dt": 0.0, "n": 0}, "panels": []}, ())
    trace = drawing.trace
    dt, rows = uniform_clock(trace.time_s)
    every = max(1, math.ceil((rows - 1) / points))
    curves = _Curves(slice(0, rows, every))
    panels = [_temperature(drawing, curves), _heat(drawing, curves)]
    if trace.has_current:  # a thermode has none
        panels.append(_current(drawing, curves))
    if len(drawing.percept.psi_cold) >= rows:
        panels.append(_sensation(drawing, curves))
    meta["play"] = _play(drawing)
    meta["time"] = {"t0": float(trace.time_s[0]), "dt": dt * every, "n": len(curves.buffers[0])}
    if not scene.stale:
        panel = "current" if trace.control == "current" else "temperature"
        for told in map(asdict, drawing.handles):
            meta["handles"].append({"t": told.pop("time_s"), "y": told.pop("level"), "panel": panel, **told})
    return CanvasFrame({**meta, "panels": panels}, tuple(curves.buffers))


def _play(drawing: Drawing) -> dict[str, Any]:
    """How long a preview lasts, to the end of the icon and of what is felt of it, and what it says of it."""
    percept, end_s = drawing.percept, float(drawing.trace.time_s[-1])
    told: dict[str, Any] = {"felt": percept.felt, "share": percept.detected_probability}
    last_s = duration_s(drawing.icon, drawing.rig)
    if percept.felt:
        last_s = max(last_s, percept.onset_s or 0.0)
        faint = np.maximum(percept.psi_cold, percept.psi_warm)[percept.time_s >= last_s] < FELT_DPRIME
        last_s += percept.dt_s * int(faint.argmax()) if faint.any() else end_s
        told |= {"onset": percept.onset_s, "quality": percept.channel}
    return {**told, "until": min(float(last_s), end_s)}


def _temperature(drawing: Drawing, curves: _Curves) -> dict[str, Any]:
    trace = drawing.trace
    series = []
    if np.isfinite(trace.target_C).any():  # a broad band underneath, since the controlled line lies on it
        series.append(curves.take("target", "target", trace.target_C, "target", width=6.0))
    series += [
        curves.take("display", "display", trace.display_C, "grey", dash=DASHED, width=1.25),
        curves.take("skin", "skin", trace.skin_C, "ink", width=1.75),
        curves.take("cold", "cold receptor", trace.cold_receptor_C, "cool", dash=DASH_DOT),
        curves.take("warm", "warm receptor", trace.warm_receptor_C, "warm", dash=DASHED),
    ]
    marks = [
        _mark(moment.time_s, moment.label, moment.channel, float(np.interp(moment.time_s, trace.time_s, trace.skin_C)))
        for moment in drawing.moments
        if moment.kind == "physical peak"
    ]
    return _panel(drawing, "temperature", "temperature (°C)", 1.7, series, marks=marks)


def _heat(drawing: Drawing, curves: _Curves) -> dict[str, Any]:
    trace = drawing.trace
    series = [
        curves.take("skin", "skin surface", trace.heat_flow_skin_W_per_m2 / 1e3, "ink", width=1.75),
        curves.take("cold", "cold receptor", trace.heat_flow_cold_receptor_W_per_m2 / 1e3, "cool", dash=DASH_DOT),
        curves.take("warm", "warm receptor", trace.heat_flow_warm_receptor_W_per_m2 / 1e3, "warm", dash=DASHED),
    ]
    return _panel(drawing, "heat", "heat flow into skin (kW/m²)", 0.85, series, missed=False, folds=True)


def _current(drawing: Drawing, curves: _Curves) -> dict[str, Any]:
    trace = drawing.trace
    held = trace.control in ("skin", "display")
    series = [curves.take("current", "current (+ cools)", trace.current_A, "ink", width=1.25, step=held)]
    low, high = trace.driver_limits_A
    levels = [
        {"at": _number(at), "label": f"driver's limit {signed(at, '.3g')} A", "role": "limit"} for at in (high, low)
    ]
    return _panel(drawing, "current", "current (A)", 0.85, series, levels=levels)


def _sensation(drawing: Drawing, curves: _Curves) -> dict[str, Any]:
    percept = drawing.percept
    series = [
        curves.take("cold", "cold", percept.psi_cold, "cool", dash=DASH_DOT, width=1.75),
        curves.take("warm", "warm", percept.psi_warm, "warm", dash=DASHED, width=1.75),
    ]
    marks = [
        _mark(moment.time_s, f"{moment.label}, p {percept.detected_probability:.2f}", None, None)
        if moment.kind == "onset"
        else _mark(moment.time_s, moment.label, moment.channel, None)
        for moment in drawing.moments
    ]
    # A label that changed with the icon would have the page build its panels anew.
    label = "sensation (d′) of the nominal person, receptor clock"
    terms = terms_of("d′", "sensation ψ", "onset", "clock", "nominal person")
    return _panel(drawing, "sensation", label, 1.7, series, marks=marks, missed=False, digits=1, terms=terms)


def _panel(
    drawing: Drawing,
    key: str,
    label: str,
    height: float,
    series: list[dict[str, Any]],
    missed: bool = True,
    **more: Any,
) -> dict[str, Any]:
    """A panel of the canvas; `more` are its levels, marks, digits and terms, and whether it `folds`."""
    spans = [{"from": span.from_s, "to": span.to_s, "label": span.label} for span in drawing.missed if missed]
    own = {"key": key, "label": label, "height": height, "series": series, "spans": spans}
    return {**own, "levels": [], "marks": [], "digits": 2, "terms": [], "folds": False, **more}


def _mark(time_s: float, label: str, channel: str | None, value: float | None) -> dict[str, Any]:
    role = {None: "ink", "cold": "cool", "warm": "warm"}[channel]
    return {"t": _number(time_s), "label": label, "role": role, "y": None if value is None else _number(value)}


def _number(value: float) -> float | None:
    """A number that JSON has; None for what is not finite."""
    return float(value) if math.isfinite(value) else None
