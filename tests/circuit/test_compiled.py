"""Compiled code that is kept: never read when damaged, foreign or made from other sources."""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

import pytest

from thermicon.circuit import compiled
from thermicon.icons.userfolder import NotPrivate, private_folder, read_private, write_private

POSIX = sys.platform != "win32"


STARTER = """
import os, signal, sys
import thermicon.circuit.compiled
from numba import njit
signal.signal(signal.SIGCHLD, signal.SIG_IGN)
njit(lambda x: x + 1.0)(1.0)  # what numba sets up at its first compilation
for line in sys.stdin:
    sources, cache, result = line.rstrip("\\n").split("\\t")
    if os.fork():
        continue
    os.environ["THERMICON_CACHE"] = cache
    sys.path.insert(0, sources)
    sys.stderr = open(result + ".stderr", "w")
    import outer
    with open(result + ".draft", "w") as file:
        print(outer.total(3.0), sum(outer.total.stats.cache_hits.values()), file=file)
    sys.stderr.close()
    os.rename(result + ".draft", result)
    os._exit(0)
"""
"""A program that has imported numba, which takes seconds, and forks a process of its own for each run."""

Run = Callable[[Path, Path], tuple[float, int, str]]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """``run(sources, cache)``: result in a new process, how often code was read, what stderr said."""
    results, number = tmp_path_factory.mktemp("results"), count()
    with subprocess.Popen([sys.executable, "-B", "-c", STARTER], stdin=subprocess.PIPE, text=True) as starter:
        assert starter.stdin is not None

        def start(sources: Path, cache: Path) -> tuple[float, int, str]:
            assert starter.stdin is not None
            result = results / str(next(number))
            starter.stdin.write(f"{sources}\t{cache}\t{result}\n")
            starter.stdin.flush()
            for _ in range(1200):
                if result.exists():
                    break
                time.sleep(0.05)
            value, hits = result.read_text().split()
            return float(value), int(hits), Path(f"{result}.stderr").read_text()

        yield start
        starter.stdin.close()


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory, run: Run) -> Path:
    """Two modules, a compiled function that calls one of another file, which reads a constant of a third; and a run."""
    whole = tmp_path_factory.mktemp("compiled")
    folder = whole / "sources"
    folder.mkdir()
    (folder / "number.py").write_text("FACTOR = 2.0\n")
    (folder / "inner.py").write_text(
        "from thermicon.circuit.compiled import kernel\nfrom number import FACTOR\n\n\n"
        "@kernel()\ndef part(x):\n    return FACTOR * x\n"
    )
    (folder / "outer.py").write_text(
        "from thermicon.circuit.compiled import kernel\nfrom inner import part\n\n\n"
        "@kernel()\ndef total(x):\n    return part(x) + 1.0\n"
    )
    assert run(folder, whole / "cache") == (7.0, 0, "")
    return whole


@pytest.fixture
def sources(first: Path, tmp_path: Path) -> Path:
    """A copy of the modules; beside it stands a copy of the cache, in which the function is kept."""
    shutil.copytree(first, tmp_path, dirs_exist_ok=True)
    return tmp_path / "sources"


def test_processes_that_compile_the_same_at_once_share_a_folder(run: Run, sources: Path, tmp_path: Path) -> None:
    shutil.rmtree(tmp_path / "cache")
    with ThreadPoolExecutor() as pool:
        assert {result[0] for result in pool.map(run, [sources] * 3, [tmp_path / "cache"] * 3)} == {7.0}
    assert run(sources, tmp_path / "cache") == (7.0, 1, "")
    (kept,) = (tmp_path / "cache" / "compiled").iterdir()
    assert sorted(path.name.partition("-")[0] for path in kept.iterdir()) == ["part", "total"]


def test_machine_code_is_kept_and_read_again(run: Run, sources: Path, tmp_path: Path) -> None:
    assert run(sources, tmp_path / "cache") == (7.0, 1, "")
    (kept,) = (tmp_path / "cache" / "compiled").iterdir()
    assert kept.stat().st_mode & 0o777 == 0o700
    assert sorted(path.name.partition("-")[0] for path in kept.iterdir()) == ["part", "total"]
    assert {path.stat().st_mode & 0o777 for path in kept.iterdir()} == {0o600}
    assert not list(sources.rglob("*.nb?"))


@pytest.mark.parametrize(
    ("file", "old", "new", "expected"),
    [
        ("inner.py", "FACTOR * x", "FACTOR * x * 10.0", 61.0),
        ("number.py", "2.0", "5.0", 16.0),
        ("inner.py", "@kernel()", "@kernel(fastmath=True)", 7.0),
    ],
)
def test_a_change_in_another_file_is_seen(
    run: Run, sources: Path, tmp_path: Path, file: str, old: str, new: str, expected: float
) -> None:
    (sources / file).write_text((sources / file).read_text().replace(old, new))
    assert run(sources, tmp_path / "cache") == (expected, 0, "")


@pytest.mark.parametrize("damage", [b"", None], ids=["empty", "a bit"])
def test_damaged_machine_code_is_compiled_anew(run: Run, sources: Path, tmp_path: Path, damage: bytes | None) -> None:
    for path in (tmp_path / "cache" / "compiled").glob("*/*"):
        data = bytearray(path.read_bytes())
        data[len(data) // 2] ^= 0xFF
        path.write_bytes(bytes(data) if damage is None else damage)
    assert run(sources, tmp_path / "cache") == (7.0, 0, "")
    assert run(sources, tmp_path / "cache") == (7.0, 1, "")


class Evil:
    """Leaves a mark where a pickle of it is read."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.mkdir, (str(self.mark),)


@pytest.mark.skipif(not POSIX, reason="owners and modes are those of POSIX")
@pytest.mark.parametrize("how", ["folder", "file", "link"])
def test_what_others_can_write_is_never_read(run: Run, sources: Path, tmp_path: Path, how: str) -> None:
    cache, mark = tmp_path / "cache", tmp_path / "mark"
    content = pickle.dumps(Evil(mark))
    forged = hashlib.sha256(content).digest() + content
    (folder,) = (cache / "compiled").iterdir()
    for path in list(folder.iterdir()):
        path.write_bytes(forged)
        if how == "file":
            path.chmod(0o666)
        if how == "link":
            path.rename(tmp_path / path.name)
            path.symlink_to(tmp_path / path.name)
    if how == "folder":
        folder.chmod(0o777)
    value, hits, said = run(sources, cache)
    assert (value, hits, mark.exists()) == (7.0, 0, False)
    assert ("can be written by others; set THERMICON_CACHE" in said) == (how == "folder")
    assert len(said.splitlines()) == (how == "folder")


def test_without_a_place_it_is_compiled_in_memory_and_said_once(run: Run, sources: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    value, hits, said = run(sources, tmp_path / "file" / "cache")
    assert (value, hits) == (7.0, 0)
    assert said.startswith("compiled code cannot be stored, so that every run compiles it again: ")
    assert len(said.splitlines()) == 1


def test_all_kernels_of_the_project_are_kept_this_way() -> None:
    root = Path(compiled.__file__).parents[1]
    for path in [*(root / "circuit").rglob("*.py"), *(root / "perception").rglob("*.py")]:
        if path.name != "compiled.py":
            text = path.read_text(encoding="utf-8")
            assert "njit" not in text and "cache=True" not in text, f"{path}: use thermicon.circuit.compiled.kernel"


def test_the_digest_covers_what_is_called(tmp_path: Path) -> None:
    from thermicon.circuit.solver import kernel

    digest = compiled.source_digest(kernel.follow.py_func)
    assert digest == compiled.source_digest(kernel.follow.py_func)
    assert digest != compiled.source_digest(kernel.factor.py_func) or kernel.follow is kernel.factor
    assert len(digest) == 64


@pytest.mark.skipif(not POSIX, reason="owners and modes are those of POSIX")
def test_a_private_folder_has_private_folders_above(tmp_path: Path) -> None:
    open_ = tmp_path / "open"
    open_.mkdir()
    open_.chmod(0o777)
    with pytest.raises(NotPrivate, match="open can be written by others"):
        private_folder(open_ / "mine")
    os.chown(open_, -1, os.geteuid() if os.geteuid() == 0 else os.getegid())
    open_.chmod(0o770)  # also where the group has the user's own number: it may have other members
    with pytest.raises(NotPrivate, match=r"open can be written by others; .*chmod go-w"):
        private_folder(open_ / "mine")
    with pytest.raises(NotPrivate, match="open can be written by others"):
        private_folder(open_)
    open_.chmod(0o1777)
    assert private_folder(open_ / "mine").is_dir()
    if os.geteuid() == 0:
        os.chown(open_ / "mine", 12345, 12345)
        with pytest.raises(NotPrivate, match="belongs to another user"):
            private_folder(open_ / "mine")


@pytest.mark.slow
def test_a_private_file_is_whole_or_absent(tmp_path: Path) -> None:
    write_private(tmp_path / "a", b"x")
    assert read_private(tmp_path / "a") == b"x"
    assert read_private(tmp_path / "b") is None
    assert read_private(tmp_path) is None
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_options_have_the_same_text_in_every_process() -> None:
    script = (
        "from thermicon.circuit.compiled import _in_order; print(_in_order({'fastmath': {'nsz', 'arcp', 'contract'}}))"
    )
    texts = {
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in (1, 2)
    }
    assert texts == {"[('fastmath', ['arcp', 'contract', 'nsz'])]\n"}


def test_a_folder_that_cannot_be_written_is_read(
    monkeypatch: pytest.MonkeyPatch, sources: Path, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)  # to root every folder of a test is writable
    monkeypatch.setenv("THERMICON_CACHE", str(sources.parent / "cache"))
    folder = compiled.kept_in.__wrapped__()
    assert folder is not None
    assert sum(1 for _ in folder.iterdir()) == 2
    assert caplog.text == ""
    for kept in folder.iterdir():
        kept.unlink()
    assert compiled.kept_in.__wrapped__() is None
    assert "compiled code cannot be stored" in caplog.text
