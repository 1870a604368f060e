"""The lowest version of every requirement that pyproject.toml allows.

``pip install -r <(python .ci/lowest.py) -e .`` builds the oldest environment that the project promises to work in.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BOUND = re.compile(r"(?P<name>[\w.-]+)(?:\[[\w,.-]+\])?>=(?P<version>\d[\w.]*)(?:,<[\d.]+)?$")
ONLY_FOR_TESTS = {"test", "docs"}


def pins(pyproject: str) -> Iterator[str]:
    """Yield ``name==version`` for the requirements of the program and of its extras, each package once.

    Raises
    ------
    ValueError
        A requirement has no lower bound of the form ``name>=version`` (an upper bound may follow).

    """
    project = tomllib.loads(pyproject)["project"]
    extras = project.get("optional-dependencies", {})
    seen = set()
    for requirement in (
        *project["dependencies"],
        *(each for extra, listed in extras.items() if extra not in ONLY_FOR_TESTS for each in listed),
    ):
        bound = BOUND.match(requirement)
        if bound is None:
            raise ValueError(f"pyproject.toml: {requirement!r} is not of the form name>=version")
        if bound["name"] not in seen:
            seen.add(bound["name"])
            yield f"{bound['name']}=={bound['version']}"


if __name__ == "__main__":
    sys.stdout.write("".join(f"{pin}\n" for pin in pins((ROOT / "pyproject.toml").read_text(encoding="utf-8"))))
