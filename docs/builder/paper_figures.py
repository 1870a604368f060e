"""The source paper's figures as thermicon computes them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from gallery import png

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples" / "source-paper"))

CAPTIONS = {
    "figure-3": "Figure 3: the current that makes the step of the skin, and what display and skin then do.",
    "figure-4": "Figure 4: the same cue prescribed on the display, as in the experiment that the paper compares with.",
    "figure-6": "Figure 6: three thermistors (above), and the curve inside the dermis (below).",
}


def paper_figures(write: Callable[[str, bytes], None]) -> str:
    """Write the pictures, and return the Markdown that shows them."""
    from source_paper import paper, studydraw
    from source_paper.dermis_course import dermis_course
    from thermicon.circuit.solver.draw import plot_current

    cue = paper.controlled_cue()
    dermis = (studydraw.plot_thermistors, paper.thermistors()), (studydraw.plot_dermis_course, dermis_course())
    drawn = {
        "figure-3": studydraw.stacked_figure((plot_current, cue.skin), (studydraw.plot_controlled, cue.skin)),
        "figure-4": studydraw.stacked_figure((studydraw.plot_controlled, cue.display)),
        "figure-6": studydraw.stacked_figure(*dermis),
    }
    lines = []
    for name, figure in drawn.items():
        write(f"explain/paper/{name}.png", png(figure))
        lines += [f"![{CAPTIONS[name]}](paper/{name}.png)", "", f"*{CAPTIONS[name]}*", ""]
    return "\n".join(lines)


def circuit_diagram(write: Callable[[str, bytes], None]) -> str:
    """Write the circuit of module, contact and skin as SVG, and return the Markdown that shows it."""
    import schemdraw
    from schemdraw import elements as e

    schemdraw.use("svg")
    with schemdraw.Drawing(show=False) as drawing:
        drawing.config(unit=3.6, fontsize=12)
        e.Ground()
        e.SourceV().up().label("40 °C", loc="bottom")
        e.Resistor().right().label("heat sink", loc="bottom")
        for node, element, what, to_the_right in (
            ("hot plate", e.SourceI, "αI·T + I²R/2", "module Θ"),
            ("display", e.SourceI, "αI·T − I²R/2", "contact"),
            ("skin surface", e.Capacitor, "C₁", "epidermis"),
            ("receptors", e.Capacitor, "Cₙ", "dermis"),
        ):
            dot = e.Dot().label(node, loc="top")
            below = element().down().label(what, loc="bottom")
            if node == "hot plate":
                below.reverse()  # heat flows into this node and out of the next
            e.Ground()
            e.Resistor().right().at(dot.center).label(to_the_right, loc="bottom")
        e.Dot().label("deep tissue", loc="top")
        e.SourceV().down().reverse().label("blood", loc="bottom")
        e.Ground()
    write("explain/paper/circuit.svg", drawing.get_imagedata("svg"))
    return (
        "![The circuit: heat sink, module with Peltier sources, contact, skin layers, blood](paper/circuit.svg)\n\n"
        "*Voltages stand for temperatures, currents for heat flow. The drive current I takes αI·T, with T the\n"
        "temperature of the node, out of the display and gives it to the hot plate; half of its Joule heat I²R goes\n"
        "to either.*"
    )
