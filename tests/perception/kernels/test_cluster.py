import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from tests.builders import free_port
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.notebooks.report.set_report import report_of
from thermicon.perception import rank
from thermicon.perception.kernels import cluster, kept_parts
from thermicon.perception.kernels.cluster import ClusterError, on_cluster
from thermicon.perception.kernels.kept_parts import KeptParts, kept_until_done

ICONS, RIG = load_library("six-icons"), Rig.load("thenar")


@contextmanager
def scheduler(folder: Path) -> Iterator[str]:
    """A real scheduler in a process of its own."""
    port = free_port()
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port)]
    with (folder / "scheduler.log").open("w") as log:
        process = subprocess.Popen([*command, "--no-dashboard"], stdout=log, stderr=log)
    try:
        until = time.monotonic() + 60.0
        while time.monotonic() < until:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.1)
        yield f"tcp://127.0.0.1:{port}"
    finally:
        process.terminate()
        process.wait(30)


def worker(address: str, folder: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1"]
    with (folder / f"worker{time.monotonic_ns()}.log").open("w") as log:
        return subprocess.Popen([*command, "--no-dashboard", "--local-directory", str(folder)], stdout=log, stderr=log)


def test_a_dead_address_is_said_within_seconds() -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    start = time.monotonic()
    with pytest.raises(ClusterError, match=rf"no cluster answers at {re.escape(address)} within 5 s: start one with"):
        rank(ICONS, RIG, people=2, parameters=0, workers=address)
    assert time.monotonic() - start < 30.0


@pytest.mark.parametrize("address", ["nonsense", "tcp://", "foo://bar:1", "tcp://here"])
def test_an_address_that_is_none(address: str) -> None:
    with pytest.raises(ClusterError, match=rf"'{address}' is not the address of a scheduler: give one such as tcp"):
        rank(ICONS, RIG, people=2, parameters=0, workers=address)


def test_without_the_package_the_cure_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"needs distributed, which is not installed: .*pip install .*distributed"):
        list(on_cluster(abs, 2, "tcp://127.0.0.1:1", "key"))


@pytest.mark.slow
def test_a_scheduler_without_workers(tmp_path: Path) -> None:
    with scheduler(tmp_path) as address, pytest.raises(ClusterError, match=r"has no workers: start some with `dask wo"):
        rank(ICONS, RIG, people=2, parameters=0, workers=address)


@pytest.mark.slow
def test_a_worker_is_killed_and_the_bytes_are_those_of_one_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    local = rank(ICONS, RIG, people=1000, parameters=0).to_json()
    monkeypatch.setattr(cluster, "PATIENCE_S", 60.0)
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.setenv(name, "4")  # without a nanny, which would set one thread
    done: list[int] = []
    with scheduler(tmp_path) as address:
        workers = [worker(address, tmp_path) for _ in range(3)]

        def kill_one(steps: int, of: int) -> None:
            done.append(steps)
            if steps == 2:  # the first step is what comes before the parts
                workers[0].kill()

        try:
            far = rank(ICONS, RIG, people=1000, parameters=0, workers=address, progress=kill_one).to_json()
        finally:
            for one in workers:
                one.kill()
            codes = [one.wait(60) for one in workers]
    assert codes[0] == -signal.SIGKILL
    assert done[-1] > 3, "parts were left when it was killed"
    assert far == local


def test_what_a_worker_with_other_code_computed_is_refused() -> None:
    from types import SimpleNamespace

    own, other = (SimpleNamespace(result=lambda code=code: (code, "scores")) for code in (cluster.code_digest(), "x"))
    assert cluster._result(own, "tcp://a") == "scores"
    with pytest.raises(ClusterError, match="tcp://a has another version of thermicon"):
        cluster._result(other, "tcp://a")


KILLED = """
import os, signal, sys
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.notebooks.report.set_report import report_of
from thermicon.perception.kernels import cluster
from thermicon.perception.kernels.kept_parts import KeptParts
cluster.PATIENCE_S = 60.0
write, left = KeptParts.write, iter(range(int(sys.argv[2])))
def write_and_die(*part):
    write(*part)
    if next(left) == int(sys.argv[2]) - 1:
        os.kill(os.getpid(), signal.SIGKILL)
KeptParts.write = write_and_die
report_of(load_library("six-icons"), Rig.load("thenar"), 4, edits="all", people=1000, workers=sys.argv[1])
"""


@pytest.mark.slow
def test_who_dies_goes_on_from_the_parts_that_were_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "PATIENCE_S", 60.0)
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path / "cache"))
    known = report_of(ICONS, RIG, 4, edits="all", people=1000)
    parts, batches = tmp_path / "cache" / "parts", known.ranking.job.batches
    sent = list[int]()
    from distributed import Client

    def submit(client: Client, work: object, *given: Any, _submit: Any = Client.submit, **how: Any) -> Any:
        sent.append(given[1])
        return _submit(client, work, *given, **how)

    with scheduler(tmp_path) as address:
        only = worker(address, tmp_path)
        try:
            for written in (2, batches, 3):  # in its batches, in its intervals, in its edits
                command = [sys.executable, "-c", KILLED, address, str(written)]
                assert subprocess.run(command, timeout=300, check=False).returncode == -signal.SIGKILL
            done = len(list(parts.iterdir()))
            monkeypatch.setattr(Client, "submit", submit)
            far = report_of(ICONS, RIG, 4, edits="all", people=1000, workers=address)
        finally:
            only.kill()
            only.wait(60)
    assert done == 2 + batches + 3
    assert len(sent) == len(far.edits) - 1
    assert far.to_json() == known.to_json()
    assert not list(parts.iterdir())


def test_parts_stay_until_all_stages_are_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path))

    @kept_until_done()
    def stage(key: str) -> None:
        kept = KeptParts.of(key)
        kept.write(0, 1)
        kept.done(1)

    with suppress(KeyError), kept_until_done():
        stage("first")
        raise KeyError
    assert dict(KeptParts.of("first").whole(1)) == {0: 1}
    with kept_until_done():
        stage("second")
        stage("first")
        assert len(list((tmp_path / "parts").iterdir())) == 2
    assert not list((tmp_path / "parts").iterdir())


def test_a_part_counts_only_as_this_user_wrote_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path))
    kept = KeptParts.of("this")
    for number in (0, 2, 3):
        kept.write(number, {"part": number})
    other = KeptParts.of("other")
    assert dict(kept.whole(5)) == {number: {"part": number} for number in (0, 2, 3)}
    assert not dict(other.whole(5))
    file = tmp_path / "parts" / "this-2"
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    (tmp_path / "parts" / "this-3").replace(tmp_path / "parts" / "this-4")
    assert dict(kept.whole(5)) == {0: {"part": 0}}
    going = KeptParts.of("this").whole(5)
    assert next(going) == (0, {"part": 0})
    monkeypatch.setattr(kept_parts, "MOST", 1)
    other.write(0, "no room")
    kept.forget(5)
    assert not list(going), "another client was done meanwhile"
    assert not list((tmp_path / "parts").iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="owners and modes are those of POSIX")
def test_where_nothing_can_be_kept_that_is_said_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    tmp_path.chmod(0o777)
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path / "open" / "to all"))
    kept = KeptParts.of("this")
    kept.write(0, 1)
    kept.forget(1)
    assert not list(kept.whole(1))
    assert [record.message.partition(":")[0] for record in caplog.records] == ["nothing is kept for a client that dies"]


SRUN = """#!/bin/bash
ask=${1#--ntasks=}; shift
for _ in $(seq "$ask"); do "$@" & done
wait
"""
"""A stand-in that starts the tasks of a step on this machine, as Slurm starts them on its nodes."""


@pytest.mark.slow
def test_the_script_for_slurm_ranks_as_one_machine_does(tmp_path: Path) -> None:
    page = (Path(__file__).parents[3] / "docs" / "how-to" / "large-families.md").read_text(encoding="utf-8")
    script = page.partition("```bash\n")[2].partition("```")[0]
    assert script.startswith("#!/bin/bash\n#SBATCH ")
    activate = tmp_path / "thermicon" / "bin" / "activate"
    activate.parent.mkdir(parents=True)
    activate.write_text(f'export PATH="{Path(sys.executable).parent}:$PATH"\n')
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "srun").write_text(SRUN)
    (tmp_path / "bin" / "srun").chmod(0o755)
    (tmp_path / "family.sh").write_text(script.replace("rank search-space", "rank six-icons --people 40 --intervals 0"))
    paths = {
        "HOME": str(tmp_path),
        "TMPDIR": str(tmp_path),
        "USER": "me",
        "PATH": f"{tmp_path}/bin:{os.environ['PATH']}",
    }
    slurm = {"SLURM_JOB_ID": "7", "SLURM_NTASKS": "3"}
    ran = subprocess.run(
        ["bash", "family.sh"], cwd=tmp_path, env=os.environ | paths | slurm, capture_output=True, text=True, timeout=600
    )
    assert ran.returncode == 0, ran.stderr
    far = json.loads((tmp_path / "ranking.json").read_text(encoding="utf-8"))
    local = json.loads(rank(ICONS, RIG, people=40, parameters=0).to_json())
    assert far["set"] == local["set"] and ran.stderr.count("Start worker at") >= 2
