"""Legibility of every command's figures on the screen and in print."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from tests.legible import troubles
from tests.notebooks.conftest import Cli
from thermicon.circuit import Rig
from thermicon.circuit.fitting.synthetic_log import synthetic_log, write_log

FEW = "--people 2 --intervals 0"
COMMANDS = [
    f"rank wave-confusions {FEW}",
    f"rank many.cue {FEW}",
    "rank two.cue --doubt --people 2 --intervals 64",
    "improve six-icons --up-to 6 --people 2 --intervals 2",
    f"improve six-icons --choose 5 {FEW}",
    f"improve many.cue --choose 3 --evaluations 10 {FEW}",
    "simulate six-icons --icon double-dip",
    "simulate six-icons --icon double-dip --set contact.area_cm2=2 --set contact.resistance_m2K_per_W=1e-3",
    "simulate two.cue --random 8",
    "simulate six-icons --random 8",
    "compare thenar shani2021",
    "compare thenar shani2021 --file six-icons",
    "compare the-first-run-of-monday-morning.csv the-second-run-of-monday-morning.csv",
    "fit log.csv --free contact.resistance_m2K_per_W --set driver.update_Hz=20",
    "pilot two.cue wave-shapes --answers answers.csv --draws 20",
    "sweep wave-confusions --vary contact.area_cm2=2,4,8,16,32",
    "sweep six-icons --vary site=fingertip,forearm,hand-dorsum,thenar --measure correct,onset --people 2 --intervals 2",
    "sweep six-icons --vary people.age_years=20:80:4 --people 2 --intervals 2 --measure "
    "correct,named_95,detected,onset,d_prime,bits",
]
MANY = """cue 1
set dips { site thenar; control display; baseline 32 °C }
icon dip(depth in 1..5 step 0.2 °C) { cool by depth at 3 °C/s; return at 3 °C/s }
"""


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_words_of_a_figure_lie_inside_it_and_apart(
    cli: Cli, command: str, two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A figure that is too narrow for a set is the only one with words that touch, and the command says so."""
    monkeypatch.chdir(two.parent)
    Path("many.cue").write_text(MANY, encoding="utf-8")
    Path("answers.csv").write_text(
        "participant,trial,presented,responded\n" + "P,1,cool-step,cool-step\nP,2,warm-step,warm-step\n"
    )
    if "log.csv" in command:
        write_log(
            synthetic_log(Rig.load("thenar").with_(**{"driver.update_Hz": 20}), seed=1, rate_Hz=20.0), Path("log.csv")
        )
    for name in command.split() if ".csv" in command and "compare" in command else ():
        Path(name).write_text("time_s,display_C\n0,32\n1,30\n2,31\n")
    kept: dict[Figure, float] = {}
    monkeypatch.setattr(Figure, "savefig", lambda figure, _, *, dpi, **more: kept.setdefault(figure, dpi))
    for paper in ("", "--paper 85mm", "--paper 180mm"):
        said = cli.good(*command.split(), "--figure", "a.png", *paper.split())
        figure, dpi = kept.popitem()
        figure.set_dpi(dpi)
        found = troubles(figure)
        assert bool(found) == ("can be read in a figure from --paper" in said.stderr), (paper, found)
        assert bool(found) == ("85mm" in paper and command.startswith("rank many")), (paper, found)
