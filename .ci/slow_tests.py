"""Print the folders whose slow tests a change calls for, one per line.

``.ci/slow_tests.py`` compares with the commit before the change; ``.ci/slow_tests.py FILE ...`` takes a list of changed
files instead. A changed room calls for the tests of that room, and `ALWAYS` is run after any change.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("icons", "circuit", "perception", "notebooks")
ALWAYS = ("tests/perception/ranking", "tests/circuit/delivery")
"""A cluster that loses a worker, and exported drives: what costs most when it breaks."""
SHOWN_IN_A_BROWSER = ("notebooks/workbench", "notebooks/report", "tests/browser")
SHOWN_IN_PAGES = ("docs/", "README.md", "notebooks/cli", "notebooks/report")
MOST_ROOMS = 6
"""A change of more rooms than this, such as a renaming, gets `ALWAYS` alone: all slow tests together take an hour."""


def folders_of(changed: str) -> Iterator[str]:
    """Yield the folders of tests that prove one changed file."""
    path = PurePosixPath(changed)
    parts = path.parts[1:] if path.parts[0] == "tests" else path.parts
    if changed.startswith(SHOWN_IN_A_BROWSER):
        yield "tests/browser"
    if changed.startswith("docs/"):
        yield "tests/docs"
    if changed.startswith(SHOWN_IN_PAGES):
        yield "tests/test_readme.py"
    if parts[0] in PACKAGES and len(parts) > 1:
        room = PurePosixPath("tests", *parts[:-1])
        while not (ROOT / room).is_dir():  # data folders have no tests of that name; those of the package prove them
            room = room.parent
        yield str(room)


def selection(changed: Iterable[str]) -> list[str]:
    """Return the folders of tests that a change calls for, without folders inside another one of them."""
    rooms = {folder for name in changed for folder in folders_of(name)}
    if len(rooms) > MOST_ROOMS:
        rooms = set()
    rooms |= {folder for folder in ALWAYS if (ROOT / folder).is_dir()}
    return sorted(room for room in rooms if not any(str(above) in rooms for above in PurePosixPath(room).parents))


def git(*arguments: str) -> str:
    """Return what a git command prints; nothing where it fails, as in a copy without history."""
    run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    return run.stdout.strip() if run.returncode == 0 else ""


def base() -> str:
    """Return the commit before the change: named by THERMICON_BASE, or where the branch began, last tag, or parent."""
    head = git("rev-parse", "HEAD")
    candidates = (
        git("rev-parse", "--verify", f"{os.environ.get('THERMICON_BASE') or '-'}^{{commit}}"),
        git("merge-base", "HEAD", "origin/HEAD"),
        git("rev-list", "-n1", git("describe", "--tags", "--abbrev=0", "HEAD~1") or "-"),
        git("rev-parse", "--verify", "HEAD~1"),
    )
    return next((commit for commit in candidates if commit and commit != head), "")


if __name__ == "__main__":
    since = base()
    files = sys.argv[1:] or (git("diff", "--name-only", since, "HEAD").splitlines() if since else [])
    sys.stdout.write("".join(f"{folder}\n" for folder in selection(files)))
