"""The cell magic in a real shell or in a whole notebook, with every message."""

import subprocess
import sys
from collections.abc import Iterator

import pytest
from IPython.core.interactiveshell import InteractiveShell

from tests.builders import missing
from tests.notebooks.workbench.openbench import SAID
from thermicon.icons import parse

GOOD = "icon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s }\n"


@pytest.fixture
def shell() -> Iterator[InteractiveShell]:
    made = InteractiveShell()
    made.extension_manager.load_extension("thermicon.notebooks")
    made.run_cell("cues = 'as it was'")
    yield made
    made.extension_manager.unload_extension("thermicon.notebooks")


@pytest.mark.parametrize("start", ["", "cue 1\n", "\n# a comment\ncue 1\n", "  cue 1; "])
def test_a_cell_becomes_a_set(shell: InteractiveShell, start: str) -> None:
    result = shell.run_cell("%%cue\n" + start + GOOD)
    assert result.result is shell.user_ns["cues"]
    assert result.result == parse("cue 1\n" + GOOD)
    assert shell.run_cell("%%cue alerts\n" + GOOD).result is shell.user_ns["alerts"]


@pytest.mark.parametrize("cell", SAID["magic"])
def test_mistakes_are_told_at_the_lines_of_the_cell_and_change_nothing(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], cell: str
) -> None:
    capsys.readouterr()
    assert not shell.run_cell(cell).success
    said = "".join(capsys.readouterr())
    assert "Traceback" not in said
    assert missing(SAID["magic"][cell], said) == []
    assert shell.user_ns["cues"] == "as it was"


def test_it_says_what_it_does_and_can_be_taken_away(shell: InteractiveShell) -> None:
    assert "%%cue [NAME]" in shell.magics_manager.magics["cell"]["cue"].__doc__
    shell.extension_manager.unload_extension("thermicon.notebooks")
    assert "cue" not in shell.magics_manager.magics["cell"]


def test_nothing_imports_ipython_or_widgets_before_they_are_used() -> None:
    code = (
        "import sys, thermicon.icons.pictures.draw, thermicon.notebooks\n"
        "print([m for m in ('IPython', 'ipywidgets', 'anywidget') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
