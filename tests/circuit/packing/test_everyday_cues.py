"""Everyday cues on everything that is shipped: what is exported, what is refused and why, as docs/reference/refusals.md shows it.

``python tests/circuit/packing/test_everyday_cues.py`` writes the page anew (some minutes).
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import pytest

from thermicon.circuit import Device, Rig, device_names, prepare, rig_names
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import FormatError, format_names, load_format
from thermicon.icons import Icon, load_library, parse

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "refusals.md"
SETS = ("six-icons", "cooling-step-skin", "wave-confusions", "wave-shapes", "wilson-ramps", "pulse-sequences")
"""The shipped sets of published icons; the search space is no set that anybody played."""
STEPS = tuple(product(("skin", "display"), (-6, -3, 3, 6)))
MARKS = {"unsafe": "not safe", "unreachable": "not reached", "lossy": "loses"}
ORDINARY = (("thenar", "dac-16"), ("thenar", "pwm-h-bridge-10"), ("thenar", "qst-tcs2"), ("shani2021", "dac-16"))

HEAD = """# What is refused, and why

Written by `python tests/circuit/packing/test_everyday_cues.py`; do not edit by hand. Steps of ±3 and ±6 K at
3 K/s from 32 °C, held for 4 s and back at 3 K/s, are prepared for export on the rigs and devices below. With `--all`
the command takes every shipped rig with every device, and the shipped sets of published icons, which takes the better
part of an hour. What perception adds (detection, d′) is left out. *Yes* means exported; otherwise the first cause
stands there, and below with its numbers and cure.
"""


@dataclass(frozen=True, slots=True)
class Case:
    """One cue on one rig and device: its place in the tables, `yes` or the first cause, that in words, the forms."""

    rig: str
    device: str
    column: str
    cue: str
    mark: str
    why: str = ""
    forms: tuple[tuple[str, str], ...] = ()


def step_of(control: str, change: int) -> Icon:
    verb = "cool" if change < 0 else "warm"
    return parse(
        f"cue 1\nset s {{ control {control}\n baseline 32 °C }}\n"
        f"icon step {{ {verb} by {abs(change)} °C at 3 °C/s\n hold for 4 s\n return at 3 °C/s }}\n"
    )["step"]


def case_of(icon: Icon, rig: Rig, device: Device, column: str, cue: str, forms: Sequence[str]) -> Case:
    plain = next(name for name in format_names() if device.driven_by in load_format(name).takes)
    try:
        ready = prepare(icon, rig, device, load_format(plain))
    except DeviceError as problem:
        return Case(rig.name, device.name, column, cue, "cannot play", str(problem))
    if ready.refusals:
        first = ready.refusals[0]
        return Case(rig.name, device.name, column, cue, MARKS[first.kind], str(first))
    written = []
    for name in forms:
        form = load_format(name)
        if device.driven_by not in form.takes:
            continue
        try:
            form.write(ready.realised)
            written.append((name, ""))
        except FormatError as problem:
            written.append((name, str(problem)))
    return Case(rig.name, device.name, column, cue, "yes", forms=tuple(written))


def steps_on(rig_name: str, device_name: str) -> list[Case]:
    rig, device = Rig.load(rig_name), Device.load(device_name)
    return [case_of(step_of(*step), rig, device, column_of(*step), column_of(*step), format_names()) for step in STEPS]


def sets_on(rig_name: str, device_name: str) -> list[Case]:
    rig, device = Rig.load(rig_name), Device.load(device_name)
    return [
        case_of(icon, rig, device, name, f"{name}: {icon.name}", ()) for name in SETS for icon in load_library(name)
    ]


def everything_on(pair: tuple[str, str]) -> list[Case]:
    return [*steps_on(*pair), *sets_on(*pair)]


def column_of(control: str, change: int) -> str:
    return f"{control} {change:+d} K".replace("-", "−")


def row_of(rig: str, device: str, cases: Iterable[Case]) -> str:
    return f"| {rig} | {device} | " + " | ".join(case.mark for case in cases) + " |"


def page_of(cases: Sequence[Case]) -> str:
    """The page: steps, sets, forms, and every cause once with the devices and cues that it holds for."""
    tried = list(dict.fromkeys((case.rig, case.device) for case in cases))
    columns = [column_of(*step) for step in STEPS]
    lines = [HEAD, "## Steps", "", _head(("rig", "device", *columns))]
    lines += [row_of(*pair, [c for c in cases if (c.rig, c.device) == pair and c.column in columns]) for pair in tried]
    if any(case.column in SETS for case in cases):
        lines += ["", "## Published icons", "", "Exported of all, for each set.", "", _head(("rig", "device", *SETS))]
    for pair in tried if any(case.column in SETS for case in cases) else ():
        counts = [[c.mark == "yes" for c in cases if (c.rig, c.device) == pair and c.column == name] for name in SETS]
        cells = " | ".join(f"{sum(marks)} of {len(marks)}" for marks in counts)
        lines.append(f"| {pair[0]} | {pair[1]} | {cells} |")
    return "\n".join([*lines, "", *_forms(cases), "", *_causes(cases), ""])


def _head(names: Sequence[str]) -> str:
    return f"| {' | '.join(names)} |\n|{'---|' * len(names)}"


def _forms(cases: Sequence[Case]) -> list[str]:
    """Which forms take the steps that a device exports, and why others do not."""
    lines = ["## Formats", "", "The steps that are exported, written in every format that takes the device.", ""]
    lines.append(_head(("device", "format", "written", "why not")))
    for device in dict.fromkeys(case.device for case in cases):
        for name in format_names():
            said = [why for c in cases if c.device == device for form, why in c.forms if form == name]
            if said:
                why = next((text for text in said if text), "")
                lines.append(f"| {device} | {name} | {said.count('')} of {len(said)} | {why} |")
    return lines


def _causes(cases: Sequence[Case]) -> list[str]:
    lines = ["## Causes", ""]
    for rig in dict.fromkeys(case.rig for case in cases):
        lines += [f"### {rig}", ""]
        grouped: dict[str, dict[str, list[str]]] = {}
        for case in cases:
            if case.rig == rig and case.mark != "yes":
                why = case.why.replace(f"{case.device}: ", "").replace(case.device, "the device")
                grouped.setdefault(why, {}).setdefault(case.cue, []).append(case.device)
        for why, cues in grouped.items():
            devices = list(dict.fromkeys(name for names in cues.values() for name in names))
            lines.append(f"- {'; '.join(cues)} ({', '.join(devices)}): {why}")
        lines += [] if grouped else ["Nothing is refused."]
        lines.append("")
    return lines[:-1]


@pytest.mark.parametrize(("rig", "device"), ORDINARY)
def test_the_page_says_what_becomes_of_everyday_steps(rig: str, device: str) -> None:
    cases = steps_on(rig, device)
    text = PAGE.read_text("utf-8")
    assert row_of(rig, device, cases) in text.splitlines()
    for case in cases:
        if case.mark != "yes":  # digits may differ between machines
            why = case.why.replace(f"{device}: ", "").replace(device, "the device")
            assert re.sub(r"\d", "0", why) in re.sub(r"\d", "0", text)


@pytest.mark.parametrize(("rig", "device"), ORDINARY[:3])
def test_every_everyday_step_is_exported_on_the_default_rig(rig: str, device: str) -> None:
    marks = {case.column: case.mark for case in steps_on(rig, device)}
    if device.startswith("pwm"):  # heats with its peak: 42.02 °C in the worst of 65 corners, the limit is 42
        assert marks.pop("skin +6 K") == "not safe"
    assert set(marks.values()) == {"yes"}


def test_a_device_that_cannot_play_is_a_cause_like_any_other() -> None:
    warm = parse("cue 1\nset s { control display\n baseline 42 °C }\nicon step { warm by 1 °C at 1 °C/s }\n")["step"]
    case = case_of(warm, Rig.load("thenar"), Device.load("qst-tcs2"), "", "", ())
    assert (case.mark, case.why[:46]) == ("cannot play", "qst-tcs2: a baseline of 42 °C is beyond 20 … 4")


@pytest.mark.slow
def test_the_whole_page_is_up_to_date() -> None:
    fresh, text = page_of(everything()), PAGE.read_text("utf-8")
    assert re.sub(r"\d", "0", text) == re.sub(r"\d", "0", fresh)


def everything(all_of_it: bool = False) -> list[Case]:
    with ProcessPoolExecutor(max_workers=min(4, os.cpu_count() or 1)) as pool:
        if all_of_it:
            runs = pool.map(everything_on, product(rig_names(), device_names()))
        else:
            runs = pool.map(steps_on, *zip(*ORDINARY, strict=True))
        return [case for cases in runs for case in cases]


if __name__ == "__main__":
    PAGE.write_text(page_of(everything("--all" in sys.argv)), "utf-8")
