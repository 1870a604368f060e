"""The number of modules that five journeys of a user enter.

A module is entered where one of its functions runs; what only defines names, as on import, is not counted.
"""

import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
BUDGET = tomllib.loads((ROOT / "tests" / "budget.toml").read_text(encoding="utf-8"))["journeys"]
COMMANDS = {
    "check": "check six-icons",
    "simulate": "simulate six-icons --icon cooling-step -o trace.csv",
    "rank": "rank six-icons --people 2",
    "export": "export six-icons --icon cooling-step --to csv -o drives",
}
COMMAND = "begin(); from thermicon.notebooks.cli.main import main; sys.argv = 'thermicon {words}'.split(); main()"
DRAG = """
from thermicon.circuit import Rig
from thermicon.notebooks.workbench.design_model import DesignModel
design = DesignModel("cue 1; icon dip { cool by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }", Rig.load("thenar"))
begin()
for seq in range(1, 4):
    design.receive({"type": "drag", "handle": 0, "t": 2.0, "y": 28.0 - 0.1 * seq, "end": seq == 3, "seq": seq})
assert "cool by 4.3" in design.text, design.text
"""
SCRIPTS = {**{name: COMMAND.format(words=words) for name, words in COMMANDS.items()}, "drag": DRAG}
PROFILED = """
import os, sys
entered = set()
def note(frame, event, arg):
    code = frame.f_code
    if event == "call" and code.co_flags & 1 and not code.co_name.startswith("<"):  # a function, no body of a class
        entered.add(code.co_filename)
def begin():
    sys.settrace(note)  # of calls alone, as nothing is given back
root, script = sys.argv[1:]
try:
    exec(script)
except SystemExit as end:
    assert not end.code
finally:
    sys.settrace(None)
folders = tuple(os.path.join(root, package, "") for package in ("base", "icons", "circuit", "perception", "notebooks"))
print("entered:", *sorted(name for name in entered if name.startswith(folders)), sep="\\n")
"""


def modules_entered(name: str) -> list[str]:
    """Files of the modules that a journey enters."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-c", PROFILED, str(ROOT), SCRIPTS[name]]
        run = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout.partition("entered:\n")[2].split()


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_journey_enters_hardly_more_modules_than_its_budget(name: str) -> None:
    """What it is above is a matter of the release, up to one in ten."""
    entered = modules_entered(name)
    assert len(entered) <= 1.1 * BUDGET[name], "\n".join(entered)
    assert not any("/circuit/live/" in path for path in entered)
