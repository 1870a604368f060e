"""Parts of a long computation on a dask.distributed cluster.

Parts of a worker that dies are computed again by others; the result does not depend on which worker computed it.
"""

import logging
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from importlib import import_module
from typing import Any, TypeVar

from thermicon.base.numbers.program import DRIVES, numerics
from thermicon.base.numbers.program import code_digest as digest_of
from thermicon.base.words.installing import install

from .kept_parts import KeptParts

Part = TypeVar("Part")
PATIENCE_S = 5.0
"""How long to wait for a scheduler to answer, and for a first worker."""
RETRIES = 3
ADDRESS = re.compile(r"((tcp|tls|ws|wss)://)?[^\s/:]+:\d{1,5}|((tcp|tls|ws|wss)://)?\[[0-9a-fA-F:.]+\]:\d{1,5}")


class ClusterError(RuntimeError):
    """A cluster cannot be used; the text states why and what to change."""


def on_cluster(work: Callable[[int], Part], count: int, address: str, key: str) -> Iterator[tuple[int, Part]]:
    """Results of `work` for the numbers below `count`, on the cluster with the scheduler at `tcp://10.0.0.5:8786`.

    They are yielded as they are ready; what a client that died had received under the same key, which names work and
    code, is not computed again. Raises `ClusterError` where nothing answers, there is no worker, or a worker has
    other code or fails.
    """
    kept = KeptParts.of(key)
    left = set(range(count))
    for number, part in kept.whole(count):
        left.remove(number)
        yield number, part
    if left:
        yield from _computed(work, left, address, kept)
    kept.done(count)


def _computed(
    work: Callable[[int], Part], left: Iterable[int], address: str, kept: KeptParts
) -> Iterator[tuple[int, Part]]:
    with _client(address) as client:
        # One copy for each worker: what a part needs may be larger than what it gives.
        (everywhere,) = client.scatter([work], broadcast=True, hash=False)
        tasks = {client.submit(_run, everywhere, number, pure=False, retries=RETRIES): number for number in left}
        try:
            for task in import_module("distributed").as_completed(list(tasks), loop=client.loop):
                number = tasks.pop(task)
                found = _result(task, address)
                kept.write(number, found)
                yield number, found
                task.release()
        except BaseException:
            client.cancel(list(tasks))
            raise


@contextmanager
def _client(address: str) -> Iterator[Any]:
    try:
        distributed: Any = import_module("distributed")
    except ImportError as error:
        raise ClusterError(f"a cluster needs distributed, which is not installed: {install('distributed')}") from error
    if not ADDRESS.fullmatch(address):
        raise ClusterError(f"{address!r} is not the address of a scheduler: give one such as tcp://127.0.0.1:8786")
    with _quiet():
        try:
            client = distributed.Client(address, timeout=PATIENCE_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise ClusterError(
                f"no cluster answers at {address} within {PATIENCE_S:g} s: start one with `dask scheduler` and "
                "`dask worker ADDRESS`, and give the address that the scheduler prints, such as tcp://127.0.0.1:8786"
            ) from error
        try:
            try:
                client.wait_for_workers(1, timeout=PATIENCE_S)
            except TimeoutError as error:
                raise ClusterError(
                    f"the cluster at {address} has no workers: start some with `dask worker {address}`"
                ) from error
            yield client
        finally:
            client.close(timeout=PATIENCE_S)


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence the log messages of distributed about connections: failures are raised as errors."""
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.comm", "distributed.client", "tornado")]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)


def code_digest() -> str:
    """Hash of all code that computes a part, and of the Python and libraries that run it: others are refused."""
    return sha256(repr((digest_of((*DRIVES, "thermicon.perception")), numerics())).encode()).hexdigest()


def _run(work: Callable[[int], Any], number: int) -> tuple[str, Any]:
    """Runs on a worker: the hash of its code, and the part."""
    from thermicon.base.numbers.cores import at_most, quiet_blas

    with at_most(1), quiet_blas():
        return code_digest(), work(number)


def _result(task: Any, address: str) -> Any:
    try:
        code, result = task.result()
    except Exception as error:
        raise ClusterError(
            f"a worker of the cluster at {address} failed: {error or type(error).__name__}; all workers need the same "
            "version of thermicon as this machine, and memory for a part of the work"
        ) from error
    if code != code_digest():
        raise ClusterError(
            f"a worker of the cluster at {address} has another version of thermicon, Python, numpy, scipy or numba: "
            "install the same"
        )
    return result
