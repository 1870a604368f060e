import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, read_cue


@pytest.fixture(scope="module")
def icons() -> IconSet:
    return read_cue("six-icons")


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar")
