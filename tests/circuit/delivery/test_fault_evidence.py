"""Evidence for the demands on the hardware: single faults in any play of random or shipped exports.

`-m slow` tries 20 exports of each kind of device, or as many as THERMICON_FAULTS says, and that many shipped icons on
shipped rigs (from 200 on all rigs with all icons, but for a family of which 12 are chosen), and prints what it tried.
"""

import os
import tomllib
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from tests.builders import messages
from tests.circuit.delivery.adversarial import BASES, between, some_cue, some_device, some_rig
from tests.circuit.delivery.faulted import NUISANCE, Faults, faulted
from tests.circuit.delivery.independent import Json
from tests.circuit.delivery.one_drive import icon_of
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.prepare import Prepared, prepare_set
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.icons import CueErrors, Icon, load_library, parse
from thermicon.icons.files.shipped import names_on_one_element

EXPORTS, LUMPS = int(os.environ.get("THERMICON_FAULTS", "20")), 1600
"""Exports of each kind; nodes of a rig in all its worlds at most."""
OF_A_SET, LONGEST_S, ALL = 12, 6.0, 10**6
"""Icons of a shipped set at most, by chance of a family; the longest cue by chance."""
Way = tuple[str, str]
VOLTS = [(name, form) for name in ("dac-12", "dac-14", "dac-16", "ni-analogue-output") for form in ("csv", "psychopy")]
KINDS: dict[str, list[Way]] = {
    "volts": [*VOLTS, ("coarse", "csv"), ("dac-12", "c-array"), ("ni-analogue-output", "tdms")],
    "amperes": [("source", "csv"), ("source", "c-array")],
    "bridge": [("pwm-h-bridge-10", "csv"), ("pwm-h-bridge-10", "c-array")],
    "set-points": [("qst-tcs2", "tcs2-serial"), ("qst-tcs2", "psychopy")],
    "temperatures": [("closed-loop-controller", "setpoint-csv"), ("closed-loop-controller", "psychopy")],
}
SHIPPED = [VOLTS[0], VOLTS[2], VOLTS[4], VOLTS[6], *(ways[0] for ways in list(KINDS.values())[2:])]
CASES = tomllib.loads(Path(__file__).with_name("faults.toml").read_text("utf-8"))


def tried(
    ready: Sequence[Prepared], form_name: str, rng: np.random.Generator, what: str, found: Faults, lumps: int = LUMPS
) -> bool:
    """The faults of an export; False, with its cause, where it is not green."""
    form = load_format(form_name)
    found.told["exports tried"] += 1
    for one in ready:
        for refusal in one.refusals:
            reason = str(one.verdict.reason).split(" reaches")[0][:40] if refusal.kind == "unsafe" else ""
            found.told[f"refused: {refusal.kind} {reason}".strip()] += 1
            return False
    try:
        files = pack(ready, form)
    except FormatError:
        found.told["refused: the format cannot hold it"] += 1
        return False
    own = faulted(files, [form.stem(one.delivery.icon.name) for one in ready], rng, lumps)
    own.unsafe = [f"{what}: {each}" for each in own.unsafe]
    own.told["green"] += 1
    own.told["exports with a fault beyond a limit"] += bool(own.unsafe)
    found.add(own)
    return True


def everyday(rng: np.random.Generator, device: str, name: str) -> Icon:
    """A step with a return, as in most studies."""
    way, size = ("warm", between(rng, 0.5, 5.5)) if rng.random() < 0.6 else ("cool", between(rng, 0.5, 9))
    shape = f"{way} by {size} °C at {between(rng, 1, 6)} °C/s; hold for {between(rng, 0.1, 1.5)} s"
    shape += f"; return at {between(rng, 1, 5)} °C/s" * (rng.random() < 0.9)
    return icon_of(shape, "display" if rng.random() < 0.6 else "skin", f"{rng.uniform(30, 34):.1f}", name)


def by_chance(number: int, kind: str, lumps: int = LUMPS) -> Faults:
    """The first green export of a seed."""
    found = Faults()
    with TemporaryDirectory() as folder:
        (source := Path(folder) / "source.toml").write_text(messages(__file__)["device"], "utf-8")
        for attempt in range(100):
            rng = np.random.default_rng([37, sum(map(ord, kind)), number, attempt])
            name, form = KINDS[kind][rng.integers(len(KINDS[kind]))]
            try:
                device = some_device(rng, name, Path(folder)) if name != "source" else Device.load(source)
                rig = Rig.load(str(rng.choice(BASES))) if rng.random() < 0.4 else some_rig(rng, name)
                cue = everyday if rng.random() < 0.6 else some_cue
                icons = [cue(rng, name, stem) for stem in (("a", "b") if rng.random() < 0.1 else ("a",))]
                if max(icon.corners().duration_s for icon in icons) > LONGEST_S:
                    continue
                ready = prepare_set(icons, rig, device, load_format(form))
            except (RigError, DeviceError, CueErrors):
                found.told["refused: cannot be played at all"] += 1
                continue
            what = f"{kind} {number} {attempt} {name} {form} {[str(icon) for icon in icons]} {rig.name} {rig.changes}"
            if tried(ready, form, rng, what, found, lumps):
                return found
    raise AssertionError(f"no green export of {kind} {number}")


def shipped(place: tuple[str, str, str], lumps: int = LUMPS) -> Faults:
    """A shipped icon on a shipped rig; nothing where it is refused."""
    library, name, rig_name = place
    rng, found = np.random.default_rng([38, *map(ord, name + rig_name)]), Faults()
    device, form = KINDS["set-points"][0] if rig_name == "tcs2" else SHIPPED[rng.integers(len(SHIPPED))]
    try:
        ready = prepare_set([load_library(library)[name]], Rig.load(rig_name), Device.load(device), load_format(form))
    except (RigError, DeviceError, CueErrors):
        found.told["refused: cannot be played at all"] += 1
        return found
    tried(ready, form, rng, f"{place} {device}", found, lumps)
    return found


def every(places: list[object], of: Callable[..., Faults]) -> Faults:
    """What all places come to, two at a time; nothing may be unsafe."""
    found = Faults()
    with ProcessPoolExecutor(2) as pool:
        for one in pool.map(of, places):
            found.add(one)
    print(found.table())
    assert found.unsafe == []
    assert [told for told, count in found.told.items() if count and told.startswith(NUISANCE)] == []
    return found


def prepared(case: Json) -> tuple[Prepared, ...]:
    icons = "".join(f"icon x{number} {{ {shape} }}\n" for number, shape in enumerate(case["icons"]))
    rig, cue = Rig.load(case["rig"]).with_(**case.get("changes", {})), f"cue 1\nset s {{ {case['set']} }}\n{icons}"
    return prepare_set(list(parse(cue)), rig, Device.load(case["device"]), load_format("csv"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["volts", "set-points"])
def test_an_export_with_faults(kind: str) -> None:
    found = by_chance(7001, kind, 100)
    assert found.unsafe == []
    assert found.tried["hang", "rest"] >= 5
    assert len({start for _, start in found.tried}) >= 6


def test_a_later_play_needs_a_longer_pause_for_its_faults_than_for_itself() -> None:
    rig = sure_rig("thenar", "contact_resistance_relative", "heat_sink_K", "gain_relative")
    icons, form = [icon_of("warm by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s")], load_format("csv")
    (soon,) = prepare_set(icons, rig, Device.load("dac-16"), form, pause_s=10.0)
    told = soon.verdict.to_dict()
    assert soon.verdict.colour == "red"
    assert f"the shortest safe pause is {told['shortest_pause_s']:g} s" in str(soon.verdict.reason)
    assert told["shortest_pause_s"] == soon.verdict.demanded["pause_at_least_s"]


@pytest.mark.slow
@pytest.mark.parametrize("name", list(CASES))
def test_demands_that_were_too_lax_are_found_to_be_and_are_no_more(name: str) -> None:
    case, found, form = CASES[name], Faults(), load_format("csv")
    ready, rng = prepared(case), np.random.default_rng(3)
    files = pack([replace(one, refusals=()) for one in ready], form)
    demands = dict.fromkeys(case["without"]) | case["demands"]
    then = faulted(files, [one.delivery.icon.name for one in ready], rng, ALL, demands)
    says = [*then.unsafe, *(told for told, count in then.told.items() if count)]
    assert [each for each in says if each.startswith(case["fault"]) and case["finds"] in each], says
    if green := [one for one in ready if not one.refusals]:
        tried(green, "csv", rng, name, found, ALL)
    assert found.unsafe == []
    assert [told for told, count in found.told.items() if count and told.startswith(NUISANCE)] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(KINDS))
def test_demands_hold_in_any_play(kind: str) -> None:
    found = every(list(range(EXPORTS)), partial(by_chance, kind=kind))
    for sort in ("hang", "stuck", "at a limit"):
        assert sum(count for (each, _), count in found.tried.items() if sort in each) >= 25 * EXPORTS


@pytest.mark.slow
def test_demands_hold_for_shipped_icons() -> None:
    rng = np.random.default_rng(35)
    places = []
    for library in names_on_one_element():
        icons = list(load_library(library))
        few = [icons[k] for k in sorted(rng.permutation(len(icons))[:OF_A_SET])]
        places += [(library, icon.name, rig) for icon in few for rig in rig_names()]
    chosen = rng.permutation(len(places))[: len(places) if EXPORTS >= 200 else EXPORTS]
    assert every([places[k] for k in chosen], shipped).told["green"]
