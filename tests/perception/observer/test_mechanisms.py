"""Mechanisms of the observer, and a new one from one module, one call in the chain and one prior."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import rank
from thermicon.perception.experiments.measure import Condition, measure
from thermicon.perception.observer.constants import names_of
from thermicon.perception.observer.observer import MECHANISMS, Observer
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.observer.priors import load_priors, priors_of

ROOT = Path(__file__).resolve().parents[3]
TOY = """
from dataclasses import dataclass

from ..constants import constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Toy(Mechanism):
    '''Everything is felt twice as strongly.'''

    equation = "sensitivity times toy"
    source = "nobody"
    louder: float = constant("toy gain", default=2.0)

    def loudness(self):
        return self.louder
"""
PRIOR = """
[[prior]]
name = "toy gain"
unit = "1"
scale = "log"
median = 2.0
low = 1.0
high = 4.0
mechanism = "toy"
source = "nobody"
"""
CHOICE = Condition("threshold", "forced_choice", "cold", 32.0, None, 1.0, 3.0)
ASKED = """
import json, sys
import thermicon.perception
own, builder = sys.argv[1:]
thermicon.perception.__path__.insert(0, own)
sys.path.insert(0, builder)
from evidence_tables import TABLES
from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import rank
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.experiments.measure import Condition, measure
choice = Condition("threshold", "forced_choice", "cold", 32.0, None, 1.0, 3.0)
ranking = rank(load_library("six-icons"), Rig.load("thenar"), people=4, parameters=0)
found = {"onsets": [icon.onset_s for icon in ranking.icons]}
found["threshold"] = measure(choice, Rig.load("forearm"), draws=2).value
found["priors"], found["page"] = Posterior().priors.names, TABLES["mechanisms"]()
print(json.dumps(found))
"""


def asked(own: Path) -> dict[str, Any]:
    words = [sys.executable, "-c", ASKED, str(own), str(ROOT / "docs" / "builder")]
    run = subprocess.run(words, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    found: dict[str, Any] = json.loads(run.stdout)
    return found


@pytest.mark.slow
def test_a_toy_mechanism_is_felt_measured_inferred_and_listed(tmp_path: Path) -> None:
    for folder in ("observer", "data"):
        shutil.copytree(ROOT / "perception" / folder, tmp_path / folder)
    (tmp_path / "observer" / "mechanisms" / "toy.py").write_text(TOY, encoding="utf-8")
    chain = tmp_path / "observer" / "chain.py"
    text = chain.read_text(encoding="utf-8").replace("class SensoryChain(\n", "class SensoryChain(\n    Toy,\n")
    text = text.replace("return self.of_area(", "return self.loudness() * self.of_area(")
    chain.write_text(text.replace("import Site\n", "import Site\nfrom .mechanisms.toy import Toy\n"), encoding="utf-8")
    with (tmp_path / "data" / "priors.toml").open("a", encoding="utf-8") as priors:
        priors.write(PRIOR)
    toy = asked(tmp_path)
    assert toy["threshold"] == pytest.approx(0.5 * measure(CHOICE, Rig.load("forearm"), draws=2).value, rel=0.1)
    usual = rank(load_library("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    assert (np.array(toy["onsets"]) < [icon.onset_s for icon in usual.icons]).all()
    assert set(toy["priors"]) - set(priors_of("temperature").names) == {"toy gain"}
    assert "Everything is felt twice as strongly. | sensitivity times toy | toy gain | nobody" in toy["page"]


def test_every_prior_is_a_constant_of_a_mechanism_and_every_mechanism_says_what_it_is() -> None:
    constants = names_of(Observer)
    assert {prior.name for prior in load_priors().each} - set(constants) == {"sensitivity between laboratories"}
    assert len(constants) == len(set(constants))
    for kind in MECHANISMS:
        assert kind.equation and kind.source and kind.__doc__, kind


TWO = (
    "cue 1; set s { site forearm; control display; baseline 32 °C }; "
    "icon a { cool by 4 °C at 2 °C/s; return at 2 °C/s }; icon b { warm by 4 °C at 2 °C/s; return at 2 °C/s }"
)


def test_every_mechanism_is_called_by_what_people_are_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ranking, an age and two measurements: a method that none of them calls would change no prediction."""
    parts = [
        (kind, name) for kind in MECHANISMS for name, part in vars(kind).items() if callable(part) and name[0] != "_"
    ]
    called = set()

    def counted(kind: type, name: str, part: Any) -> Any:
        def call(*args: Any, **given: Any) -> Any:
            called.add((kind, name))
            return part(*args, **given)

        return call

    for kind, name in parts:
        monkeypatch.setattr(kind, name, counted(kind, name, vars(kind)[name]))
    forearm = Rig.load("forearm")
    rank(parse(TWO), forearm, people=2, parameters=0)
    ObserverModel.load().aged(60.0)
    wrong = Condition("wrong_quality", "choice", "cold", 32.0, 4.0, 1.0, 3.0)
    for condition in (CHOICE, wrong):
        measure(condition, forearm, draws=2)
    uncalled = {f"{kind.__name__}.{name}" for kind, name in parts if (kind, name) not in called}
    assert uncalled == {"Transducer.multiple", "Transducer.difference_threshold"}, "which published differences ask"


def test_area_and_site_both_act_and_their_order_means_nothing() -> None:
    observer = Observer.load()
    both, area, site = (
        observer.sensitivity("warm", *where) for where in ((2e-4, "wrist"), (2e-4, None), (None, "wrist"))
    )
    assert both == pytest.approx(area * site) and 0.0 < both < min(area, site) < 1.0
