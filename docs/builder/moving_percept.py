"""A moving picture of one icon and its percept as SVG."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from thermicon.circuit import Rig, Trace, simulate
from thermicon.circuit.solver.draw import COOL, WARM, plot_temperatures
from thermicon.icons import load_library
from thermicon.icons.pictures.draw import as_svg
from thermicon.perception import Percept, perceive

ICON, RIG, TAIL_S = "cold-to-warm", "thenar", 2.0
WIDE_IN, HIGH_IN, STEP_S = 7.2, 4.2, 0.25
PLAYS, STILL_S = 3, 2.0
"""It comes to rest after so many plays; where people want no motion, this moment stands for all."""
REDUCED = "@media (prefers-reduced-motion: reduce)"
STYLE = """<style>
@keyframes now { to { transform: translateX(%(across).1fpx) } }
@keyframes cold { %(cold)s }
@keyframes warm { %(warm)s }
@keyframes said { from { opacity: 0 } %(onset).2f%% { opacity: 1 } }
#now-0, #now-1, #bar-cold, #bar-warm, #said { animation: now %(end_s)gs linear %(plays)d forwards }
#bar-cold, #bar-warm { transform-box: fill-box; transform-origin: bottom }
#bar-cold { animation-name: cold } #bar-warm { animation-name: warm }
#said { animation-name: said; animation-timing-function: step-end }
%(reduced)s {
  #now-0, #now-1, #bar-cold, #bar-warm, #said { animation-play-state: paused; animation-delay: -%(still_s)gs }
}
</style>
"""


def moving_svg(trace: Trace, percept: Percept) -> str:
    """Draw a run and what is felt of it, with a line that moves over both and bars as high as what is felt."""
    figure, end_s = Figure(figsize=(WIDE_IN, HIGH_IN)), float(percept.time_s[-1])
    places = {"wspace": 0.06, "hspace": 0.14, "left": 0.085, "right": 0.99, "bottom": 0.13, "top": 0.92}
    (above, key), (below, bars) = figure.subplots(2, 2, width_ratios=(3.6, 1.0), gridspec_kw=places)
    plot_temperatures(trace, above)
    above.set(xlabel="", title=f"{trace.icon} on the rig {trace.rig_name}: predicted")
    above.get_legend().remove()  # type: ignore[union-attr]
    key.legend(*above.get_legend_handles_labels(), loc="upper left", frameon=False, fontsize="small")
    said = f"reported as {percept.channel}\nat {percept.onset_s:.2f} s, nerves\nand decision included"
    key.text(0.5, 0.0, said, ha="center", va="bottom", fontsize="small", weight="bold", gid="said")
    key.set_axis_off()
    highest, frames = float(max(percept.psi_cold.max(), percept.psi_warm.max())), {}
    moments = np.append(np.arange(0.0, end_s, STEP_S), end_s)
    for name, colour, dashes in (("cold", COOL, "-"), ("warm", WARM, (0, (5.0, 1.2)))):
        psi = getattr(percept, f"psi_{name}")
        below.plot(percept.time_s, psi, color=colour, lw=1.8, ls=dashes)
        bars.bar(name, highest, color=colour, width=0.6, gid=f"bar-{name}")
        grown = np.interp(moments, percept.time_s, psi / highest)
        frames[name] = " ".join(
            f"{100.0 * when / end_s:.2f}% {{ transform: scaleY({share:.3f}) }}"
            for when, share in zip(moments.tolist(), grown.tolist(), strict=True)
        )
    below.set(xlabel="time (s)", ylabel="sensation (d′)")
    for k, axes in enumerate((above, below)):
        axes.axvline(0.0, color="0.15", lw=1.4, gid=f"now-{k}")
        axes.set_xlim(0.0, end_s)
    for axes in (below, bars):
        axes.set_ylim(0.0, 1.05 * highest)
        axes.spines[["top", "right"]].set_visible(False)
    above.tick_params(labelbottom=False)
    bars.set(yticks=[], xlim=(-0.6, 1.6))
    figure.align_ylabels((above, below))
    timing = {"across": below.get_position().width * WIDE_IN * 72.0, "onset": 100.0 * (percept.onset_s or 0.0) / end_s}
    style = STYLE % (frames | timing | {"end_s": end_s, "plays": PLAYS, "still_s": STILL_S, "reduced": REDUCED})
    return as_svg(above).replace("</svg>", f"{style}</svg>")


def moving_percept(write: Callable[[str, str | bytes], None]) -> str:
    """Write the moving picture of one icon, and return the Markdown that shows it."""
    trace = simulate(load_library("six-icons")[ICON], Rig.load(RIG), tail_s=TAIL_S)
    moves = moving_svg(trace, perceive(trace))
    write("moves.svg", moves)
    write("still.svg", moves.replace(REDUCED, "@media all"))
    what = f"{ICON} on the rig {RIG}, predicted: temperatures against time, and what is felt of cold and warmth"
    images = (f"```{{image}} {name}.svg\n:alt: {what}\n:class: {name}\n```\n" for name in ("moves", "still"))
    return "\n".join(images)  # site.css shows one of them: not every browser asks its user's wish inside an image
