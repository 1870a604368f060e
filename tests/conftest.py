"""Shared by all tests: the door to programs that pip does not install."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable

import hypothesis
import pytest

# The same examples on every run: a red suite means a changed program. Slow tests may ask for more.
hypothesis.settings.register_profile("steady", derandomize=True, deadline=None)
hypothesis.settings.load_profile("steady")

DEBIAN_PACKAGE = {"cc": "gcc", "chromium": "chromium", "ngspice": "ngspice"}


def find_tool(name: str) -> str:
    """Path of an outside program; without it the test fails where tools are required and is skipped elsewhere."""
    path = shutil.which(name)
    if path is not None:
        return path
    message = f"{name} is not installed; on Debian or Ubuntu: apt-get install {DEBIAN_PACKAGE.get(name, name)}"
    if os.environ.get("THERMICON_REQUIRE_TOOLS") == "1":
        pytest.fail(message)
    pytest.skip(message)


@pytest.fixture(scope="session")
def tool() -> Callable[[str], str]:
    """``tool("ngspice")`` inside a test gives the path of the program."""
    return find_tool
