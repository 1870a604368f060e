import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, load_library


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar")


@pytest.fixture(scope="module")
def six() -> IconSet:
    return load_library("six-icons")
