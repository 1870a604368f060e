"""Random rigs, devices, cues and pauses near or far beyond the limits, as attacks on the gate."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.circuit.delivery.one_drive import Judge, icon_of, prepare
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.prepare import Prepared, prepare_set
from thermicon.circuit.rig.rigfile import RigError
from thermicon.icons import CueErrors, Icon

BASES = ("thenar", "shani2021", "fingertip", "forearm", "hand-dorsum")
WAYS = (
    ("dac-12", "csv"), ("dac-14", "csv"), ("dac-16", "csv"), ("coarse", "csv"), ("coarse", "csv"),
    ("coarse", "c-array"),
    ("ni-analogue-output", "tdms"), ("ni-analogue-output", "psychopy"), ("dac-16", "csv"), ("dac-12", "c-array"),
    ("dac-16", "tdms"), ("dac-14", "psychopy"),
    ("qst-tcs2", "tcs2-serial"), ("qst-tcs2", "tcs2-serial"),
    ("qst-tcs2", "tcs2-serial"), ("qst-tcs2", "psychopy"),
    ("closed-loop-controller", "setpoint-csv"), ("closed-loop-controller", "psychopy"),
)  # fmt: skip
SLOW = (("dc-coupled-audio", "wav"), ("pwm-h-bridge-10", "csv"), ("pwm-h-bridge-10", "c-array"))
SHARE_OF_SLOW = 0.02
"""15,625 cycles a second cost the gate 2 to 9 s a drive."""
LOOPS = ("qst-tcs2", "closed-loop-controller")
SHARE_OF_SETS, SHARE_OF_FINE_MESHES = 0.05, 0.04


@dataclass(frozen=True)
class Case:
    """What was judged: one cue or a set, its pause as asked for, and where it came from."""

    ready: tuple[Prepared, ...]
    form: str
    pause_s: float | None
    number: int

    def __repr__(self) -> str:
        one = self.ready[0].delivery
        cues = " ".join(" ".join(str(each.delivery.icon).split()) for each in self.ready)
        changes = ", ".join(one.rig.changes)
        where = f"{one.rig.name} with {changes} | {one.device.name} as {self.form}"
        return f"#{self.number} {cues} | {where} | pause {self.pause_s}"


def between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(f"{rng.uniform(low, high):.4g}")


def some_rig(rng: np.random.Generator, device: str) -> Rig:
    if device == "qst-tcs2" and rng.random() < 0.5:
        return Rig.load("tcs2").with_(**{
            "contact.area_cm2": between(rng, 4, 16), "contact.resistance_m2K_per_W": between(rng, 1e-4, 2e-3),
        })  # fmt: skip
    base = Rig.load(str(rng.choice(BASES)))
    changes: dict[str, object] = {
        "heat_sink.temperature_C": between(rng, 15, 46),
        "heat_sink.resistance_K_per_W": between(rng, 0.05, 0.8),
        "module.cold_plate_J_per_K": between(rng, 1.0, 8),
        "module.hot_plate_J_per_K": between(rng, 1.0, 8),
        "module.seebeck_V_per_K": between(rng, 0.02, 0.07),
        "contact.area_cm2": between(rng, 2, 20),
        "contact.resistance_m2K_per_W": between(rng, 1e-4, 3e-3),
        "driver.current_limit_A": between(rng, 0.5, 2),
        "driver.update_Hz": float(rng.choice([10, 20] if device in LOOPS else [10, 20, 25, 50, 100])),
    }
    if rng.random() < 0.3:
        del changes["heat_sink.temperature_C"], changes["module.seebeck_V_per_K"]
    if rng.random() > SHARE_OF_FINE_MESHES:
        layers = len(base.skin.layers)
        changes["skin.elements"] = [1, 5] if layers == 2 else [1] * layers
    else:
        changes["uncertainty.plates_relative"] = changes["uncertainty.conductance_relative"] = 0.0
        changes["uncertainty.reason"] = "a rig made up by chance, whose module was measured"
    kind = rng.random()
    if kind < 0.15:
        changes["uncertainty.contact_resistance_relative"] = between(rng, 0.3, 0.6)
        changes["uncertainty.gain_relative"] = between(rng, 0.1, 0.25)
        changes["uncertainty.heat_sink_K"] = between(rng, 1, 4)
    elif kind < 0.35:
        for key in ("contact_resistance_relative", "gain_relative", "seebeck_relative", "plates_relative", "ambient_K"):
            if rng.random() < 0.6:
                changes[f"uncertainty.{key}"] = 0.0
        changes["uncertainty.reason"] = "a rig made up by chance, whose parts were measured"
    return base.with_(**changes)


def some_device(rng: np.random.Generator, name: str, folder: Path) -> Device:
    """A shipped device, or a coarse and slow one of its own."""
    if name != "coarse":
        return Device.load(name)
    bits, rate = int(rng.integers(5, 10)), int(rng.choice([7, 10, 15, 40]))
    path = folder / f"coarse-{bits}-{rate}.toml"
    path.write_text(
        f'format = 1\nname = "{path.stem}"\ntitle = "coarse and slow"\ndriven_by = "volts"\n'
        f'codes = "two\'s complement"\nstreams = true\nplayed = false\nnote = "made up"\n'
        + "".join(
            f'[[record]]\nquantity = "{what}"\nunit = "{unit}"\n{value}\nsource = "made up for a test"\n'
            for what, unit, value in (
                ("output range", "V", "low = -10.0\nhigh = 10.0"),
                ("resolution", "bit", f"value = {bits}"),
                ("update rate", "Hz", f"low = 1\nhigh = {rate}"),
            )
        ),
        encoding="utf-8",
    )
    return Device.load(path)


def hold_s(rng: np.random.Generator) -> float:
    return between(rng, 8, 40) if rng.random() < 0.08 else between(rng, 0.05, 3)


def some_cue(rng: np.random.Generator, device: str, name: str = "a") -> Icon:
    current = device not in LOOPS and rng.random() < 0.5
    if current:
        return icon_of(currents(rng), "current", name=name)
    control = "display" if rng.random() < 0.6 else "skin"
    base = f"{rng.uniform(29, 35):.1f}"
    way = "cool" if rng.random() < 0.5 else "warm"
    size = rng.uniform(0.5, 12) if way == "cool" else rng.uniform(0.3, 8)
    rate = float(np.exp(rng.uniform(np.log(0.5), np.log(30))))
    kind = rng.random()
    if kind < 0.6:
        shape = f"{way} by {size:.2f} °C at {rate:.2f} °C/s; hold for {hold_s(rng):.3g} s"
        shape += f"; return at {rng.uniform(0.5, 6):.2f} °C/s" if rng.random() < 0.85 else ""
    elif kind < 0.75:
        period = float(rng.choice([0.013, 0.07, 0.09, 0.11, 0.3, 1.0]))
        wave = str(rng.choice(["sine", "triangle", "square", "sawtooth"]))
        shape = f"{wave} by {size / 4:.2f} °C every {period:g} s for {period * rng.integers(2, 12):.4g} s"
    elif kind < 0.9:
        gap = hold_s(rng) / 3
        shape = f"repeat {rng.integers(2, 5)} {{ pulse {way} by {size / 2:.2f} °C "
        shape += f"for {rng.uniform(0.03, 1.5):.3f} s; hold for {max(0.05, gap):.3g} s }}"
    else:
        other = "warm" if way == "cool" else "cool"
        shape = f"step {way} by {size / 2:.2f} °C; hold for {hold_s(rng):.3g} s; "
        shape += f"{other} by {size / 3:.2f} °C at 2 °C/s; hold for {rng.uniform(0.1, 2):.2f} s"
    return icon_of(shape, control, base, name)


def currents(rng: np.random.Generator) -> str:
    """A course of currents: steps, ramps and waves about a bias, which may end anywhere."""
    wide, bias = float(np.exp(rng.uniform(np.log(0.05), np.log(1.6)))), between(rng, -0.15, 0.25)
    kind = rng.random()
    if kind < 0.25:
        period = float(rng.choice([0.013, 0.04, 0.07, 0.11, 0.3]))
        wave = str(rng.choice(["square", "triangle", "sine", "sawtooth"]))
        way = str(rng.choice(["up", "down"]))
        course = f"{wave} by {wide:.3f} A every {period:g} s for {period * 10:.3g} s starting {way}"
        return f"step to {bias:.3f} A; {course}; step to 0.05 A"
    parts = [f"step to {bias + rng.uniform(-wide, wide):.3f} A; hold for {hold_s(rng):.3g} s"]
    for _ in range(int(rng.integers(0, 4))):
        goal = bias + rng.uniform(-wide, wide)
        move = f"step to {goal:.3f} A" if rng.random() < 0.8 else f"to {goal:.3f} A over {rng.uniform(0.1, 0.6):.2f} s"
        parts.append(f"{move}; hold for {hold_s(rng):.3g} s")
    return "; ".join(parts)


def some_pause(rng: np.random.Generator) -> float | None:
    kind = rng.random()
    if kind < 0.4:
        return None
    return 0.0 if kind < 0.5 else float(round(np.exp(rng.uniform(np.log(0.3), np.log(400))), 1))


def some_case(rng: np.random.Generator, number: int, folder: Path, gate: Judge | None = None) -> Case | None:
    """A case by chance; None for one that the rig or the device cannot have at all."""
    ways = SLOW if rng.random() < SHARE_OF_SLOW else WAYS
    device_name, form_name = ways[rng.integers(len(ways))]
    try:
        rig, device, form = some_rig(rng, device_name), some_device(rng, device_name, folder), load_format(form_name)
        several = rng.random() < SHARE_OF_SETS
        icons: Sequence[Icon] = [some_cue(rng, device_name, name) for name in (("a", "b") if several else ("a",))]
        pause = some_pause(rng)
        if several and gate is None:
            ready = prepare_set(icons, rig, device, form, pause_s=pause)
        else:
            ready = (prepare(icons[0], rig, device, form, pause_s=pause, gate=gate),)
    except (RigError, DeviceError, CueErrors):
        return None
    return Case(ready, form_name, pause, number)
