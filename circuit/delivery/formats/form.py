"""The interface of a drive file format."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from thermicon.base.files.inputs import InputError
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.installing import install
from thermicon.icons.model.corners import Corners

from ...safety.demands import Demands, How
from ...solver.inverse import baseline_C
from ...solver.steady import steady_state
from ..commands import Column
from ..delivered_drive import DeliveredDrive
from ..device import Device
from ..samples import Samples

PLAYS_SAMPLES = ("volts", "amperes", "duty")
PLAYS_TEMPERATURES = ("temperatures",)

STILL = 1e-9
"""A slope below this, in K/s or A/s, counts as level."""
LONGEST_NAME = 200
"""Bytes of a file's name: disks take 255, and drafts, sidecars and suffixes need some of them."""
DEVICES_OF_WINDOWS = frozenset(
    {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(10))}
)


class FormatError(InputError):
    """A drive that cannot be written in a format; the text says why and what to use instead."""


@dataclass(frozen=True, slots=True)
class Event:
    """A prescription of the cue at a time in s; `level` in the unit of its corners (°C or A)."""

    name: str
    time_s: float
    level: float


@dataclass(frozen=True, slots=True)
class Played:
    """One drive of an export, its files, and the verdict on repetition; times in s are None where there are none.

    `content`: the bytes of the drive file, by which a player knows it again.
    """

    delivery: DeliveredDrive
    file: str
    sidecar: str
    safety: str = ""
    recovery_s: float | None = None
    shortest_pause_s: float | None = None
    content: bytes = b""

    @property
    def verdict(self) -> str:
        """The verdict in a line of plain ASCII."""
        back = "not within 10 min" if self.recovery_s is None else f"after {self.recovery_s:g} s"
        pause = "none" if self.shortest_pause_s is None else f"{self.shortest_pause_s:g} s"
        return f"safety {self.safety or 'not judged'}, back at rest {back}, shortest safe pause {pause}"


class OneFile(NamedTuple):
    """How several elements are in one file: its bytes, its columns, and what of it is each element's, also in words."""

    write: Callable[[Sequence[DeliveredDrive]], bytes]
    columns: Callable[[Sequence[DeliveredDrive]], tuple[Column, ...]]
    channels: Callable[[Sequence[DeliveredDrive]], tuple[object, ...]]
    told: str = "the columns of an element begin with its name"


ElementsPlayer = Callable[[Mapping[str, Sequence[Played]], Mapping[str, Demands], float | None], dict[str, bytes]]


@dataclass(frozen=True, slots=True)
class Format:
    """One kind of file: what it is called, which devices take it, where its layout is documented, and how to write it.

    `device` is used where none is named; `stem` makes the file's name from the icon's, `suffix_by` the suffix where it
    depends on the device; `how` explains how to play it. `write` gives the bytes of one drive, `columns` what is in
    them, `facts` further facts for the sidecar. `player` gives the files of the whole set, named in
    `set_files`, from all its drives and what the hardware must prevent; it `holds` some of these demands while it plays
    and `proves` others before it does. `needs` is the package that writes it, `fits` raises FormatError for a device
    that it has no use for. `together`: how one file holds several elements; None: each has a file of its own.
    `elements_player` gives the files of a set on several elements, from the drives and demands of each by name and the
    largest offset in s that the verdict allows.
    """

    name: str
    title: str
    suffix: str
    takes: tuple[str, ...]
    device: str
    source: str
    how: str
    write: Callable[[DeliveredDrive], bytes]
    columns: Callable[[DeliveredDrive], tuple[Column, ...]]
    stem: Callable[[str], str] = str
    suffix_by: Callable[[DeliveredDrive], str] | None = None
    facts: Callable[[DeliveredDrive], dict[str, object]] | None = None
    player: Callable[[Sequence[Played], Demands], dict[str, bytes]] | None = None
    set_files: tuple[str, ...] = ()
    holds: tuple[str, ...] = ()
    proves: tuple[str, ...] = ()
    needs: str = ""
    fits: Callable[[Device], None] | None = None
    together: OneFile | None = None
    elements_player: ElementsPlayer | None = None

    def __repr__(self) -> str:
        return f"Format({self.name!r}, *{self.suffix}, for {', '.join(self.takes)})"

    def file_name(self, delivery: DeliveredDrive) -> str:
        """Name of the file of a drive."""
        suffix = self.suffix if self.suffix_by is None else self.suffix_by(delivery)
        return check_name(self.stem(delivery.icon.name) + suffix)

    def met(self, demands: Demands) -> dict[str, How]:
        """How each demand is met: by the player of this format, else by a person, who has to state it."""
        how: dict[str, How] = {}
        for name in demands.demanded:
            how[name] = "held" if name in self.holds else "proven" if name in self.proves else "stated"
        if demands.loop is None and "current_limit_A" in how:
            how["current_limit_A"] = "stated"  # of the driver itself, which no player reaches
        return how

    def check(self, device: Device) -> None:
        """Raise FormatError where a device does not play what this format holds, or its package is not installed."""
        if device.driven_by not in self.takes:
            raise FormatError(
                f"{self.name} is for devices driven by {' or '.join(self.takes)}; {device.name} is driven by "
                f"{device.driven_by}: use {self.device}, or another format"
            )
        if self.fits is not None:
            self.fits(device)
        if self.needs and find_spec(self.needs.lower()) is None:
            raise FormatError(f"{self.name} needs {self.needs}, which is not installed: {install(self.needs)}")


def check_name(name: str) -> str:
    """Return a file name that every file system accepts; FormatError for one too long or reserved by Windows."""
    if len(name.encode("utf-8")) > LONGEST_NAME:
        raise FormatError(
            f"{name[:40]}…: a file's name has at most {LONGEST_NAME} bytes, this one {len(name.encode('utf-8'))}; give "
            f"the icon a shorter name"
        )
    if name.partition(".")[0].casefold() in DEVICES_OF_WINDOWS:
        raise FormatError(f"{name}: Windows keeps the name {name.partition('.')[0]} for a device; rename the icon")
    return name


def samples_of(delivery: DeliveredDrive) -> Samples:
    """The samples of a drive whose device plays samples."""
    assert isinstance(delivery.played, Samples)
    return delivery.played


def on_one_clock(deliveries: Sequence[DeliveredDrive]) -> list[Samples]:
    """The samples of elements that are played together, all as long as the longest; FormatError for unlike rates."""
    samples = [samples_of(each) for each in deliveries]
    rates = {each.rate_Hz: one.element for each, one in zip(samples, deliveries, strict=True)}
    if len(rates) > 1:
        told = ", ".join(f"{element} {rate:g} Hz" for rate, element in rates.items())
        raise FormatError(f"elements are played on one clock, and have several ({told}); give all one driver.update_Hz")
    longest = max(len(each.codes) for each in samples)
    return [each.until((longest - 1) / each.rate_Hz) for each in samples]


def course_C(delivery: DeliveredDrive, every_s: float) -> Array:
    """The predicted display in °C at regular times in s of the file, and once after its end."""
    trace = delivery.trace
    times = every_s * np.arange(2 + int(delivery.end_s / every_s))
    course: Array = np.interp(times, trace.time_s, trace.display_C)
    return course


def events_in(delivery: DeliveredDrive) -> tuple[Event, ...]:
    """Events of the cue on the clock of its file: files of samples begin with one update of rest, set-points do not."""
    icon, rig = delivery.icon, delivery.rig
    base = baseline_C(icon, rig)
    start = steady_state(rig, "display", base)[0] if icon.context.control == "current" else base
    return events_of(icon.corners(start), delivery.lead_s)


def events_of(corners: Corners, lead_s: float = 0.0) -> tuple[Event, ...]:
    """Events of a cue that begins at `lead_s`: start and end of every stretch that rises, falls, or is a return."""
    points = list(zip(corners.time_s, corners.value, strict=True))
    rest = corners.value[0]
    steps = [(_direction(a, b), a, b) for a, b in pairwise(points)]
    events: list[Event] = []
    for direction, stretch in groupby(steps, key=lambda step: step[0]):
        pieces = list(stretch)
        (begin, from_), (end, to) = pieces[0][1], pieces[-1][2]
        if direction:
            back = abs(to - rest) < 1e-9
            events.append(Event("return start" if back else "ramp start", lead_s + begin, from_))
            events.append(Event("baseline reached" if back else "target reached", lead_s + end, to))
    return (*events, Event("end", lead_s + corners.duration_s, corners.value[-1]))


def _direction(a: tuple[float, float], b: tuple[float, float]) -> int:
    slope = (b[1] - a[1]) / (b[0] - a[0])
    return 0 if abs(slope) < STILL else 1 if slope > 0 else -1
