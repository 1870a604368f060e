"""What sidecars demand of the hardware holds in later plays: exports by chance and all shipped icons, with faults.

`-m slow` tries 20 exports of each kind, or as many as THERMICON_FAULTS says, and that many shipped icons on shipped
rigs (from 200 on all rigs with all icons, but for a family of which 12 are chosen).
"""

import os
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from tests.circuit.delivery.adversarial import some_cue, some_device, some_rig
from tests.circuit.delivery.faulted import faulted
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.prepare import Prepared, prepare_set
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.icons import CueErrors, load_library
from thermicon.icons.files.shipped import library_names

EXPORTS, WORLDS = int(os.environ.get("THERMICON_FAULTS", "20")), 3
OF_A_SET = 12
"""Icons of a shipped set at most, by chance of a family."""
VOLTS = (("dac-12", "csv"), ("dac-16", "csv"), ("coarse", "csv"), ("ni-analogue-output", "csv"))
KINDS = {"volts": VOLTS, "bridge": (("pwm-h-bridge-10", "csv"),), "set-points": (("qst-tcs2", "tcs2-serial"),)}
Told = tuple[Counter[str], list[str]]


def tried(ready: tuple[Prepared, ...], form_name: str, rng: np.random.Generator, most: int, what: str) -> Told | None:
    """The faults of an export; None where it is not green."""
    form = load_format(form_name)
    if any(one.verdict.colour == "red" or any(not each.forcible for each in one.refusals) for one in ready):
        return None
    try:
        files = pack(ready, form)
    except FormatError:
        return None
    found = faulted(files, [form.stem(one.delivery.icon.name) for one in ready], rng, most)
    return found.tried, [f"{what}: {found.unsafe}"] if found.unsafe else []


def by_chance(number: int, kind: str) -> Told:
    """The first green export of a seed."""
    with TemporaryDirectory() as folder:
        for attempt in range(100):
            rng = np.random.default_rng([33, sum(map(ord, kind)), number, attempt])
            ways = KINDS[kind]
            name, form = ways[rng.integers(len(ways))]
            try:
                rig, device = some_rig(rng, name), some_device(rng, name, Path(folder))
                icons = [some_cue(rng, name, stem) for stem in (("a", "b") if rng.random() < 0.15 else ("a",))]
                if kind == "bridge" and max(icon.corners().duration_s for icon in icons) > 4.0:
                    continue
                ready = prepare_set(icons, rig, device, load_format(form))
            except (RigError, DeviceError, CueErrors):
                continue
            what = f"{kind} {number} {attempt} {[str(icon) for icon in icons]} {rig.changes}"
            if (told := tried(ready, form, rng, 1000, what)) is not None:
                return told
    raise AssertionError(f"no green export of {kind} {number}")


def shipped(place: tuple[str, str, str]) -> Told:
    """A shipped icon on a shipped rig; nothing where it is refused."""
    library, name, rig_name = place
    thermode = rig_name == "tcs2"
    device, form = ("qst-tcs2", "tcs2-serial") if thermode else ("dac-16", "csv")
    try:
        ready = prepare_set([load_library(library)[name]], Rig.load(rig_name), Device.load(device), load_format(form))
    except (RigError, DeviceError, CueErrors):
        return Counter(), []
    rng = np.random.default_rng([34, *map(ord, name)])
    return tried(ready, form, rng, WORLDS, str(place)) or (Counter({"refused": 1}), [])


def every(places: list[object], of: Callable[..., Told]) -> Counter[str]:
    """Counts over all places, two at a time; nothing may be unsafe."""
    counts, unsafe = Counter[str](), list[str]()
    with ProcessPoolExecutor(2) as pool:
        for told, found in pool.map(of, places):
            counts += told
            unsafe += found
    print(dict(counts))
    assert unsafe == []
    return counts


@pytest.mark.parametrize("kind", ["volts", "set-points"])
def test_an_export_with_faults(kind: str) -> None:
    counts, unsafe = by_chance(7001, kind)
    assert unsafe == []
    assert sum(counts.values()) >= 25


def test_a_later_play_needs_a_longer_pause_for_its_faults_than_for_itself() -> None:
    counts, unsafe = shipped(("six-icons", "warming-step", "thenar"))
    assert unsafe == []
    assert counts["hangs until the watchdog"] == 25
    icons, rig, form = [load_library("six-icons")["warming-step"]], Rig.load("thenar"), load_format("csv")
    (soon,) = prepare_set(icons, rig, Device.load("dac-16"), form, pause_s=5.0)
    told = soon.verdict.to_dict()
    assert soon.verdict.colour == "red"
    assert f"the shortest safe pause is {told['shortest_pause_s']:g} s" in str(soon.verdict.reason)
    assert told["shortest_pause_s"] == soon.verdict.demanded["pause_at_least_s"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(KINDS))
def test_demands_hold_in_any_play(kind: str) -> None:
    counts = every(list(range(EXPORTS)), partial(by_chance, kind=kind))
    assert sum(counts.values()) >= 25 * EXPORTS


@pytest.mark.slow
def test_demands_hold_for_shipped_icons() -> None:
    rng = np.random.default_rng(35)
    places = []
    for library in library_names():
        icons = list(load_library(library))
        few = [icons[k] for k in sorted(rng.permutation(len(icons))[:OF_A_SET])]
        places += [(library, icon.name, rig) for icon in few for rig in rig_names()]
    chosen = rng.permutation(len(places))[: len(places) if EXPORTS >= 200 else EXPORTS]
    counts = every([places[k] for k in chosen], shipped)
    assert counts["stuck until the cut-off"]
