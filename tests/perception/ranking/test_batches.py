import itertools
import os
import signal
import subprocess
import sys
import time
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.icons.atomic import MARK
from thermicon.perception import rank
from thermicon.perception.ranking import batches as under_test
from thermicon.perception.ranking.batches import BatchResult, BatchStore, BatchStoreError, Job, run

RIG = Rig.load("thenar")
ICONS = load_library("six-icons")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chunks of three people of the six icons."""
    monkeypatch.setattr(under_test, "SAMPLES_AT_ONCE", 36_000)


def work(people: int = 8, **changes: object) -> Job:
    made = Job(tuple(ICONS)[:3], RIG, 18.0, people, 0, 48, None, "episodes")
    return replace(made, **changes)  # type: ignore[arg-type]


def arrays(result: BatchResult) -> dict[str, NDArray[np.float64]]:
    return {field.name: getattr(result, field.name) for field in fields(result)}


def test_batchs_cover_everyone_once_and_do_not_depend_on_how_many_there_are() -> None:
    for people in (1, 3, 500):
        asked = work(people)
        spans = [asked.span(number) for number in range(asked.batches)]
        assert spans[0][0] == 0
        assert spans[-1][1] == people
        assert all(a[1] == b[0] for a, b in itertools.pairwise(spans))
        assert asked.at_once == work().at_once


@pytest.mark.slow
def test_the_same_bytes_whatever_the_number_of_workers(few: None, tmp_path: Path) -> None:
    def ranked(workers: int | None, keep: Path | None = None) -> str:
        return rank(ICONS, RIG, people=10, parameters=2, workers=workers, keep=keep).to_json()

    one = ranked(1)
    assert ranked(2) == one
    assert ranked(3, tmp_path) == one
    assert len(list(tmp_path.glob("*/*.npz"))) > 2
    assert ranked(None, tmp_path) == one


def test_a_kept_batch_is_read_back_to_the_bit(tmp_path: Path) -> None:
    asked = work(3)
    store, found = BatchStore.of(asked.key, tmp_path), run(asked, 0)
    assert store.get(0) is None
    store.put(0, arrays(found))
    again = store.get(0)
    assert again is not None
    assert all(np.array_equal(again[name], values) for name, values in arrays(found).items())
    assert not list(store.folder.glob(f".*{MARK}*"))


def test_what_a_killed_run_left_half_written_goes_and_what_is_being_written_stays(tmp_path: Path) -> None:
    store = BatchStore.of("key", tmp_path)
    left, now = store.folder / f".000001.17.{MARK}.npz", store.folder / f".000002.19.{MARK}.npz"
    for draft in (left, now):
        draft.write_bytes(b"half")
    os.utime(left, (0.0, 0.0))
    store.put(0, {"x": np.zeros(1)})
    BatchStore.of("key", tmp_path)
    assert not left.exists()
    assert now.exists()
    assert store.get(0) is not None


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "other work", "other batch"])
def test_a_damaged_batch_counts_as_missing(damage: str, tmp_path: Path) -> None:
    asked = work(3)
    store = BatchStore.of(asked.key, tmp_path)
    store.put(0, arrays(run(asked, 0)))
    file = store.path(0)
    whole = file.read_bytes()
    if damage == "cut":
        file.write_bytes(whole[: len(whole) // 2])
    elif damage == "flipped":
        middle = len(whole) // 3
        file.write_bytes(whole[:middle] + bytes([whole[middle] ^ 0x10]) + whole[middle + 1 :])
    elif damage == "empty":
        file.write_bytes(b"")
    elif damage == "other work":
        other = BatchStore(store.folder, "another key")
        other.put(0, arrays(run(asked, 0)))
    else:
        file.rename(store.path(1))
        assert store.get(1) is None
        return
    assert store.get(0) is None


def test_batchs_of_other_work_have_another_place() -> None:
    assert work().key == work().key
    others = [work(9), work(seed=1), work(norm="naming"), work(tracking="ideal"), work(trials=60), work(end_s=19.0)]
    others += [work(rig=RIG.with_(**{"contact.area_cm2": 4})), work(icons=tuple(ICONS)[:4])]
    assert len({asked.key for asked in [work(), *others]}) == len(others) + 1


def test_messages(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BatchStoreError, match=r"cannot keep finished parts in .*file: Not a directory"):
        BatchStore.of(work().key, tmp_path / "file")
    with pytest.raises(ValueError, match=r"at least one worker is needed, not 0"):
        rank(ICONS, RIG, people=2, parameters=0, workers=0)
    with pytest.raises(ValueError, match=r"at least one person is needed, not 0"):
        rank(ICONS, RIG, people=0, parameters=0)


KILLED = """
import sys
from pathlib import Path
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception.ranking import batches
from thermicon.perception import rank
batches.SAMPLES_AT_ONCE = 36_000
made = rank(load_library("six-icons"), Rig.load("thenar"), people=60, parameters=0, keep=Path(sys.argv[1]), workers=1)
Path(sys.argv[2]).write_text(made.to_json())
"""


@pytest.mark.slow
def test_a_killed_run_goes_on_and_ends_with_the_same_bytes(few: None, tmp_path: Path) -> None:
    kept, out = tmp_path / "kept", tmp_path / "out.json"
    command = [sys.executable, "-c", KILLED, str(kept), str(out)]
    first = subprocess.Popen(command)
    until = time.monotonic() + 100.0
    while len(list(kept.glob("*/*.npz"))) < 3 and time.monotonic() < until:
        time.sleep(0.01)
    os.kill(first.pid, signal.SIGKILL)
    assert first.wait() == -signal.SIGKILL
    assert not out.exists()
    before = {file: file.stat().st_mtime_ns for file in kept.glob("*/*.npz")}
    assert 3 <= len(before) < 20
    subprocess.run(command, check=True, timeout=200)
    after = {file: file.stat().st_mtime_ns for file in kept.glob("*/*.npz")}
    assert len(after) == 20
    assert all(after[file] == stamp for file, stamp in before.items())
    assert rank(ICONS, RIG, people=60, parameters=0).to_json() == out.read_text()
