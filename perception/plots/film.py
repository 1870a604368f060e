"""The film of one icon: its temperatures and what is felt of it, with a line that moves over both."""

from __future__ import annotations

import math
from base64 import b64encode
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.files.atomic import OutputError, complete_or_absent
from thermicon.base.numbers.arrays import Array
from thermicon.circuit.solver.draw import COOL, WARM, plot_temperatures
from thermicon.icons.pictures.draw import as_svg

from ..sensation.percept import Percept

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter
    from matplotlib.figure import Figure

    from thermicon.circuit import Trace

SUFFIXES = (".svg", ".gif", ".mp4")
NO_FFMPEG = (
    "an .mp4 needs the program ffmpeg, which is not installed (apt install ffmpeg, brew install ffmpeg or conda "
    "install ffmpeg); or write a .gif or an .svg, which need nothing"
)
WIDE_IN, HIGH_IN, DPI = 7.2, 4.2, 100
STEP_S, MOST_FRAMES = 0.1, 600
"""A frame lasts so long; in a film of more than a minute longer, since a file holds at most so many."""
GIF_STEP_S, ROUNDED_S = 0.01, 5e-4
"""A GIF counts time in these steps; its writer cuts a frame to whole ms, so half of one more keeps what was asked."""
PLAYS = 3
"""It comes to rest after so many plays; where people want no motion, one moment stands for all."""
GREY, LEAST_D_PRIME = "0.6", 1.0
"""What is not felt is grey, and not drawn larger than this allows."""
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


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """A run and what is felt of it as a moving picture in real time, which a notebook shows."""

    trace: Trace
    percept: Percept

    @property
    def title(self) -> str:
        """What the film shows, in one line."""
        return f"{self.trace.icon or 'drive'} on the rig {self.trace.rig_name}: predicted"

    @property
    def moments_s(self) -> Array:
        """Times of the frames in s, evenly apart, the last at the end."""
        end_s = float(self.percept.time_s[-1])
        step_s = max(STEP_S, GIF_STEP_S * math.ceil(end_s / MOST_FRAMES / GIF_STEP_S))
        frames = math.ceil(end_s / step_s - 1e-6) + 1
        moments: Array = np.minimum(step_s * np.arange(frames), end_s)
        return moments

    def svg(self, *, still: bool = False) -> str:
        """Return the film as SVG text, which moves three times; it stands still where people want no motion.

        ``still``: a picture without motion, at the strongest sensation and not before the report.
        """
        figure, _ = self._drawn()
        above, below = figure.axes[0], figure.axes[2]
        percept, end_s = self.percept, float(self.percept.time_s[-1])
        shares: dict[str, str] = {}
        for name, psi in (("cold", percept.psi_cold), ("warm", percept.psi_warm)):
            grown = np.interp(self.moments_s, percept.time_s, psi / psi.max()) if psi.max() > 0.0 else self.moments_s
            shares[name] = " ".join(
                f"{100.0 * when / end_s:.2f}% {{ transform: scaleY({share:.3f}) }}"
                for when, share in zip(self.moments_s.tolist(), grown.tolist(), strict=True)
            )
        onset_s = percept.onset_s or 0.0
        strongest_s = float(percept.time_s[np.maximum(percept.psi_cold, percept.psi_warm).argmax()])
        timing = {
            "across": below.get_position().width * WIDE_IN * 72.0,
            "onset": 100.0 * onset_s / end_s,
            "still_s": min(max(strongest_s, onset_s), end_s),
            "reduced": "@media all" if still else REDUCED,
        }
        style = STYLE % (shares | timing | {"end_s": end_s, "plays": PLAYS})
        return as_svg(above).replace("</svg>", f"{style}</svg>")

    def save(self, path: str | Path) -> None:
        """Write the film as .svg, .gif or, where ffmpeg is installed, .mp4; OutputError where it cannot be written."""
        path = Path(path)
        writer = movie_writer(path, float(self.moments_s[1]))
        with complete_or_absent(path) as draft:
            if writer is None:
                draft.write_text(self.svg(), encoding="utf-8")
                return
            figure, show = self._drawn()
            with writer.saving(figure, str(draft), DPI):
                for moment_s in self.moments_s.tolist():
                    show(moment_s)
                    writer.grab_frame()

    def _drawn(self) -> tuple[Figure, Callable[[float], None]]:
        """The figure with its bars as high as they ever are, and what makes it show another moment (s)."""
        from matplotlib.figure import Figure

        trace, percept = self.trace, self.percept
        figure = Figure(figsize=(WIDE_IN, HIGH_IN))
        places = {"wspace": 0.06, "hspace": 0.14, "left": 0.105, "right": 0.99, "bottom": 0.13, "top": 0.92}
        (above, key), (below, bars) = figure.subplots(2, 2, width_ratios=(3.6, 1.0), gridspec_kw=places)
        plot_temperatures(trace, above)
        above.set(xlabel="")
        above.set_title(self.title, fontsize="medium").set_parse_math(False)
        above.get_legend().remove()
        key.legend(*above.get_legend_handles_labels(), loc="upper left", frameon=False, fontsize="small")
        felt = f"reported as {percept.channel}\nat {percept.onset_s or 0.0:.2f} s, nerves\nand decision included"
        unfelt = f"not felt (reported\nin {100.0 * percept.detected_probability:.0f} % of trials)"
        look = {"ha": "center", "va": "bottom", "fontsize": "small", "weight": "bold"}
        said = key.text(0.5, 0.0, felt if percept.felt else unfelt, gid="said" if percept.felt else None, **look)
        key.set_axis_off()
        highest, sides = LEAST_D_PRIME, []
        for name, psi, colour, dashes in (
            ("cold", percept.psi_cold, COOL, "-"),
            ("warm", percept.psi_warm, WARM, (0, (5.0, 1.2))),
        ):
            below.plot(percept.time_s, psi, color=colour, lw=1.8, ls=dashes)
            [bar] = bars.bar(
                name, float(psi.max()), color=colour if percept.felt else GREY, width=0.6, gid=f"bar-{name}"
            )
            highest = max(highest, float(psi.max()))
            sides.append((bar, psi))
        below.set(xlabel="time (s)", ylabel="sensation (d′)")
        for axes in (below, bars):
            axes.set_ylim(0.0, 1.05 * highest)
            axes.spines[["top", "right"]].set_visible(False)
        lines = [axes.axvline(0.0, color="0.15", lw=1.4, gid=f"now-{k}") for k, axes in enumerate((above, below))]
        for axes in (above, below):
            axes.set_xlim(0.0, float(percept.time_s[-1]))
        above.tick_params(labelbottom=False)
        bars.set(yticks=[], xlim=(-0.6, 1.6))
        figure.align_ylabels((above, below))

        def show(moment_s: float) -> None:
            for line in lines:
                line.set_xdata([moment_s, moment_s])
            for bar, psi in sides:
                bar.set_height(float(np.interp(moment_s, percept.time_s, psi)))
            said.set_visible(moment_s >= (percept.onset_s or 0.0))

        return figure, show

    def _repr_html_(self) -> str:
        moves, stands = (
            f"data:image/svg+xml;base64,{b64encode(self.svg(still=still).encode()).decode()}" for still in (False, True)
        )
        said = escape(f"{self.title}, {self.percept.summary}")
        wish = REDUCED.removeprefix("@media ")  # asked outside of the image, where every browser knows it
        return f'<picture><source media="{wish}" srcset="{stands}"><img src="{moves}" alt="{said}"></picture>'


def movie_writer(path: Path, frame_s: float = STEP_S) -> AbstractMovieWriter | None:
    """Return what writes frames into a file, by its ending; None for .svg, and OutputError where there is nothing."""
    suffix = path.suffix.lower()
    if suffix == ".svg":
        return None
    if suffix not in SUFFIXES:
        raise OutputError(f"cannot write {path}: a film is written as {' or '.join(SUFFIXES)}")
    from matplotlib.animation import FFMpegWriter, PillowWriter

    if suffix == ".gif":
        return PillowWriter(fps=1.0 / (frame_s + ROUNDED_S))  # type: ignore[arg-type]
    if not FFMpegWriter.isAvailable():
        raise OutputError(f"cannot write {path}: {NO_FFMPEG}")
    return FFMpegWriter(fps=1.0 / frame_s)  # type: ignore[arg-type]
