"""Shared by all tests: the door to programs that pip does not install."""

from __future__ import annotations

import gc
import hashlib
import os
import pickle
import shutil
import signal
import sys
from collections.abc import Callable, Iterator
from functools import wraps
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

import hypothesis
import pytest

if TYPE_CHECKING:
    from thermicon.perception.evidence.validate import ValidationReport

# Many tests start interpreters of their own: what one has compiled to bytecode, the next need not.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# A job in the background ignores interrupts, and so would the programs that tests start and interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)
# As in the program: threads of linear algebra would wait for cores that other processes use.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The check of IRIs in jsonschema, which no test needs, builds 38 grammars on import: 5 s for each process.
sys.modules.setdefault("rfc3987_syntax", cast(ModuleType, None))

# The same examples on every run: a red suite means a changed program. Slow tests may ask for more.
hypothesis.settings.register_profile("steady", derandomize=True, deadline=None)
hypothesis.settings.load_profile("steady")


def pytest_xdist_auto_num_workers() -> int:
    """Two processes more than there are cores, since some tests wait for servers and browsers."""
    return (os.cpu_count() or 1) + 2


def pytest_collection_finish() -> None:
    """What five thousand tests are made of stays: looking for garbage in it again and again takes time."""
    gc.freeze()


DEBIAN_PACKAGE = {"cc": "gcc", "chromium": "chromium", "ngspice": "ngspice"}


@pytest.hookimpl(tryfirst=True)  # before pytest deselects what is slow
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What reads the validation report is slow: the report alone computes for twenty seconds."""
    for item in items:
        if "validation_report" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.slow)


def find_tool(name: str) -> str:
    """Path of an outside program; without it the test fails where tools are required and is skipped elsewhere."""
    path = shutil.which(name)
    if path is not None:
        return path
    message = f"{name} is not installed; on Debian or Ubuntu: apt-get install {DEBIAN_PACKAGE.get(name, name)}"
    if os.environ.get("THERMICON_REQUIRE_TOOLS") == "1":
        pytest.fail(message)
    pytest.skip(message)


@pytest.fixture(scope="session")
def tool() -> Callable[[str], str]:
    """``tool("ngspice")`` inside a test gives the path of the program."""
    return find_tool


def shared_folder(factory: pytest.TempPathFactory) -> Path:
    """A folder of this run, the same for all processes that run its tests."""
    base = factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


def remembered(judge: Callable[..., Any], folder: Path) -> Callable[..., Any]:
    """Keep what a function returns in a folder, under a hash of all arguments; errors are not kept."""
    folder.mkdir(parents=True, exist_ok=True)

    @wraps(judge)
    def asked(*arguments: Any, **named: Any) -> Any:
        kept = folder / hashlib.sha256(pickle.dumps((arguments, sorted(named.items())))).hexdigest()
        if kept.exists():
            return pickle.loads(kept.read_bytes())
        verdicts = judge(*arguments, **named)
        draft = kept.with_suffix(f".{id(verdicts)}")
        draft.write_bytes(pickle.dumps(verdicts))
        draft.replace(kept)
        return verdicts

    return asked


@pytest.fixture(scope="session", autouse=True)
def verdicts(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What exports ask of the safety gate is computed once in a run; tests of the gate itself ask it directly."""
    from thermicon.circuit.delivery import export, ways

    folder = shared_folder(tmp_path_factory) / "verdicts"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "kept_or_judged", lambda drives, pause_s, about="": ways.worst_cases(drives, pause_s))
        for name in ("gate_set", "gate_shown", "gate_controlled"):
            patch.setattr(ways, name, remembered(getattr(ways, name), folder / name))
        yield


@pytest.fixture(scope="session")
def validation_report(tmp_path_factory: pytest.TempPathFactory) -> ValidationReport:
    """One small validation report for all tests and for all processes that run them: it takes long to compute."""
    from filelock import FileLock

    from thermicon.perception.evidence.validate import validate

    kept = shared_folder(tmp_path_factory) / "validation_report.pickle"
    with FileLock(f"{kept}.lock"):
        if not kept.exists():
            kept.write_bytes(pickle.dumps(validate(people=12, draws=8)))
        report: ValidationReport = pickle.loads(kept.read_bytes())
        return report
