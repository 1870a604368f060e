"""A sealed prediction and refusals of foreign answers."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.builders import messages, steps
from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception import rank
from thermicon.perception.identification.skin_alone import skin_alone
from thermicon.perception.pilot.sealed import SealedError, opened, read_sealed
from thermicon.perception.pilot.trials import Trials

NEAR = steps(deep=-4.0, less=-3.4, warm=3.0)
EACH = 400


@pytest.fixture(scope="module")
def text(rig: Rig) -> str:
    return rank(NEAR, rig, people=8, parameters=0).to_json()


@pytest.fixture
def path(text: str, tmp_path: Path) -> Path:
    found = tmp_path / "sealed.json"
    found.write_text(text, encoding="utf-8")
    return found


def test_it_reaches_its_best_on_its_own_answers_and_loses_to_guessing_on_guesses(path: Path, rig: Rig) -> None:
    sealed, rng = read_sealed(path, NEAR, rig), np.random.default_rng(2)

    def scored(chances: Any) -> Any:
        counts = rng.multinomial(EACH, chances).astype(float)
        return opened(sealed, Trials(sealed.labels, ("all",), counts[None]), NEAR, rig)

    true, wrong = scored(sealed.confusion), scored(np.full((3, 3), 1 / 3))
    own, guessing, _, best = (bits for bits, _ in true.scores.values())
    assert own == pytest.approx(best, abs=3.0 * true.chance_bits)
    assert guessing == pytest.approx(-np.log2(3)) and guessing < own
    path.write_text(path.read_text(encoding="utf-8").replace("0.9", "0.90", 1), encoding="utf-8")
    assert read_sealed(path, NEAR, rig).sha256 != sealed.sha256
    assert wrong.scores["prediction"][0] < min(guessing, best - 3.0 * wrong.chance_bits)
    assert (true.trials, true.scores["prediction"][1]) == (3 * EACH, pytest.approx(sealed.confusion.trace() / 3))


def test_a_silence_counts_for_felt_and_named_where_the_sealed_file_has_it(path: Path, rig: Rig) -> None:
    sealed = read_sealed(path, NEAR, rig)
    assert sealed.felt_and_named is not None and (sealed.felt_and_named <= sealed.confusion.diagonal() + 1e-12).all()
    counts, silent = 8.0 * np.eye(3)[None], np.array([[0.0, 0.0, 8.0]])
    counts[0, 2, 2] = 0.0
    trials = Trials(sealed.labels, ("all",), counts, unanswered=silent)
    found = opened(sealed, trials, NEAR, rig)
    assert found.felt_and_named is not None and found.observed_correct == 1.0
    seen, said, p = found.felt_and_named
    assert (seen, said) == (pytest.approx(2 / 3), pytest.approx(sealed.felt_and_named.mean()))
    assert p < 0.01, "an icon that is never felt is seen, whatever the others make of the mean"
    counts[0] = np.round(8.0 * np.diag(sealed.felt_and_named))
    fine = opened(sealed, replace(trials, counts=counts, unanswered=(8.0 - counts[0].sum(axis=1))[None]), NEAR, rig)
    assert fine.felt_and_named is not None and fine.felt_and_named[2] > 0.2
    counts = 8.0 * np.eye(3)[None]
    assert opened(sealed, Trials(sealed.labels, ("all",), counts), NEAR, rig).felt_and_named is None
    held = json.loads(path.read_text(encoding="utf-8"))
    for icon in held["icons"]:
        del icon["felt_and_named"]
    path.write_text(json.dumps(held), encoding="utf-8")
    before = opened(read_sealed(path, NEAR, rig), trials, NEAR, rig)
    assert before.felt_and_named is None and before.scores == found.scores


def test_skin_alone_confuses_what_is_alike_at_the_skin(rig: Rig) -> None:
    named = skin_alone(list(NEAR), rig)
    assert named.sum(axis=1) == pytest.approx(1.0)
    assert named[0, 1] > 5.0 * named[0, 2] > 0.0


CHANGES: dict[str, Callable[[dict[str, Any]], object]] = {
    "version": lambda held: held.update(thermicon="99.1"),
    "digits": lambda held: held.update(thermicon="1" * 4301),
    "large": lambda held: held["confusion"]["probability"][1].__setitem__(0, 10**400),
    "earlier": lambda held: held.pop("sha256"),
    "names": lambda held: held["confusion"]["labels"].reverse(),
    "rows": lambda held: held["confusion"]["probability"][0].reverse() or held["confusion"]["probability"].pop(),
    "alert": lambda held: held["icons"][1].update(felt_and_named=1.2),
    "more": lambda held: held["confusion"]["probability"][1].__setitem__(0, 0.9),
}


@pytest.mark.parametrize("what", [*CHANGES, "icons", "rig", "text", "list", "folder"])
def test_what_does_not_belong_to_it_is_refused(what: str, text: str, path: Path, rig: Rig) -> None:
    icons: IconSet = steps(deep=-4.0, less=-3.5, warm=3.0) if what == "icons" else NEAR
    held = json.loads(text)
    CHANGES.get(what, id)(held)
    path.write_text({"text": text[:900], "list": "[]"}.get(what, json.dumps(held)), encoding="utf-8")
    other = rig.with_(**{"contact.area_cm2": 4.0}) if what == "rig" else rig
    with pytest.raises(SealedError, match=messages(__file__)["sealed"][what]):
        read_sealed(path.parent if what == "folder" else path, icons, other)
