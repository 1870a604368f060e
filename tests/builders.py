"""Builders and waiters for tests of several rooms: messages, steps, a laboratory, quantiles, answers of a server."""

import socket
import time
import tomllib
import urllib.error
import urllib.request
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit import Rig
from thermicon.icons import Icon, IconSet, parse
from thermicon.perception import Observer, Percept
from thermicon.perception.identification.episodes import episode_distances, remembered
from thermicon.perception.identification.population import memory_dprime
from thermicon.perception.identification.task import USUAL
from thermicon.perception.observer.channels import MEMORY_FORMS
from thermicon.perception.observer.mechanisms.memory import PAIRS
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.observer.people import People
from thermicon.perception.selection.appraise import population_response


def population_dprime(icons: Sequence[Icon], rig: Rig, crowd: People) -> NDArray[np.float64]:
    """Pairwise d′ (people, icons, icons) from memory, by the shipped observer."""
    nominal = Observer.load()
    felt, _ = population_response(icons, rig, crowd, observer=nominal)
    return memory_dprime(felt, MEMORY_FORMS[0], crowd.memory, nominal, USUAL)


def messages(beside: str, name: str = "messages.toml") -> dict[str, Any]:
    """The table of this name nearest to a test file, which is given as its ``__file__``: beside it, or above."""
    found = next(folder / name for folder in Path(beside).parents if (folder / name).exists())
    return tomllib.loads(found.read_text(encoding="utf-8"))


def missing(words: str | list[str], told: str) -> list[str]:
    """Key words that are not in what was said."""
    return [word for word in ([words] if isinstance(words, str) else words) if word not in told]


def steps(**by_K: float) -> IconSet:
    """Icons that cool (negative) or warm the display by so much at 3 K/s for 2 s."""
    rest = "K at 3 K/s; hold for 2 s; return at 3 K/s }"
    ways = {name: f"{'cool' if change < 0 else 'warm'} by {abs(change):g}" for name, change in by_K.items()}
    icons = (f"icon {name} {{ {way} {rest}" for name, way in ways.items())
    return parse("cue 1; set s { control display; baseline 32 °C };" + ";".join(icons))


def free_port() -> int:
    """A port of this machine that nobody listens at."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def answers(address: str, ended: Callable[[], object], within_s: float = 60.0) -> bool:
    """Wait for a server; whether it answers before it has ended, or the time is over."""
    until = time.monotonic() + within_s
    while time.monotonic() < until and ended() is None:
        try:
            urllib.request.urlopen(address, timeout=10).close()
        except urllib.error.HTTPError:
            return True
        except OSError:
            time.sleep(0.1)
        else:
            return True
    return False


def dprime_from_memory(felt: Sequence[Percept], observer: Observer | None = None) -> float:
    """d′ of two percepts when one of them comes from memory."""
    person = Observer.load() if observer is None else observer
    found = remembered(felt, person)
    return float(episode_distances(found, found, person, "episodes")[0, 0, 1])


def few_draws(path: Path, count: int, resampled: str = "", rig: str = "") -> Path:
    """Write the first draws of the shipped posterior to a file, as ``pilot --keep`` writes one.

    They are those of one laboratory where ``resampled`` says how they were obtained.
    """
    from thermicon.perception.observer.constants import BETWEEN_LABORATORIES
    from thermicon.perception.observer.draws import PosteriorDraws
    from thermicon.perception.observer.draws_file import to_text

    shipped = PosteriorDraws.load()
    values = shipped.draws[:count].copy()
    if resampled:
        values[:, shipped.names.index(BETWEEN_LABORATORIES)] = 1e-6
    header = replace(shipped.header, resampled=resampled, rig=rig)
    path.write_text(to_text(header, shipped.names, values), encoding="utf-8")
    return path


def weighted_quantile(
    values: NDArray[np.float64], weights: NDArray[np.float64], shares: tuple[float, ...]
) -> tuple[float, ...]:
    """Quantiles of weighted values, linear between the middles of their weights."""
    order = np.argsort(values, kind="stable")
    place = np.cumsum(weights[order]) - 0.5 * weights[order]
    return tuple(float(q) for q in np.interp(shares, place, values[order]))


def without_pairs() -> ObserverModel:
    """The shipped model, with pairs that every laboratory confuses as its constants say."""
    model = ObserverModel.load()
    records = [
        replace(each, value=0.0, low=0.0, high=0.0) if each.quantity == PAIRS else each for each in model.records
    ]
    return replace(model, records=replace(model.records, records=tuple(records)))
