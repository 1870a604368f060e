"""The film on the first page."""

from __future__ import annotations

from collections.abc import Callable

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library
from thermicon.perception import perceive

ICON, RIG, TAIL_S = "cold-to-warm", "thenar", 2.0


def moving_percept(write: Callable[[str, str | bytes], None]) -> str:
    """Write the film of one icon, moving and still, and return the Markdown that shows it."""
    trace = simulate(load_library("six-icons")[ICON], Rig.load(RIG), tail_s=TAIL_S)
    film = perceive(trace).film(trace)
    write("moves.svg", film.svg())
    write("still.svg", film.svg(still=True))
    what = f"{film.title}, temperatures against time, and what is felt of cold and warmth"
    images = (f"```{{image}} {name}.svg\n:alt: {what}\n:class: {name}\n```\n" for name in ("moves", "still"))
    return "\n".join(images)  # site.css shows one of them: not every browser asks its user's wish inside an image
