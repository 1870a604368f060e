"""Exports on several elements on the independent circuit.

`-m slow` tries 200 exports, or as many as THERMICON_FAULTS says.
"""

import itertools
import os
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tests.circuit.delivery.exported_files import read_file, sidecar_in
from tests.circuit.delivery.faulted import Faults, faulted
from tests.circuit.delivery.independent import Array
from tests.circuit.delivery.replay import Held, Player
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Element, Export, InputError, Layout, Rig, export
from thermicon.circuit.delivery.pack import sidecar_text
from thermicon.circuit.rig.layoutfile import Sink, Supply
from thermicon.icons import IconSet, parse

EXPORTS, LUMPS = int(os.environ.get("THERMICON_FAULTS", "200")), 300
WIDE = Supply(current_limit_A=100.0, power_limit_W=1000.0)
ONE_BEFORE_THE_OTHER = (
    "on left { warm by 3 °C at 3 °C/s; return at 3 °C/s }; on all { rest for 500 ms }; "
    "on right { warm by 3 °C at 3 °C/s; return at 3 °C/s }"
)
AT_ONCE = (
    "together { on left { warm by 3 °C at 3 °C/s; return at 3 °C/s }; "
    "on right { cool by 4 °C at 3 °C/s; return at 3 °C/s } }"
)
Files = dict[str, bytes]


def spatial(*bodies: str, control: str = "display") -> IconSet:
    icons = "\n".join(f"icon x{place} {{ {body} }}" for place, body in enumerate(bodies))
    return parse(f"cue 1\nset {{ elements left, right; control {control}; baseline 32 °C }}\n{icons}")


def pair(rig: Rig, other: Rig | None = None, surfaces: str = "apart", supply: Supply | None = WIDE) -> Layout:
    elements = (Element(rig, "left", (0.0, 0.0)), Element(other or rig, "right", (0.05, 0.0)))
    return Layout(elements, "pair", surfaces=surfaces, supply=supply)  # type: ignore[arg-type]


def alone(files: Mapping[str, bytes], element: str) -> Files:
    """What a reader of one element finds in files of several: its column or its zone, and its part of each sidecar."""
    own: Files = {}
    for stem in (name.removesuffix(".json") for name in files if name.endswith(".json")):
        told = sidecar_in(files, stem)
        part = next(each for each in told["elements"] if each["element"] == element)
        data = files[told["file"]]
        if isinstance(part["channel"], str):
            profile = next(
                line for line in data.split() if line[:2] == b"Uw" and _overlap(line[2:7].decode(), part["channel"])
            )
            first, most, *_, zones, start = data.split()
            data = b"\n".join([first, most, b"Uw11111" + profile[7:], zones, start]) + b"\n"
        else:
            data = data.replace(f"{element}_".encode(), b"", data.split(b"\n")[0].count(f"{element}_".encode()))
        own |= {f"{stem}.json": sidecar_text({**told, **part, "elements": None}), told["file"]: data}
    return own


def _overlap(mask: str, zone: str) -> bool:
    return any(a == b == "1" for a, b in zip(mask, zone, strict=True))


def stems(files: Mapping[str, bytes]) -> list[str]:
    return [name.removesuffix(".json") for name in files if name.endswith(".json")]


def drawn(files: Files, stem: str, rng: np.random.Generator) -> tuple[Array, Array]:
    """Amperes and watts (rows,) that one element takes, in the worst of all worlds, by the independent circuit."""
    held, document = read_file(files, stem), sidecar_in(files, stem)["rig"]["document"]
    assert isinstance(held, Held)
    player = Player(document, rng, 0)
    rows, steps_s, _ = player.play(held, player.rest(held))
    hotter_K = rows[:-1, :, 3, 0] - rows[:-1, :, 2, 0]
    row_A = np.repeat(held.mean_A, np.maximum(1, np.ceil(held.length_s / 0.01 - 1e-6)).astype(int))
    flows_A = row_A[:, None] * player.circuit.gain
    assert len(steps_s) == len(row_A)
    watts = np.maximum(0, flows_A * (player.circuit.alpha * hotter_K + player.circuit.ohm * flows_A))
    return np.abs(flows_A).max(axis=1), watts.max(axis=1)


Drawn = dict[str, list[tuple[Array, Array]]]


def all_drawn(made: Export) -> Drawn:
    """What each element takes in each icon."""
    rng, elements = np.random.default_rng(1), [channel.element for channel in made.channels]
    return {name: [drawn(alone(made.files, name), stem, rng) for stem in stems(made.files)] for name in elements}


def sums(takes: Drawn, late: int = 0) -> tuple[float, float]:
    """The most amperes and watts of both elements together in any icon, with the second late by so many rows."""
    most = [0.0, 0.0]
    for left, right in zip(*takes.values(), strict=True):
        for place, both in enumerate(zip(left, right, strict=True)):
            first, second = (np.tile(course, 2) for course in both)  # two plays without a pause
            begun, length = max(0, -late), len(first) + abs(late)
            shifted = [
                np.pad(course, (before, length - len(course) - before), mode="edge")
                for course, before in ((first, begun), (second, begun + late))
            ]
            most[place] = max(most[place], float((shifted[0] + shifted[1]).max()))
    return most[0], most[1]


@pytest.mark.parametrize("rig", [sure_rig(), Rig.load("thenar")], ids=["known", "unsure"])
def test_the_supply_is_judged_at_the_sums_of_the_independent_circuit(rig: Rig) -> None:
    icons = spatial(AT_ONCE)
    amperes, watts = sums(all_drawn(export(icons, pair(rig))))
    for share in (1.01, 0.99):
        for limits in ((share * amperes, 1000.0), (100.0, share * watts)):
            made = export(icons, pair(rig, supply=Supply(current_limit_A=limits[0], power_limit_W=limits[1])))
            assert bool(made.files) == (share > 1), (share, limits, made.refused)


def test_channels_as_late_as_is_allowed_keep_to_the_supply_and_later_ones_do_not() -> None:
    icons, rig = spatial(ONE_BEFORE_THE_OTHER), sure_rig()
    takes = all_drawn(export(icons, pair(rig)))
    one_A, two_A = sums(takes)[0], max(sums(takes, late)[0] for late in range(-400, 400, 5))
    limit_A = 0.5 * (one_A + two_A)
    made = export(icons, pair(rig, supply=Supply(current_limit_A=limit_A, power_limit_W=1000)))
    assert made.whole is not None and made.whole.offset_s and one_A < limit_A < two_A
    rows = round(100 * made.whole.offset_s)
    assert all(sums(takes, late)[0] <= limit_A for late in range(-rows, rows + 1))
    assert any(sums(takes, late)[0] > limit_A for late in range(-3 * rows, 3 * rows))
    told = sidecar_in(made.files, "x0")
    assert (told["clock"], told["largest_offset_s"]) == ("one", made.whole.offset_s)
    free = export(icons, pair(rig, supply=Supply(current_limit_A=1.01 * two_A, power_limit_W=1000)))
    assert free.whole is not None and free.whole.offset_s is None


@pytest.mark.parametrize(("warm_K", "safe"), [(5.4, True), (5.6, False)])
def test_displays_of_two_zones_keep_their_distance_at_any_offset(warm_K: float, safe: bool) -> None:
    warm, cool = (
        f"{way} °C at 9 °C/s; hold for 1 s; return at 9 °C/s" for way in (f"warm by {warm_K}", "cool by 14.5")
    )
    body = f"together {{ on left {{ {warm} }}; on right {{ {cool} }} }}"
    strip = Rig.load("tcs2").with_(**{"contact.area_cm2": 1.96})
    made, apart = (
        export(spatial(body), pair(strip, surfaces=where), None, "tcs2-serial") for where in ("one", "apart")
    )
    assert bool(made.files) == safe and apart.files
    left, right = (read_file(alone(apart.files, name), "x0") for name in ("left", "right"))
    assert (left.display_C.max() - right.display_C.min() < 20) == safe  # type: ignore[union-attr]
    assert left.display_C.max() == pytest.approx(32 + warm_K)  # type: ignore[union-attr]


def test_a_body_that_all_warm_at_once_stays_within_the_corner_that_is_judged() -> None:
    """Heat by the independent circuit into a body of one lump, in random plays without a pause for half an hour."""
    icons = spatial(AT_ONCE, "on all { cool by 5 °C at 3 °C/s; hold for 2 s; return at 3 °C/s }")
    module = {"seebeck_V_per_K": 0.0063, "resistance_ohm": 0.52, "thermal_resistance_K_per_W": 37.0}
    small = {"contact.area_cm2": 0.6, "module.hot_plate_J_per_K": 0.19, "module.cold_plate_J_per_K": 0.19}
    rig = Rig.load("fingertip").with_(**small, module=module, **{"heat_sink.temperature_C": 30})
    elements = tuple(Element(rig, name, (at, 0.0), "body") for name, at in (("left", 0.0), ("right", 0.2)))
    body = Sink(name="body", resistance_K_per_W=15.0, capacity_J_per_K=4.0)
    made = export(icons, Layout(elements, "pair", surfaces="one", sinks=(body,)), None, "setpoint-csv")
    assert made.files
    known_K = sidecar_in(made.files, "x0")["elements"][0]["safety"]["uncertainty"]["heat_sink_K"]
    allowed_K, heats = known_K - rig.uncertainty.heat_sink_K, []
    rng, sink = np.random.default_rng(2), rig.heat_sink
    for one in made.tracks:
        flow = one.delivery.delivered  # type: ignore[attr-defined]
        held = Held.of(flow.time_s, flow.current_A, flow.current_A**2)
        player = Player(sidecar_in(alone(made.files, "left"), "x0")["rig"]["document"], rng, 0)
        player.circuit = replace(player.circuit, gain=player.circuit.gain * 0 + 1.0)
        rows, steps_s, _ = player.play(held, player.rest(held))
        heats.append((steps_s, (rows[1:, 0, 3, 0] - sink.temperature_C) / sink.resistance_K_per_W))
    warmest_K = change_K = 0.0
    for _ in range(200):
        for step_s, heat in zip(*heats[rng.integers(len(heats))], strict=True):
            change_K += step_s * (heat - change_K / body.resistance_K_per_W) / (body.capacity_J_per_K or 1)
            warmest_K = max(warmest_K, abs(change_K))
    assert 0.2 * allowed_K < warmest_K <= allowed_K
    narrow = Sink(name="body", resistance_K_per_W=15.0 * 20 / known_K, capacity_J_per_K=4.0)
    with pytest.raises(InputError, match=r"20 K are judged; use a sink of .* K/W, smaller changes") as refused:
        export(icons, Layout(elements, "pair", surfaces="one", sinks=(narrow,)), None, "setpoint-csv")
    (enough,) = re.findall(r"a sink of (\S+) K/W", str(refused.value))
    obeyed = narrow.model_copy(update={"resistance_K_per_W": float(enough)})
    export(icons, Layout(elements, "pair", surfaces="one", sinks=(obeyed,)), None, "setpoint-csv")


@pytest.mark.parametrize("device", ["dac-16", "pwm-h-bridge-10"])
def test_currents_on_a_shared_sink_are_refused_with_a_cure(device: str) -> None:
    with pytest.raises(InputError, match=r"top, .* share the sink body.* closed-loop-controller .* sink of its own$"):
        export("calls", "ring-four", device)


def by_chance(number: int) -> Faults:
    """Single faults of each element of the first green export of a seed, with its own channel and with the other's."""
    for attempt in itertools.count():
        rng = np.random.default_rng([64, number, attempt])
        made = some_export(rng)
        if made is not None and made.files:
            break
    found, names = Faults(), [channel.element for channel in made.channels]
    own = {name: alone(made.files, name) for name in names}
    for name, other in itertools.product(names, names):
        here = {stem: sidecar_in(own[name], stem) for stem in stems(own[name])}
        files = dict(own[other])
        for stem, told in here.items():  # the other's drive on this rig
            changed = {
                **sidecar_in(own[other], stem),
                "rig": told["rig"],
                "hardware_must_prevent": told["hardware_must_prevent"],
            }
            files[f"{stem}.json"] = sidecar_text(changed)
        tried = faulted(files, stems(files), rng, LUMPS)
        tried.unsafe = [f"{number}.{attempt} {name} plays {other}: {each}" for each in tried.unsafe]
        found.add(tried)
    takes = all_drawn(made) if made.form.name == "csv" else {}
    supply = made.layout and made.layout.supply
    assert made.whole is not None and supply is not None
    allowed = 400 if made.whole.offset_s is None else round(100 * made.whole.offset_s)
    for late in rng.integers(-allowed, allowed + 1, 12) if takes else ():
        amperes, watts = sums(takes, int(late))
        if amperes > supply.current_limit_A * 1.002 or watts > supply.power_limit_W * 1.002:
            found.unsafe.append(f"{number}.{attempt} late by {late}: {amperes:.3f} A, {watts:.2f} W of {supply}")
    return found


def some_export(rng: np.random.Generator) -> Export | None:
    """Two elements by chance, alike or not, on a supply that may be too weak; None where they cannot be."""
    first = Rig.load(str(rng.choice(["thenar", "fingertip", "forearm"]))).with_(**{"skin.elements": [1] * 5})
    second = first if rng.random() < 0.5 else first.with_(**{"contact.area_cm2": float(rng.uniform(2, 12))})

    def body() -> str:
        way, size = ("warm", rng.uniform(0.5, 4)) if rng.random() < 0.5 else ("cool", rng.uniform(0.5, 6))
        hold_s, begin_s, (there, back) = rng.uniform(0.1, 1), rng.uniform(0.1, 1), rng.uniform(1, 4, 2)
        shape = f"{way} by {size:.2f} °C at {there:.2f} °C/s; hold for {hold_s:.2f} s; return at {back:.2f} °C/s"
        return f"rest for {begin_s:.2f} s; {shape}"

    icons = spatial(
        f"together {{ on left {{ {body()} }}; on right {{ {body()} }} }}",
        f"on left {{ {body()} }}; on right {{ {body()} }}",
    )
    supply = Supply(current_limit_A=float(rng.uniform(1, 4)), power_limit_W=float(rng.uniform(8, 45)))
    layout = pair(first, second, str(rng.choice(["one", "apart"])), supply)
    form = str(rng.choice(["csv", "csv", "setpoint-csv"]))
    try:
        return export(icons, layout, None, form)
    except InputError:
        return None


def test_no_single_fault_of_an_element_passes_a_limit() -> None:
    found = by_chance(1)
    assert not found.unsafe, "\n".join(found.unsafe)
    assert sum(found.tried.values()) > 500


@pytest.mark.slow
@pytest.mark.parametrize("number", range(2, 2 + EXPORTS))
def test_no_single_fault_of_any_export_passes_a_limit(number: int) -> None:
    found = by_chance(number)
    assert not found.unsafe, "\n".join(found.unsafe)
