"""How soon ``thermicon check`` answers: a process of its own, the start of Python included."""

import subprocess
import sys
from typing import Any

import pytest

COMMAND = [sys.executable, "-m", "thermicon.notebooks.cli.main", "check", "six-icons"]


@pytest.mark.benchmark(group="check")
@pytest.mark.parametrize("what", ["python", "check"])
def test_check_answers_at_once(benchmark: Any, what: str) -> None:
    command = COMMAND if what == "check" else [sys.executable, "-c", "pass"]
    done = benchmark(subprocess.run, command, check=True, capture_output=True)
    assert done.returncode == 0
