"""The cell magic: in a real shell, in a notebook that is run from end to end, and every message it may give."""

import subprocess
import sys
from collections.abc import Iterator
from importlib import resources
from pathlib import Path

import nbformat
import pytest
from IPython.core.interactiveshell import InteractiveShell
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

from thermicon.icons import Icon, IconSet, parse

GOOD = "icon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s }\n"
BAD = "\nicon dip { cool by 6 at 3 °C/s }\nicon dap { hold for 4 }\n"


@pytest.fixture
def shell() -> Iterator[InteractiveShell]:
    made = InteractiveShell()
    made.extension_manager.load_extension("thermicon.notebooks")
    yield made
    made.extension_manager.unload_extension("thermicon.notebooks")


def failed(shell: InteractiveShell, cell: str, capsys: pytest.CaptureFixture[str]) -> str:
    """Run a cell that fails, and return everything that it printed."""
    capsys.readouterr()
    result = shell.run_cell(cell)
    assert not result.success
    said = capsys.readouterr()
    assert "Traceback" not in said.out + said.err
    return (said.out + said.err).strip()


def test_a_cell_becomes_a_set(shell: InteractiveShell) -> None:
    result = shell.run_cell("%%cue\n" + GOOD)
    assert result.result is shell.user_ns["cues"]
    assert result.result["dip"].corners().duration_s == 4
    assert result.result == parse("cue 1\n" + GOOD)
    assert shell.run_cell("%%cue alerts\n" + GOOD).result is shell.user_ns["alerts"]


@pytest.mark.parametrize("start", ["cue 1\n", "\n# a comment\ncue 1\n", "  cue 1; "])
def test_the_version_line_may_be_there(shell: InteractiveShell, start: str) -> None:
    assert shell.run_cell("%%cue\n" + start + GOOD).result == parse("cue 1\n" + GOOD)


def test_another_version_is_not_read_as_this_one(shell: InteractiveShell, capsys: pytest.CaptureFixture[str]) -> None:
    assert "cell:2:5  E010 unknown version" in failed(shell, "%%cue\ncue 2\n" + GOOD, capsys)


def test_mistakes_are_told_at_the_lines_of_the_cell(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str]
) -> None:
    shell.run_cell("cues = 'as it was'")
    said = failed(shell, "%%cue" + BAD, capsys)
    assert said.startswith("cell:2:20  E102 missing unit\n  2 | icon dip { cool by 6 at 3 °C/s }\n")
    assert "cell:3:21  E102 missing unit" in said
    assert said.endswith("did you mean:  icon dap { hold for 4 s }")
    assert shell.user_ns["cues"] == "as it was"


def test_mistakes_read_as_well_outside_of_the_magic(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str]
) -> None:
    said = failed(shell, "from thermicon.icons import parse\nparse('cue 1; icon a { hold for 4 }')", capsys)
    assert said.startswith("<text>:1:26  E102 missing unit")
    said = failed(
        shell,
        "from thermicon.icons import *\nIcon('a', (warm(by=3, over=1), rest(1)))",
        capsys,
    )
    assert said.startswith("<icon a>:1:1  E205 rest away from baseline")


def test_empty_cells_are_told(shell: InteractiveShell, capsys: pytest.CaptureFixture[str]) -> None:
    assert "E008 no icons" in failed(shell, "%%cue\n\n", capsys)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("two-icons", "%%cue: 'two-icons' is not a valid variable name; try two_icons\nusage: %%cue [NAME] [--rig"),
        ("class", "%%cue: 'class' is not a valid variable name\nusage"),
        ("a b", "%%cue: unrecognized arguments: b\nusage"),
        ("--rigs x", "%%cue: unrecognized arguments: --rigs"),
        ("--rig", "%%cue: argument --rig: expected one argument\nusage"),
        ('"a', "%%cue: No closing quotation\nusage"),
        ("--rig nowhere", "%%cue: "),
    ],
)
def test_a_line_that_cannot_be_followed(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], line: str, said: str
) -> None:
    assert failed(shell, f"%%cue {line}\n{GOOD}", capsys).startswith(said)


def test_an_unknown_rig_is_told_with_those_there_are(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "thenar" in failed(shell, f"%%cue --rig thener\n{GOOD}", capsys)
    assert "cues" not in shell.user_ns


def test_a_rig_may_be_a_file_with_blanks_in_its_name(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "my rig.toml"
    path.write_text(resources.files("thermicon.circuit").joinpath("rigs/thenar.toml").read_text(encoding="utf-8"))
    assert shell.run_cell(f'%%cue dips --rig "{path}"\n{GOOD}').success
    assert "can hold every level of dips" in capsys.readouterr().out


def test_a_rig_tells_what_it_cannot_do(shell: InteractiveShell, capsys: pytest.CaptureFixture[str]) -> None:
    shell.run_cell("%%cue --rig thenar\n" + GOOD)
    assert "thenar can hold every level of cues (static check)" in capsys.readouterr().out
    result = shell.run_cell(
        "%%cue hot --rig thenar\nset { control current }\nicon hot { to 5 A at 1 A/s; return over 1 s }"
    )
    said = capsys.readouterr().out
    assert result.success
    assert isinstance(shell.user_ns["hot"], IconSet)
    assert said.startswith("cell: icon hot: 5 A is outside the driver's")


def test_the_line_magic_shows_again(shell: InteractiveShell, capsys: pytest.CaptureFixture[str]) -> None:
    shell.run_cell("%%cue\n" + GOOD)
    assert shell.run_cell("%cue cues").result is shell.user_ns["cues"]
    shell.run_cell("dip = cues['dip']")
    assert isinstance(shell.run_cell("%cue dip").result, Icon)
    assert len(shell.run_cell("%cue six-icons").result) == 6
    assert "E001 no such file" in failed(shell, "%cue seven-icons", capsys)
    assert failed(shell, "%cue", capsys).startswith(
        "%cue: name what to show: a variable, a shipped set or a file\nusage"
    )


def test_it_can_be_taken_away(shell: InteractiveShell) -> None:
    shell.extension_manager.unload_extension("thermicon.notebooks")
    assert "cue" not in shell.magics_manager.magics["cell"]
    assert "cue" not in shell.magics_manager.magics["line"]


def test_help_says_what_colours_to_expect(shell: InteractiveShell) -> None:
    told = shell.magics_manager.magics["cell"]["cue"].__doc__
    assert "%%cue [NAME] [--rig RIG]" in told
    assert "JupyterLab colours the cell as if it were Python" in told


def notebook(*cells: str) -> nbformat.NotebookNode:
    return nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])


@pytest.mark.slow
def test_a_notebook_shows_pictures_and_stops_at_mistakes() -> None:
    made = notebook(
        "%load_ext thermicon.notebooks",
        "%%cue alerts\n" + GOOD,
        "print(len(alerts))",
        "%%cue" + BAD,
        "print('never')",
    )
    client = NotebookClient(made, timeout=60, kernel_name="python3")
    with pytest.raises(CellExecutionError, match="E102 missing unit"):
        client.execute()
    _, shown, counted, wrong, never = made.cells
    (picture,) = shown.outputs
    assert picture.output_type == "execute_result"
    assert picture.data["text/html"].startswith("<svg")
    assert picture.data["text/plain"].startswith("<IconSet (unnamed): 1 icon, 4 s")
    assert counted.outputs[0].text == "1\n"
    (error,) = wrong.outputs
    assert (error.output_type, error.ename) == ("error", "CueErrors")
    assert error.traceback[:3] == [
        "cell:2:20  E102 missing unit",
        "  2 | icon dip { cool by 6 at 3 °C/s }",
        "    |                    ^ this number has no unit",
    ]
    assert "Traceback" not in "\n".join(error.traceback)
    assert never.outputs == []


def test_the_icons_do_not_import_ipython() -> None:
    code = "import sys, thermicon.icons.pictures.picture, thermicon.notebooks; print('IPython' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
