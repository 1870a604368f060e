"""Drafts that killed commands left behind are swept by the next; nothing else is."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from thermicon.notebooks.files.drafts import draft_of, sweep

posix = pytest.mark.skipif(os.name != "posix", reason="needs signals")


@posix
def test_the_next_command_sweeps_the_draft_of_one_that_was_killed(tmp_path: Path) -> None:
    script = (
        "import os, signal, sys\nfrom pathlib import Path\n"
        "from thermicon.notebooks.files.outputs import complete_or_absent\n"
        "with complete_or_absent(Path(sys.argv[1])) as draft:\n"
        "    draft.write_text('half')\n    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    run = subprocess.run([sys.executable, "-c", script, tmp_path / "trace.csv"], check=False)
    assert run.returncode == -9
    (left,) = tmp_path.iterdir()
    mine = tmp_path / left.name.replace("thermicon-part", "part")
    mine.write_text("not a draft of ours")
    again = "from pathlib import Path; import sys\nfrom thermicon.notebooks.files.outputs import complete_or_absent\n"
    again += "with complete_or_absent(Path(sys.argv[1])) as draft: draft.write_text('x')\n"
    subprocess.run([sys.executable, "-c", again, tmp_path / "other.json"], check=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([mine.name, "other.json"])


@posix
def test_a_draft_that_is_being_written_is_not_swept_and_an_old_one_of_a_reused_number_is(tmp_path: Path) -> None:
    with draft_of(tmp_path / "a.csv") as draft:
        sweep(tmp_path)
        assert draft.exists()
    reused = tmp_path / f".b.{os.getppid()}-0.thermicon-part.csv"
    reused.write_text("half")
    sweep(tmp_path)
    assert reused.exists()
    long_ago = time.time() - 2 * 86_400
    os.utime(reused, (long_ago, long_ago))
    sweep(tmp_path)
    assert not reused.exists()
