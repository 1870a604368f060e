"""Processor time that each cache saves in a command: ``python tests/benchmarks/saved_by_caches.py rank six-icons``.

The first three times that a cache answers, its function runs once more and is timed: what an answer saves. A script in
place of the command is possible too.
"""

import atexit
import functools
import runpy
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

lru_cache, cached_property = functools.lru_cache, functools.cached_property
caches: "list[Counted]" = []


@dataclass
class Counted:
    """A cached function: its name, its answers from the cache, and the seconds that some of them would have taken."""

    name: str
    hits: int = 0
    timed: int = 0
    seconds: float = 0.0

    def hit(self, compute: Callable[[], Any]) -> None:
        self.hits += 1
        if self.timed < 3:
            self.timed += 1
            begin = time.thread_time()
            compute()
            self.seconds += time.thread_time() - begin

    @property
    def saved_s(self) -> float:
        return self.hits * self.seconds / max(self.timed, 1)


def counted(function: Callable[..., Any]) -> Counted:
    caches.append(Counted(f"{function.__module__}.{function.__qualname__}".removeprefix("thermicon.")))
    return caches[-1]


def kept(maxsize: Any = 128, typed: bool = False) -> Any:
    """In place of `lru_cache`, with or without parentheses: it counts what is cached of thermicon."""
    if callable(maxsize):
        return kept()(maxsize)
    return lambda function: with_cache(function, maxsize, typed)


def with_cache(function: Callable[..., Any], maxsize: int | None, typed: bool) -> Callable[..., Any]:
    inner = lru_cache(maxsize, typed)(function)
    if not getattr(function, "__module__", "").startswith("thermicon"):
        return inner
    cache = counted(function)

    @functools.wraps(function)
    def asked(*arguments: Any, **named: Any) -> Any:
        misses = inner.cache_info().misses
        answer = inner(*arguments, **named)
        if inner.cache_info().misses == misses:
            cache.hit(lambda: function(*arguments, **named))
        return answer

    return asked


class CountedProperty(cached_property[Any]):
    """A cached property that counts."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self.cache = counted(function) if function.__module__.startswith("thermicon") else None

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        known = instance is not None and self.attrname in vars(instance)
        if known and self.cache is not None:
            self.cache.hit(lambda: self.func(instance))
        return super().__get__(instance, owner)

    def __set__(self, instance: Any, value: Any) -> None:  # so that what is known is asked for here, too
        vars(instance)[self.attrname] = value


def tell(begin: float) -> None:
    total = time.process_time() - begin
    for cache in sorted(caches, key=lambda each: -each.saved_s):
        share = cache.saved_s / total
        print(f"{share:8.1%} {cache.saved_s:8.3f} s  {cache.hits:7} times  {cache.name}", file=sys.stderr)


if __name__ == "__main__":
    functools.lru_cache, functools.cache = kept, kept(None)
    functools.cached_property = CountedProperty  # type: ignore[misc,assignment]
    atexit.register(tell, time.process_time())
    if sys.argv[1].endswith(".py"):
        runpy.run_path(sys.argv[1], run_name="__main__")
    else:
        from thermicon.notebooks.cli.main import main

        main()
