"""The tests whose slow part a change calls for.

``.ci/slow_tests.py`` compares with the commit before the change, and takes all files where that is not known;
``.ci/slow_tests.py FILE ...`` takes a list of changed files instead. A changed room calls for its tests, what archives
are made of for their build, what a page shows for that page. A change that calls for more than `MOST_MINUTES` gets as
many of them as fit, the quickest first.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("base", "icons", "circuit", "perception", "notebooks")
ALWAYS = ("tests/circuit/delivery", "tests/perception/kernels")
"""Exported drives, and a cluster that loses a worker: what costs most when it breaks."""
SHOWN_IN_A_BROWSER = ("notebooks/workbench", "notebooks/report", "notebooks/canvas_parts", "tests/browser")
SHOWN_IN_PAGES = ("README.md", "docs/", "notebooks/cli", "notebooks/report", "circuit/delivery", "circuit/safety")
ARCHIVED = ("thermicon/", "pyproject.toml", "MANIFEST.in", "LICENSE", *(f"{package}/" for package in PACKAGES),
            ".ci/", ".types/", "conda-recipe/", "Dockerfile", ".dockerignore")  # fmt: skip
MINUTES = {
    "tests/browser": 3.0,
    "tests/circuit/delivery": 10.0,
    "tests/circuit/fitting": 8.0,
    "tests/circuit/live": 6.0,
    "tests/docs": 2.5,
    "tests/icons/language": 1.0,
    "tests/notebooks/cli": 1.0,
    "tests/notebooks/study": 1.5,
    "tests/notebooks/test_tutorials.py": 1.0,
    "tests/perception/evidence": 8.0,
    "tests/perception/pilot": 5.0,
    "tests/perception/selection": 7.0,
    "tests/test_package.py": 1.0,
    "tests/test_readme.py": 1.0,
}
"""Of the tests that take longer than `A_TEST` minutes, on two cores."""
A_TEST = 0.3
MOST_MINUTES = 25.0
"""Beside the ordinary tests, which every change gets; all slow tests together take an hour."""


def tests_of(changed: str) -> Iterator[str]:
    """Yield the folders and files of tests that prove one changed file."""
    path = PurePosixPath(changed)
    parts = path.parts[1:] if path.parts[0] == "tests" else path.parts
    if changed.startswith(SHOWN_IN_A_BROWSER):
        yield "tests/browser"
    if changed.startswith("docs/"):
        yield "tests/docs"
    if changed.startswith(SHOWN_IN_PAGES):
        yield "tests/test_readme.py"
    if changed.startswith(ARCHIVED):
        yield "tests/test_package.py"
    if parts[0] in PACKAGES and len(parts) > 1:
        room = PurePosixPath("tests", *parts[:-1])
        while not (ROOT / room).is_dir():  # data folders have no tests of that name; those of the package prove them
            room = room.parent
        yield from rooms_of(room) if len(room.parts) == 2 else (str(room),)


def rooms_of(package: PurePosixPath) -> Iterator[str]:
    """Yield every room of the tests of a package, and the files beside them."""
    for path in sorted((ROOT / package).iterdir()):
        if any(path.glob("test_*.py")) or path.match("test_*.py"):
            yield str(package / path.name)


def selection(changed: Iterable[str]) -> list[str]:
    """Return what a change calls for, without folders inside another one, within `MOST_MINUTES`."""
    called = {test for name in changed for test in tests_of(name)} | set(ALWAYS)
    called = {test for test in called if not any(str(above) in called for above in PurePosixPath(test).parents)}
    chosen, left = [], MOST_MINUTES
    for test in sorted(called, key=lambda test: (test not in ALWAYS, MINUTES.get(test, A_TEST), test)):
        if test in ALWAYS or MINUTES.get(test, A_TEST) <= left:
            chosen.append(test)
            left -= MINUTES.get(test, A_TEST)
    return sorted(chosen)


def git(*arguments: str) -> str:
    """Return what a git command prints; nothing where it fails, as in a copy without history."""
    run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    return run.stdout.strip() if run.returncode == 0 else ""


def base() -> str:
    """Return the commit before the change: named by THERMICON_BASE, else where the branch began, last tag, or parent.

    Nothing where none is known, as after a push that replaced the commit that THERMICON_BASE names.
    """
    if given := os.environ.get("THERMICON_BASE"):
        return git("rev-parse", "--verify", f"{given}^{{commit}}")
    head = git("rev-parse", "HEAD")
    candidates = (
        git("merge-base", "HEAD", "origin/HEAD"),
        git("rev-list", "-n1", git("describe", "--tags", "--abbrev=0", "HEAD~1") or "-"),
        git("rev-parse", "--verify", "HEAD~1"),
    )
    return next((commit for commit in candidates if commit and commit != head), "")


if __name__ == "__main__":
    since = base()
    changed = git("diff", "--name-only", since, "HEAD") if since else git("ls-files")
    files = sys.argv[1:] or changed.splitlines()
    sys.stdout.write("".join(f"{test}\n" for test in selection(files)))
