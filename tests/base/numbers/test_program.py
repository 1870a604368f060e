"""Digests of the program see every file of the ground floor, in a checkout and where a wheel is installed."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
CHANGED = """
import json, sys
from pathlib import Path
from thermicon.base.numbers import compiled, program

root = Path(compiled.__file__).parents[2]
assert str(root) == sys.argv[1], root  # nothing else is touched

def digests():
    program.code_digest.cache_clear()
    return program.code_digest(), compiled.digest_of(path for one in compiled.SOURCES for path in root.glob(one))

unseen, before = {"drives": [], "compiled": []}, digests()
for path in sorted((root / "base").rglob("*.py")):
    text = path.read_bytes()
    path.write_bytes(text + b"#")
    after = digests()
    path.write_bytes(text)
    for k, what in enumerate(unseen):
        if after[k] == before[k]:
            unseen[what].append(path.relative_to(root / "base").as_posix())
assert digests() == before
print(json.dumps([[one for one in compiled.SOURCES if not any(root.glob(one))], unseen]))
"""
"""Appends a byte to each file of the ground floor in turn."""


@pytest.mark.parametrize("layout", ["checkout", "wheel"])
def test_a_byte_of_the_ground_floor_changes_what_is_computed_with_it(layout: str, tmp_path: Path) -> None:
    inside = tmp_path / "thermicon" if layout == "wheel" else tmp_path
    for package in ("base", "icons", "circuit", "perception"):
        shutil.copytree(ROOT / package, inside / package, ignore=shutil.ignore_patterns("__pycache__", "*.ipynb"))
    front = tmp_path / "thermicon" / "__init__.py"
    front.parent.mkdir(exist_ok=True)
    front.write_text("" if layout == "wheel" else f"__path__.append({str(tmp_path)!r})\n", encoding="utf-8")
    run = subprocess.run(
        [sys.executable, "-B", "-c", CHANGED, inside],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "THERMICON_CACHE": str(tmp_path / "cache")},
    )
    assert run.returncode == 0, run.stderr
    empty, unseen = json.loads(run.stdout)
    assert (empty, unseen["drives"]) == ([], [])
    assert not {"numbers/compiled.py", "numbers/vector_math.py"} & {*unseen["compiled"]}
