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
    from matplotlib.figure import Figure

    from thermicon.circuit import Trace
    from thermicon.circuit.fitting.log import Log

FELT_TAIL_S = 10.0
"""How long an overview follows sensation after the last corner at most, unless a tail is given."""
STILL = 0.1
"""What stays within 10 % of its panel's range of its end has come to rest."""


def draw_overview(
    trace: Trace,
    picture: Path,
    rig_changes: Sequence[str] = (),
    measured: Log | None = None,
    look: Look = SCREEN,
    *,
    settled: bool = False,
) -> None:
    """Write the overview figure of one trace, its percept included where there is skin, beside a measured log.

    `settled`: the time axis ends when everything has come to rest, rather than with the trace.
    """
    from thermicon.circuit.rig.load import LOAD_SITES
    from thermicon.perception import perceive

    from .overview import overview

    trace = on_one_clock(trace)
    figure = overview(trace, None if trace.site in LOAD_SITES else perceive(trace), rig_changes)
    if measured is not None:
        ax = figure.axes[0]
        measured.draw_beside(trace, ax)
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)
    if settled:
        end_when_settled(figure)
    write_figure(figure, picture, look)


def end_when_settled(figure: Figure) -> None:
    """End the time axis soon after the last line has come within 10 % of its panel's range of its end."""
    ends = [0.0]
    for ax in figure.axes:
        courses = [numpy.asarray(line.get_ydata(), dtype=float) for line in ax.lines]
        most = max([1e-9, *(float(numpy.nanmax(y) - numpy.nanmin(y)) for y in courses if numpy.isfinite(y).sum() > 2)])
        for line in ax.lines:
            time, values = (numpy.asarray(each, dtype=float) for each in line.get_data())
            there = numpy.isfinite(values)
            if there.sum() < 3:
                ends.append(float(time.max()) if time.size and line.get_linestyle() == ":" else 0.0)
                continue
            time, values = time[there], values[there]
            moving = numpy.flatnonzero(numpy.abs(values - values[-1]) > STILL * most)
            ends.append(float(time[moving[-1]]) if moving.size else 0.0)
    low, high = figure.axes[-1].get_xlim()
    if max(ends) > 0.0:
        figure.axes[-1].set_xlim(low, min(high, 1.05 * max(ends)))


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
