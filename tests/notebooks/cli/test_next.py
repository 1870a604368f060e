"""The next command on each screen, followed to an export or a reason."""

import re
import shlex
from pathlib import Path

import pytest

from ..conftest import Cli

HEAD = "cue 1\nset s {{\n  site {site}\n  control {control}\n  baseline 32 °C\n}}\n"
FEW = ("--people", "8", "--intervals", "8")
GOAL = ("--goal", "90 % named for 90 % of people")


def dip(name: str, by: float, at: float = 3, hold: float = 3) -> str:
    verb = "cool" if by > 0 else "warm"
    return f"icon {name} {{ {verb} by {abs(by)} °C at {at} °C/s; hold for {hold} s; return at {at} °C/s }}\n"


SETS = {
    "one": dip("a", 5),
    "apart": dip("a", 5) + dip("b", -4, 2),
    "close": dip("a", 4) + dip("b", 4.6) + dip("c", -4, 2),
    "two close": dip("a", 4) + dip("b", 4.2),
    "same": dip("a", 4) + dip("b", 4.01) + dip("c", 4.02),
    "unfelt": dip("a", 0.05, 0.1) + dip("b", 5) + dip("c", -4, 2),
    "faint": dip("a", 0.4, 0.2) + dip("b", -0.4, 0.2),
    "one too fast": dip("a", 6, 60),
    "too fast": dip("a", 6, 60) + dip("b", -4, 2),
    "hot": dip("a", -14, 3, 20) + dip("b", 5),
    "many": "".join(dip(f"d{k}", 1 + k, 2) for k in range(5)) + "".join(dip(f"r{k}", -1 - k, 2) for k in range(3)),
}


@pytest.mark.slow
@pytest.mark.parametrize("goal", [(), GOAL], ids=["no goal", "goal"])
@pytest.mark.parametrize("name", SETS)
def test_every_next_ends_at_an_export_or_a_reason(
    cli: Cli, name: str, goal: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    site = "fingertip" if name == "many" else "thenar"
    Path("set.cue").write_text(HEAD.format(site=site, control="display") + SETS[name], encoding="utf-8")
    words, seen = ["check", "set.cue"], list[list[str]]()
    while words:
        words += [*FEW, *goal] if words[0] == "rank" and not {*FEW} <= {*words} else []
        assert words not in seen and len(seen) < 6, seen
        seen.append(words)
        quick = ["--people", "8"] * (words[0] == "sweep")
        said = cli(*words, *quick)
        if said.exit_code:
            assert words[0] == "export" and "refused" in said.stderr, (words, said.stderr)
            return
        after = re.search(r"Next: ((?:.+\n)+?)(?:\n|$)", f"{said.stdout}\n{said.stderr}\n")
        if after is None:
            assert words[0] == "export", (words, said.stdout)
            return
        text = " ".join(after[1].split())
        words = shlex.split(text)[1:] if text.startswith("thermicon ") else []
    assert len(text) > 20  # a reason in words
