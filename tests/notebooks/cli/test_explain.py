"""``thermicon explain`` tells what an error means."""

from typing import Any


def test_a_code_is_explained_by_an_example(cli: Any) -> None:
    said = cli("explain", "e102")
    assert said.exit_code == 0
    assert said.stdout.startswith("E102 missing unit\n")
    assert "did you mean:" in said.stdout


def test_an_unknown_code_names_its_neighbours(cli: Any) -> None:
    said = cli("explain", "E99")
    assert said.exit_code == 2
    assert "there is no error E99; the nearest are" in said.stderr
