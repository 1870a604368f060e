"""Rankings that are kept: read again for the same question, and only where nobody else could have written them."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.notebooks.conftest import Said
from thermicon.notebooks.files import kept_rankings
from thermicon.notebooks.files.kept_rankings import recall, remember
from thermicon.perception import Ranking
from thermicon.perception.ranking import rank as ranking_module

Cli = Callable[..., Said]
FEW = ("--people", "4", "--parameters", "2")


@pytest.fixture(autouse=True)
def cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A cache of this test's own, beside the compiled code of the user's."""
    monkeypatch.setattr(kept_rankings, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.delenv("THERMICON_RECOMPUTE")
    return tmp_path / "cache" / "rankings"


@pytest.fixture(scope="module")
def small() -> Ranking:
    """A ranking of one icon."""
    from thermicon.circuit import Rig
    from thermicon.icons import load_library

    return ranking_module.rank(load_library("cooling-step-skin"), Rig.load("thenar"), people=2, parameters=0)


def counting(monkeypatch: pytest.MonkeyPatch, answer: Ranking | None) -> list[int]:
    """Numbers of people of the rankings that are computed from now on, or asked for and given one answer."""
    import thermicon.perception as door

    people: list[int] = []
    compute = ranking_module.rank

    def counted(*arguments: object, **options: object) -> Ranking:
        people.append(options["people"])  # type: ignore[arg-type]
        return compute(*arguments, **options) if answer is None else answer  # type: ignore[arg-type]

    monkeypatch.setattr(door, "rank", counted, raising=False)
    return people


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """As `counting`, truly computed."""
    return counting(monkeypatch, None)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, small: Ranking) -> list[int]:
    """As `counting`, for tests in which only the number of rankings counts."""
    return counting(monkeypatch, small)


def test_the_same_question_is_computed_once_and_answered_alike(
    cli: Cli, two: Path, tmp_path: Path, computed: list[int]
) -> None:
    first = cli("rank", two, *FEW, "--json", tmp_path / "a.json")
    again = cli("rank", two, *FEW, "--json", tmp_path / "b.json", "--workers", "1")
    assert computed == [4]
    assert again.stdout == first.stdout
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


@pytest.mark.parametrize(
    "change",
    [
        ("--people", "5"),
        ("--seed", "1"),
        ("--set", "contact.area_cm2=4"),
        ("--rig", "fingertip"),
        ("--norm", "rms"),
        ("--trials", "24"),
        ("--gap", "1"),
        ("--recompute",),
    ],
    ids=" ".join,
)
def test_another_question_is_computed(cli: Cli, two: Path, asked: list[int], change: tuple[str, ...]) -> None:
    cli("rank", two, *FEW)
    cli("rank", two, *FEW, *change)
    assert len(asked) == 2


def test_a_changed_icon_is_computed(cli: Cli, two: Path, asked: list[int]) -> None:
    cli("rank", two, *FEW)
    two.write_text(two.read_text(encoding="utf-8").replace("warm by 4 °C", "warm by 4.5 °C"), encoding="utf-8")
    cli("rank", two, *FEW)
    assert len(asked) == 2


def test_finished_parts_are_kept_where_they_were_asked_for(
    cli: Cli, two: Path, tmp_path: Path, computed: list[int]
) -> None:
    cli("rank", two, *FEW)
    cli("rank", two, *FEW, "--keep", tmp_path / "parts")
    assert len(computed) == 2
    assert any((tmp_path / "parts").rglob("*.npz"))


@pytest.mark.parametrize("damage", [b"", b"x" * 100, None], ids=["empty", "other", "one byte"])
def test_a_damaged_file_is_computed_anew(
    cli: Cli, two: Path, cache: Path, asked: list[int], damage: bytes | None
) -> None:
    first = cli("rank", two, *FEW)
    (kept,) = cache.iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]) if damage is None else damage)
    assert cli("rank", two, *FEW).stdout == first.stdout
    assert len(asked) == 2
    assert kept.read_bytes() == whole


@pytest.mark.skipif(sys.platform == "win32", reason="access lists, not modes, keep folders private there")
def test_what_others_can_write_is_not_read(cli: Cli, two: Path, cache: Path, asked: list[int]) -> None:
    cli("rank", two, *FEW)
    (kept,) = cache.iterdir()
    kept.chmod(0o666)
    cli("rank", two, *FEW)
    cache.chmod(0o777)
    cli("rank", two, *FEW)
    assert len(asked) == 3


def test_only_the_latest_are_kept(cache: Path, monkeypatch: pytest.MonkeyPatch, small: Ranking) -> None:
    monkeypatch.setattr(kept_rankings, "MOST_KEPT", 2)
    for number, name in enumerate(("a", "b", "c")):
        remember(name, small)
        for path in cache.iterdir():
            os.utime(path, (number, number)) if path.stat().st_mtime > 3 else None
    assert recall("a") is None
    assert recall("b") is not None
    assert recall("c") is not None
