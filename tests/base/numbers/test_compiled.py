"""Compiled code that is kept: never read when foreign or made from other sources."""

import ast
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
from typing import Any
from unittest.mock import Mock

import numba
import pytest

from thermicon.base.files.cache_folder import NotPrivate, private_folder, remove_unused
from thermicon.base.numbers import compiled

ONLY_POSIX = pytest.mark.skipif(sys.platform == "win32", reason="owners and modes are those of POSIX")

STARTER = """
import os, signal, sys
import thermicon.base.numbers.compiled
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
    """Two modules, a compiled function that calls one of another file; and a run."""
    whole = tmp_path_factory.mktemp("compiled")
    folder = whole / "sources"
    folder.mkdir()
    (folder / "inner.py").write_text(
        "from thermicon.base.numbers.compiled import kernel\n\n\n@kernel()\ndef part(x):\n    return 2.0 * x\n"
    )
    (folder / "outer.py").write_text(
        "from thermicon.base.numbers.compiled import kernel\nfrom inner import part\n\n\n"
        "@kernel()\ndef total(x):\n    return part(x) + 1.0\n"
    )
    assert run(folder, whole / "cache") == (7.0, 0, "")
    return whole


@pytest.fixture
def sources(first: Path) -> Path:
    """The modules; beside them stands the cache, in which the functions are kept."""
    return first / "sources"


@pytest.fixture
def cache(first: Path, tmp_path: Path) -> Path:
    """A copy of the cache."""
    shutil.copytree(first / "cache", tmp_path / "cache")
    return tmp_path / "cache"


def kept_of(cache: Path) -> Path:
    """The folder of one set of sources and versions."""
    (folder,) = cache.glob("compiled/*/*")
    return folder


def test_processes_that_compile_the_same_at_once_share_a_folder(run: Run, sources: Path, tmp_path: Path) -> None:
    with ThreadPoolExecutor() as pool:
        assert {result[0] for result in pool.map(run, [sources] * 3, [tmp_path / "cache"] * 3)} == {7.0}
    assert run(sources, tmp_path / "cache") == (7.0, 1, "")


def test_machine_code_is_kept_and_read_again(run: Run, sources: Path, cache: Path) -> None:
    assert run(sources, cache) == (7.0, 1, "")
    assert {kept_of(cache).stat().st_mode & 0o777, kept_of(cache).parent.stat().st_mode & 0o777} == {0o700}
    names = {path.name.partition("-")[0] for path in kept_of(cache).rglob("*.nb?")}
    assert names == {"inner.part", "outer.total"}
    assert not list(sources.rglob("*.nb?"))
    (cache / "file").write_text("")  # without a place it is compiled in memory, which is said once
    value, hits, said = run(sources, cache / "file" / "cache")
    assert (value, hits, len(said.splitlines())) == (7.0, 0, 1)
    assert said.startswith("compiled code cannot be stored, so that every run compiles it again: ")


def test_the_digest_covers_all_that_is_compiled_and_its_constants(tmp_path: Path) -> None:
    root = Path(compiled.__file__).parents[2]
    covered = {path for one in compiled.SOURCES for path in root.glob(one)}
    assert all(any(root.glob(one)) for one in compiled.SOURCES)
    one, other = Path(__file__), tmp_path / "b.py"
    other.write_text("X = 1\n")
    digest = compiled.digest_of([one, other])
    assert digest == compiled.digest_of([other, one])
    other.write_text("X = 2\n")
    assert digest != compiled.digest_of([one, other])
    compiling = 0
    for path in (path for package in ("circuit", "perception") for path in (root / package).rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        foreign = path.name != "compiled.py" and ("njit" in text or "cache=True" in text)
        assert not foreign, f"{path}: use thermicon.base.numbers.compiled.kernel"
        if "compiled" not in text and "vectorised" not in text:
            continue
        imports = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
        if {alias.name for node in imports for alias in node.names} & {"kernel", "compiled", "vectorised"}:
            compiling += 1
            assert path in covered
            for node in imports:
                above = path.parents[node.level - 1] if node.level else root
                module = (node.module or "").removeprefix("thermicon.").replace(".", "/")
                constants = [alias.name for alias in node.names if alias.name.isupper()]
                assert not constants or above / f"{module}.py" in covered, f"{path} takes {constants} from {module}"
    assert compiling > 9


class Evil:
    """Leaves a mark where a pickle of it is read."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.mkdir, (str(self.mark),)


@ONLY_POSIX
@pytest.mark.parametrize("how", ["written", "entered", "planted"])
def test_what_others_can_write_is_never_read(run: Run, sources: Path, cache: Path, tmp_path: Path, how: str) -> None:
    mark, folder = tmp_path / "mark", kept_of(cache)
    for path in folder.rglob("*.nb?"):
        path.write_bytes(pickle.dumps(Evil(mark)))
    if how == "written":
        folder.chmod(0o777)
    elif how == "entered":
        folder.chmod(0o755)
    elif os.geteuid() == 0:
        os.chown(next(folder.iterdir()), 12345, 12345)
    else:
        pytest.skip("only root can make what another user would")
    value, hits, said = run(sources, cache)
    assert (value, hits, mark.exists()) == (7.0, 0, False)
    words = "can be written by others; set THERMICON_CACHE" if how == "written" else "what others wrote; delete it"
    assert words in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    ("where", "value", "said"),
    [
        ((os, "access"), lambda *_: False, "compiled code cannot be stored, so that every run compiles it again: "),
        ((Path, "exists"), Mock(side_effect=PermissionError(13, "Not allowed")), "cannot be created (Not allowed)"),
        ((compiled, "__file__"), os.fsdecode(b"/Gr\xff/base/numbers/compiled.py"), "cannot read; set PYTHONUTF8=1"),
    ],
    ids=["not written", "not entered", "not readable"],
)
def test_a_folder_without_a_safe_place_is_not_used(
    monkeypatch: pytest.MonkeyPatch, cache: Path, caplog: pytest.LogCaptureFixture, where: Any, value: Any, said: str
) -> None:
    monkeypatch.setattr(*where, value)  # to root every folder is writable
    monkeypatch.setenv("THERMICON_CACHE", str(cache))
    assert compiled.kept_in.__wrapped__() is None
    assert said in caplog.text


def test_other_users_of_numba_keep_their_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(compiled, "kept_in", lambda: tmp_path / "ours")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "theirs"))

    def twice(x: float) -> float:
        return 2.0 * x

    with ThreadPoolExecutor() as pool:
        ours = list(pool.map(lambda _: compiled.kernel()(twice), range(50)))
    assert str(tmp_path / "theirs") == numba.config.CACHE_DIR
    assert {Path(each.stats.cache_path).parent for each in ours} == {tmp_path / "ours"}
    assert not (tmp_path / "theirs").exists()


@ONLY_POSIX
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
    with pytest.raises(NotPrivate, match="open can be written by others"):
        private_folder(open_)  # where all may put files, only a folder below is one's own
    assert private_folder(open_ / "mine").is_dir()
    if os.geteuid() == 0:
        os.chown(open_ / "mine", 12345, 12345)
        with pytest.raises(NotPrivate, match="belongs to another user"):
            private_folder(open_ / "mine")


def test_what_is_read_or_written_now_and_then_is_kept(tmp_path: Path) -> None:
    now, day = time.time(), 24 * 3600.0
    for name, ages in {"read": (1, 99), "written": (99, 1), "neither": (91, 92)}.items():
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, tuple(now - age * day for age in ages))
    remove_unused(tmp_path.iterdir(), compiled.STALE_S)
    assert {path.name for path in tmp_path.iterdir()} == {"read", "written"}
