"""A cue file for the tests of projects."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.notebooks.workbench.openbench import TEXT


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cue file in a folder of its own, which is where the workbench runs, as in a kernel."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("thermicon.notebooks.workbench.workbench.has_kernel", lambda: True)
    file = tmp_path / "alerts.cue"
    file.write_text(TEXT, encoding="utf-8")
    yield file
