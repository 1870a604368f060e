"""A guard on a bench for all tests of players."""

from collections.abc import Iterator

import pytest

from tests.circuit.play.guarded import World


@pytest.fixture
def world() -> Iterator[World]:
    made = World()
    yield made
    made.bench.goes_on.set()
    assert not made.bench.broken
