"""The figure of live play."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from thermicon.circuit.live.ready import SENSORS
from thermicon.circuit.play.watch import BESIDE_K, BESIDE_S

from .print_figure import themed_svg
from .style import COOL, INK, TARGET, new_figure, plain

if TYPE_CHECKING:
    from thermicon.circuit import Trace


class LiveFigure:
    """One play of an icon whose prediction is a trace with the probes of live play; it is drawn again and again.

    The band is what the guard lets pass at length; corners of a rig differ by far less where a loop holds the display.
    """

    def __init__(self, name: str, predicted: Trace) -> None:
        self._figure = new_figure(6.6, 3.8)
        axes: Any = self._figure.subplots()
        time_s, due_C = predicted.time_s, dict(predicted.probes)[SENSORS[0]]
        band = f"the guard stops beyond ± {BESIDE_K:g} K for {BESIDE_S:g} s"
        axes.fill_between(time_s, due_C - BESIDE_K, due_C + BESIDE_K, color=TARGET, lw=0.0, label=band)
        axes.plot(time_s, predicted.skin_C, color=INK, ls=(0, (2, 2)), lw=1.0, label="skin, predicted, not measured")
        axes.plot(time_s, due_C, color=COOL, ls=(0, (6, 2)), lw=1.0, label="display, predicted")
        (self._line,) = axes.plot([], [], color=INK, lw=1.8, label="display, measured")
        axes.set_ylabel("temperature (°C)")
        axes.set_xlabel("time (s)")
        axes.set_title(f"{name}, played by a device", fontsize=11)
        axes.margins(x=0.0)
        plain(axes)
        self._figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize=8)
        self._figure.draw_without_rendering()
        self._figure.set_layout_engine("none")  # laid out once: only the line grows

    def svg(self, time_s: Sequence[float], display_C: Sequence[float]) -> str:
        """Draw it with what was measured so far."""
        self._line.set_data(time_s, display_C)
        return themed_svg(self._figure)
