"""A bench for experiments: a rig at rest on which stimuli are played."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import SIGN, Channel
from ..observer.constants import Both
from ..observer.observer import Observer
from .percept import perceive_many
from .received import received, uniform_clock

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace

Surface = Literal["skin", "display"]
RATE_HZ = 100.0


@dataclass(frozen=True, slots=True)
class Stimulus:
    """Stimuli played on a bench to one common end: `rows` of the `traces`, `dt_s` apart, count."""

    dt_s: float
    rows: int
    traces: tuple[Trace, ...]

    @property
    def time_s(self) -> Array:
        """Clock (rows,), s."""
        return self.dt_s * np.arange(self.rows, dtype=np.float64)

    def received(self, observer: Observer) -> Both[Array]:
        """Input of an observer's cold and warm receptors, shape (k, rows) each: °C, or W/m² into the skin."""
        each = [received(trace, observer) for trace in self.traces]
        return Both(*(np.stack([own[channel][: self.rows] for own in each]) for channel in range(2)))

    def surface_C(self, surface: Surface) -> Array:
        """Temperature of the face of the skin or of the display, °C, shape (k, rows)."""
        return np.stack([getattr(trace, f"{surface}_C")[: self.rows] for trace in self.traces])

    def felt(self, observer: Observer) -> tuple[Array, Array]:
        """Sensations (cold, warm) of the nominal person, shape (k, rows)."""
        first = self.traces[0]
        return perceive_many(*self.received(observer), self.dt_s, observer, area_m2=first.area_m2, site=first.site)


@dataclass(frozen=True, slots=True)
class Bench:
    """A rig that rests at a baseline (°C of that surface), with stimuli prescribed at the surface of skin or display.

    >>> from thermicon.circuit import Rig
    >>> bench = Bench(Rig.load("thenar"))
    >>> bench.play([ramp("warm", 0.2, 1.0, hold_s=2.0)], 3.0).rows
    301
    """

    rig: Rig
    baseline_C: float = 32.0
    surface: Surface = "skin"

    def play(self, courses: Sequence[str], end_s: float) -> Stimulus:
        """Play courses, each the body of an icon, from rest until `end_s`; at baseline, or held, after their end."""
        from thermicon.circuit import simulate
        from thermicon.circuit.solver.simulate import duration_s
        from thermicon.icons import parse

        head = f"cue 1\nset bench {{\n  control {self.surface}\n  baseline {self.baseline_C:.9g} °C\n}}\n"
        icons = list(parse(head + "\n".join(f"icon cue-{k} {{\n{body}\n}}" for k, body in enumerate(courses))))
        traces = [
            simulate(icon, self.rig, rate_Hz=RATE_HZ, tail_s=max(0.0, end_s - duration_s(icon, self.rig)))
            for icon in icons
        ]
        rows = min([round(end_s * RATE_HZ) + 1, *(uniform_clock(trace.time_s)[1] for trace in traces)])
        return Stimulus(uniform_clock(traces[0].time_s)[0], rows, tuple(traces))


def ramp(channel: Channel, size_K: float, rate_K_per_s: float, hold_s: float = 0.0, *, back: bool = False) -> str:
    """Course that cools or warms by a size at a rate, holds, and with `back` returns at that rate."""
    verb = "cool" if channel == "cold" else "warm"
    parts = [f"{verb} by {size_K:.9g} K at {rate_K_per_s:.9g} K/s"]
    parts += [f"hold for {hold_s:.9g} s"] if hold_s > 0.0 else []
    parts += [f"return at {rate_K_per_s:.9g} K/s"] if back else []
    return "; ".join(parts)


STEP_S = 0.05
"""Between two corners of a smooth pulse."""


def raised_cosine(channel: Channel, size_K: float, duration_s: float) -> str:
    """Course of one smooth pulse, size·(1 − cos 2πt/T)/2, whose corners lie on the curve."""
    time = STEP_S * np.arange(round(duration_s / STEP_S) + 1)
    levels = SIGN[channel] * 0.5 * size_K * (1.0 - np.cos(2.0 * np.pi * time / duration_s))
    moved = np.diff(levels.round(6)).tolist()
    return "\n".join(f"{'warm' if by > 0 else 'cool'} by {abs(by):.9g} K over {STEP_S:g} s" for by in moved)
