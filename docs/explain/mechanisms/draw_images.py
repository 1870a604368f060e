"""The pictures of README.md and docs/, drawn by ``python tests/test_readme.py``."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library, read_cue
from thermicon.notebooks import overview
from thermicon.notebooks.figures.set_figures import set_figure
from thermicon.perception import Observer, perceive, rank
from thermicon.perception.evidence.results import load_ablation, load_constants, load_predictions
from thermicon.perception.identification.episodes import remembered

from .draw_effects import plot_effect, plot_onset_stages
from .draw_episodes import episodes_figure
from .draw_evidence import plot_ablation, plot_left_out, plot_narrowing, plot_published_predicted
from .effects import EFFECTS
from .onset_stages import onset_stages


def draw_images(folder: Path) -> None:
    """Draw the pictures that README.md and docs/ show."""
    rig = Rig.load("thenar")
    set_figure(rank(read_cue("six-icons"), rig)).savefig(folder / "six-icons.png", dpi=100)
    trace = simulate(read_cue("cooling-step-skin")["cooling-step"], rig, tail_s=10.0)
    overview(trace, perceive(trace)).savefig(folder / "cooling-step.png", dpi=90)
    draw_mechanisms(folder)


def draw_mechanisms(folder: Path) -> None:
    """Draw what each mechanism does, and what the inference found."""
    rig, icons = Rig.load("thenar"), load_library("six-icons")
    drawn = {f"mechanism-{name}": plot_effect(effect()) for name, effect in EFFECTS.items()} | {
        "mechanism-delays": plot_onset_stages(onset_stages(icons, rig)),
        "ablation": plot_ablation(load_ablation()),
        "left-out": plot_left_out(load_predictions()),
        "published-predicted": plot_published_predicted(load_predictions()),
        "narrowing": plot_narrowing(load_constants()),
    }
    names = ("linear-cooling", "double-dip", "cold-to-warm")
    percepts = [perceive(simulate(icons[name], rig, tail_s=6.0)) for name in names]
    episodes = remembered(percepts)
    icons_remembered = [(percept, episodes.listed(0, k)) for k, percept in enumerate(percepts)]
    episodes_figure(icons_remembered, Observer.load().episode_bar).savefig(folder / "mechanism-episodes.png", dpi=90)
    for name, axes in drawn.items():
        figure = axes.get_figure(root=True)
        assert isinstance(figure, Figure)
        figure.savefig(folder / f"{name}.png", dpi=90)
