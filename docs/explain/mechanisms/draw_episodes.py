"""Pictures of remembered episodes below the sensation over time."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from thermicon.circuit.solver.draw import COOL, WARM
from thermicon.perception.identification.episodes import Episode
from thermicon.perception.sensation.percept import Percept

HEADROOM = 1.42
"""Room above the highest peak for the words of an episode, in multiples of it."""


def episodes_figure(icons: Sequence[tuple[Percept, Sequence[Episode]]], bar: float) -> Figure:
    """Draw icons one below the other: both sensations, the bar of an episode (d′), what is remembered as bands."""
    figure = Figure(figsize=(6.4, 2.5 * len(icons) + 0.4), layout="constrained")
    panels = figure.subplots(len(icons), sharex=True, squeeze=False)[:, 0]
    for (percept, episodes), axes in zip(icons, panels, strict=True):
        axes.plot(percept.time_s, percept.psi_cold, color=COOL, lw=1.8, label="cold")
        axes.plot(percept.time_s, percept.psi_warm, color=WARM, lw=1.8, ls=(0, (5, 1.2)), label="warm")
        axes.axhline(bar, color="0.35", lw=0.9, ls=":", label="bar")
        highest = max(float(percept.psi_cold.max()), float(percept.psi_warm.max()), 1.5 * bar)
        for k, episode in enumerate(episodes):
            psi, colour = (percept.psi_cold, COOL) if episode.channel == "cold" else (percept.psi_warm, WARM)
            felt = (percept.time_s >= episode.start_s) & (psi >= 0.5 * bar)
            after = percept.time_s[(percept.time_s >= episode.start_s) & ~felt]
            end_s = float(after[0]) if after.size else float(percept.time_s[-1])
            if k + 1 < len(episodes):
                end_s = min(end_s, episodes[k + 1].start_s)
            axes.axvspan(episode.start_s, end_s, color=colour, alpha=0.12, lw=0)
            length = "" if episode.cut else f"\nlasts {episode.length_s:.1f} s"
            words = f"{episode.peak:.0f} × threshold\nrises {episode.rate_per_s:.1f}/s{length}"
            axes.axvline(episode.start_s, color=colour, lw=0.8)
            axes.text(episode.start_s + 0.1, HEADROOM * highest * 0.98, words, va="top", fontsize="small")
        axes.set(xlim=(0.0, float(percept.time_s[-1])), ylim=(0.0, HEADROOM * highest))
        axes.set(xlabel="time (s), receptor clock", ylabel="sensation (d′)")
        axes.set_title(percept.icon or "percept", loc="left", fontsize="medium")
        axes.spines[["top", "right"]].set_visible(False)
        axes.label_outer()
    panels[0].legend(fontsize="small", loc="upper right", ncols=3, frameon=False, bbox_to_anchor=(1.0, 1.16))
    return figure
