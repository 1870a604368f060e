"""The overview figure of one trace as a file, with its percept, on one clock."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy

from .figure_look import SCREEN, Look
from .print_figure import write_figure

if TYPE_CHECKING:
    from thermicon.circuit import Trace
    from thermicon.circuit.fitting.log import Log

FELT_TAIL_S = 10.0
"""How long an overview follows sensation after the last corner, unless a tail is given."""


def draw_overview(
    trace: Trace,
    picture: Path,
    rig_changes: Sequence[str] = (),
    measured: Log | None = None,
    look: Look = SCREEN,
) -> None:
    """Write the overview figure of one trace, its percept included where there is skin, beside a measured log."""
    from thermicon.circuit.rig.load import LOAD_SITES
    from thermicon.perception import perceive

    from .overview import overview

    trace = on_one_clock(trace)
    figure = overview(trace, None if trace.site in LOAD_SITES else perceive(trace), rig_changes)
    if measured is not None:
        ax = figure.axes[0]
        measured.draw_beside(trace, ax)
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)
    write_figure(figure, picture, look)


def on_one_clock(trace: Trace) -> Trace:
    """Drop the last row where it comes off the beat, as when a drive ends between two rows."""
    steps = numpy.diff(trace.time_s)
    if len(steps) < 2 or abs(steps[-1] - steps[0]) < 1e-6 * steps[0]:
        return trace
    return dataclasses.replace(
        trace,
        **{
            field.name: getattr(trace, field.name)[:-1]
            for field in dataclasses.fields(trace)
            if isinstance(getattr(trace, field.name), numpy.ndarray)
        },
    )
