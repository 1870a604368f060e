"""Figures for people: one icon from drive to sensation, and one set as two heat maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from thermicon.circuit.rig.load import LOAD_SITES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Trace
    from thermicon.perception import Percept, Ranking

COOL, WARM = "#2166ac", "#e08214"
BROAD = "#b9bec4"
"""A broad line below a thin one: the first of two, or what was predicted before."""
FLAT = 0.75
"""Height of a cell to its width, where two heat maps stand below one another."""
INK, GREY, TARGET, LIMIT = "#1a1a1a", "#6a6a6a", "#cfe3cf", "#b2182b"


def overview(trace: Trace, percept: Percept | None = None, rig_changes: Sequence[str] = ()) -> Figure:
    """Draw one icon on one clock: temperatures, heat flow, current and, with a percept, sensation.

    Parameters
    ----------
    trace
        The run.
    percept
        What is felt of it; None: no panel of sensation.
    rig_changes
        Changes of the rig, named in the title.

    Returns
    -------
    matplotlib.figure.Figure
        A figure that is not shown. Line styles differ as well as colours, so that it can be printed in grey.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> trace = simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))
    >>> [ax.get_ylabel() for ax in overview(trace).axes][2]
    'current (A)'
    """
    from matplotlib.figure import Figure

    panels = [_temperatures, _heat_flow, *([_current] if trace.has_current else [])]
    figure = Figure(figsize=(8.0, 8.4 if percept is not None else 6.4), layout="constrained")
    count = len(panels) + (percept is not None)
    heights = [1.5, 1.2, *([0.9] if trace.has_current else []), *([] if percept is None else [1.1])]
    axes = figure.subplots(count, 1, sharex=True, height_ratios=heights)
    for panel, ax in zip(panels, axes, strict=False):
        panel(trace, ax)
    if percept is not None:
        _sensation(percept, axes[-1])
    for ax in axes:
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)
        ax.margins(x=0.0)
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)
    axes[-1].set_xlabel("time (s)")
    figure.align_ylabels(axes)
    icon = trace.icon or "drive"
    what_if = f" with {', '.join(rig_changes)}" if rig_changes else ""
    figure.suptitle(f"{icon} on the {trace.rig_name} rig{what_if}", fontsize=11, wrap=True)
    return figure


def _temperatures(trace: Trace, ax: Axes) -> None:
    from numpy import isfinite

    t = trace.time_s
    if isfinite(trace.target_C).any():  # a broad band underneath, since the controlled line lies on it
        ax.plot(t, trace.target_C, color=TARGET, lw=5.0, solid_capstyle="butt", label="target")
    ax.plot(t, trace.display_C, color=GREY, lw=1.2, ls=(0, (6, 2)), label="display")
    if trace.site in LOAD_SITES:
        ax.plot(t, trace.skin_C, color=INK, lw=1.6, label=trace.site)
    else:
        ax.plot(t, trace.skin_C, color=INK, lw=1.6, label="skin")
        ax.plot(t, trace.cold_receptor_C, color=COOL, lw=1.4, ls="-.", label="cold receptor")
        ax.plot(t, trace.warm_receptor_C, color=WARM, lw=1.4, ls="--", label="warm receptor")
    ax.set_ylabel("temperature (°C)")


def _heat_flow(trace: Trace, ax: Axes) -> None:
    t = trace.time_s
    ax.axhline(0.0, color=GREY, lw=0.6)
    if trace.site in LOAD_SITES:
        ax.plot(t, trace.heat_flow_skin_W_per_m2 / 1e3, color=INK, lw=1.6, label="display")
        ax.set_ylabel(f"heat flow into\nthe {trace.site} (kW/m²)")
        return
    ax.plot(t, trace.heat_flow_skin_W_per_m2 / 1e3, color=INK, lw=1.6, label="skin surface")
    ax.plot(t, trace.heat_flow_cold_receptor_W_per_m2 / 1e3, color=COOL, lw=1.4, ls="-.", label="cold receptor")
    ax.plot(t, trace.heat_flow_warm_receptor_W_per_m2 / 1e3, color=WARM, lw=1.4, ls="--", label="warm receptor")
    ax.set_ylabel("heat flow\ninto skin (kW/m²)")


def _current(trace: Trace, ax: Axes) -> None:
    low, high = trace.driver_limits_A
    ax.axhline(0.0, color=GREY, lw=0.6)
    ax.plot(trace.time_s, trace.current_A, color=INK, lw=1.1, drawstyle="steps-post", label="current\n(+ cools)")
    for k, limit in enumerate((low, high)):
        ax.axhline(limit, color=LIMIT, lw=1.0, ls=(0, (2, 2)), label="driver's limits" if k == 0 else None)
    ax.set_ylabel("current (A)")


def _sensation(percept: Percept, ax: Axes) -> None:
    from numpy import arange

    t = arange(len(percept.psi_cold)) * percept.dt_s
    ax.plot(t, percept.psi_cold, color=COOL, lw=1.5, ls="-.", label="cold")
    ax.plot(t, percept.psi_warm, color=WARM, lw=1.5, ls="--", label="warm")
    if percept.onset_s is not None:
        said = f"reported as {percept.channel}\nat {percept.onset_s:.2f} s by the\nnominal person\n(response clock)"
        ax.axvline(percept.onset_s, color=INK, lw=1.0, ls=":", label=said)
    else:
        ax.plot([], [], " ", label=f"not felt by the\nnominal person\n(p {percept.detected_probability:.2f})")
    ax.set_ylabel(f"sensation (d′)\n{percept.clock} clock")


def set_figure(ranking: Ranking, stacked: bool = False) -> Figure:
    """Draw who is confused with whom: distances (d′) and predicted confusions of one set, side by side.

    Parameters
    ----------
    ranking
        The ranking of the set.
    stacked
        Whether the second stands below the first, as in a narrow column.

    Returns
    -------
    matplotlib.figure.Figure
        A figure that is not shown.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import load_library
    >>> from thermicon.perception import rank
    >>> ranking = rank(load_library("six-icons"), Rig.load("thenar"), people=20)
    >>> len(set_figure(ranking).axes) >= 2
    True
    """
    from matplotlib.figure import Figure

    from thermicon.perception.plots import draw_heat

    longest = max(map(len, map(draw_heat.short, ranking.labels)))
    side = max(4.2, 1.2 + 0.07 * longest + 0.45 * len(ranking.labels))
    down, across = (2, 1) if stacked else (1, 2)
    names = 0.06 * longest if stacked else 0.0  # of the upper one, which stand below the lower one
    high = down * (FLAT if stacked else 1.0) * side - names
    figure = Figure(figsize=(across * (side + 0.6), high), layout="constrained")
    distance, confusion = figure.subplots(down, across)
    draw_heat.plot_distance(ranking, ax=distance)
    draw_heat.plot_confusion(ranking, ax=confusion)
    if stacked:
        distance.set_xlabel("")
        distance.tick_params(labelbottom=False)
        for ax in (distance, confusion):
            ax.set_aspect(FLAT)
    return figure
