"""Pictures of the studies: meshes against a converged one, figures of the source paper."""

from __future__ import annotations

from collections.abc import Callable
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from thermicon.circuit.solver.draw import COOL, DISPLAY, LIMIT, PROBE, SKIN, TARGET, WARM, new_axes, tidy
from thermicon.circuit.solver.trace import Trace

from .dermis_course import DermisCourse
from .meshstudy import MeshStudy
from .paper import DermisChange, MissByLimit, Thermistors, printed

MARKS = ("", "s", "o", "^", "D", "v", "x", "P")
"""Meshes carry marks, so that they are distinguishable in grey; the first, the one judged, is the thick plain line."""

COLOURS = ("#111111", "#2166ac", "#7fb0d9", "#e08214", "#b35806", "#8c8c8c", "#5e3c99", "#c994c7")


def plot_mesh_study(study: MeshStudy, ax: Axes | None = None) -> Axes:
    """Draw the size of every mesh's error in mK on a logarithmic axis; solid at cold, dashed at warm depth."""
    ax = new_axes(ax)
    for k, mesh in enumerate(study.meshes):
        colour, label = COLOURS[k % len(COLOURS)], f"{mesh.name} ({study.lumps[k]} lumps)"
        marks, wide = (MARKS[k % len(MARKS)], (k * 0.015, 0.11)), 1.2 if k else 2.2
        for depth, dashes in ((0, "-"), (1, (0, (4, 1.5)))):
            wrong = np.maximum(np.abs(study.error_K[k, depth]) * 1e3, 1e-3)
            line = ax.plot(study.time_s, wrong, color=colour, lw=wide, ls=dashes, label=None if depth else label)[0]
            line.set(marker=marks[0], markevery=marks[1], markersize=4)
    ax.set_yscale("log")
    ax.set_ylim(bottom=0.01)
    ax.set_title(f"{study.stimulus}, same {study.way}; solid cold, dashed warm depth", fontsize="small", loc="left")
    return tidy(ax, study.time_s, "error (mK)")


def plot_controlled(trace: Trace, ax: Axes | None = None) -> Axes:
    """Draw target, display and skin of the paper's cue, and say what the controlled one missed."""
    ax = new_axes(ax)
    ax.plot(trace.time_s, trace.target_C, color=TARGET, lw=5, alpha=0.45, label=f"target ({trace.control})")
    ax.plot(trace.time_s, trace.display_C, color=DISPLAY, lw=1.5, ls=(0, (5, 1.5)), label="display")
    ax.plot(trace.time_s, trace.skin_C, color=SKIN, lw=1.8, label="skin surface")
    missed = "" if trace.outcome is None else f"; {trace.outcome.reason or 'reached'}"
    ax.set_title(fill(f"{trace.control} control{missed}", 76), fontsize="small", loc="left")
    return tidy(ax, trace.time_s, "temperature (°C)")


def plot_thermistors(thermistors: Thermistors, ax: Axes | None = None) -> Axes:
    """Draw what the three thermistors read, as changes, and the depth that the third resembles most."""
    ax = new_axes(ax)
    styles = (
        ("1", DISPLAY, "--", "#1 display"),
        ("2", SKIN, "-", "#2 interface"),
        ("3", PROBE, (0, (5, 1.5)), "#3 insulated skin"),
    )
    for name, colour, dashes, label in styles:
        read = thermistors.trace.probe(name)
        ax.plot(thermistors.trace.time_s, read - read[0], color=colour, lw=1.8, ls=dashes, label=label)
    depth = f"skin at {thermistors.likeness.depth_m * 1e3:.2f} mm"
    ax.plot(
        thermistors.trace.time_s, thermistors.depth_C - thermistors.depth_C[0], color=COOL, lw=1.2, ls=":", label=depth
    )
    ax.axhline(0, color="#cccccc", lw=0.8, zorder=0)
    title = f"insulated patch {thermistors.lateral_m * 1e3:.2g} mm from skin in contact"
    ax.set_title(title, fontsize="small", loc="left")
    return tidy(ax, thermistors.trace.time_s, "change (K)")


def plot_dermis(dermis: DermisChange, ax: Axes | None = None) -> Axes:
    """Draw largest change and fastest fall against depth on a logarithmic axis, with the paper's two numbers."""
    ax = new_axes(ax)
    depth = dermis.depth_m * 1e3
    change_K, rate = printed().one("dermis change").central, printed().one("dermis rate").central
    ax.plot(depth, dermis.change_K, color=COOL, lw=1.8, label="largest change (K)")
    ax.plot(depth, dermis.fastest_K_per_s, color=WARM, lw=1.8, ls=(0, (5, 1.5)), label="fastest fall (K/s)")
    ax.axhline(change_K, color=COOL, lw=0.9, ls=":", label=f"paper: about {change_K:g} °C")
    ax.axhline(rate, color=WARM, lw=0.9, ls=":", label=f"paper: about {rate:g} °C/s")
    for place, where in enumerate(dermis.receptor_m):
        ax.axvline(where * 1e3, color=LIMIT, lw=0.9, ls="-.", label=None if place else "receptor depths")
    ax.set_yscale("log")
    ax.set_yticks([0.05, 0.1, 0.2, 0.5, 1, 2, 5], ["0.05", "0.1", "0.2", "0.5", "1", "2", "5"])
    ax.set_title(
        f"{dermis.rig_name}: the paper's numbers belong to a depth, not to the receptors", fontsize="small", loc="left"
    )
    tidy(ax, depth, "K, K/s")
    ax.set_xlabel("depth (mm)")
    return ax


def plot_dermis_course(course: DermisCourse, ax: Axes | None = None) -> Axes:
    """Draw changes inside the dermis, shallow ones dark, and that of the thermistor on insulated skin."""
    ax = new_axes(ax)
    styles = (("#0b3c6f", "-"), (COOL, (0, (6, 1.5))), ("#7fb0d9", (0, (3, 1.2))), ("#7fb0d9", ":"))
    for k, (depth, change) in enumerate(zip(course.depth_m, course.change_K, strict=True)):
        colour, dashes = styles[min(k, len(styles) - 1)]
        ax.plot(course.time_s, change, color=colour, lw=1.8, ls=dashes, label=f"{1e3 * depth:.2f} mm deep")
    ax.plot(course.time_s, course.insulated_K, color=PROBE, lw=1.6, ls=(0, (5, 1.5)), label="#3 insulated skin")
    ax.axhline(0, color="#cccccc", lw=0.8, zorder=0)
    ax.set_title(f"{course.rig_name}: inside the dermis, and #3 on insulated skin", fontsize="small", loc="left")
    return tidy(ax, course.time_s, "change (K)")


def plot_miss(misses: MissByLimit, ax: Axes | None = None) -> Axes:
    """Draw the largest miss against the current limit; filled where the cue counts as reached."""
    ax = new_axes(ax)
    module_A = printed().one("module current").central
    ax.plot(misses.limit_A, misses.miss_K, color=COOL, lw=1.6)
    reached = np.array(misses.reached)
    for which, face, label in ((reached, COOL, "reached"), (~reached, "white", "missed")):
        ax.plot(misses.limit_A[which], misses.miss_K[which], "o", color=COOL, mfc=face, label=label)
    ax.axvline(misses.shipped_A, color=DISPLAY, lw=1.2, ls="--", label=f"this rig's {misses.shipped_A:g} A")
    ax.axvline(module_A, color=LIMIT, lw=1.6, ls=":", label=f"the module's own {module_A:g} A")
    ax.set_ylim(bottom=0)
    tidy(ax, misses.limit_A, "largest miss (K)")
    ax.set_xlabel("current limit (A)")
    ax.set_title(f"{misses.rig_name}, cue on the skin", fontsize="small", loc="left")
    return ax


def stacked_figure(*drawn: tuple[Callable[[Any, Axes], Axes], Any]) -> Figure:
    """Return a figure with one panel below the other: functions that draw, and what each draws."""
    figure = Figure(figsize=(7.4, 2.9 * len(drawn)), layout="constrained")
    for panel, (plot, data) in zip(np.atleast_1d(figure.subplots(len(drawn), 1)), drawn, strict=True):
        plot(data, panel)
    return figure
