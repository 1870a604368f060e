"""The result of a fit."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermicon.base.files.atomic import OutputError, complete_or_absent
from thermicon.base.files.inputs import LONGEST_NAME
from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.program import own_version
from thermicon.base.results.drawn import Tabled

from ..rig.rig import Rig
from ..rig.settings import toml_text
from ..rig.uncertainty import Uncertainty
from .identify import FittedParameter
from .keys import FitError, FitKey
from .overlay import OverlaidColumn
from .problem import OFFSET_SD_K, FitProblem

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True, eq=False)
class ChannelFit(OverlaidColumn):
    """A measured column of a `file` beside the fitted rig, with the sensor's `offset_K`; `unit` of a difference."""

    run: str
    file: str
    unit: str
    offset_K: float


@dataclass(frozen=True, slots=True, eq=False)
class RigFit(Tabled):
    """A rig fitted to logs, with the intervals in its uncertainty, and the layers of the skin that was logged.

    Layers keep their thickness, and what was not identified stays as it was before. `parameters` are the free keys in
    the order in which they were named, `correlation` (keys, keys) is that of the fitted numbers; `sources` are name and
    SHA-256 of every log, `notes` sentences on columns, clocks, sensors and the fit. `converged`: it came to rest.
    `misfit`: residuals exceed the noise of the logs, or a sensor is off by more than 3 standard deviations; the
    uncertainty of `rig` is then never narrower than before. `fitted_layers` names the layers that were fitted along;
    intervals hold for sensors that are off by `offset_sd_K` (SD).
    """

    rig: Rig
    parameters: tuple[FittedParameter, ...]
    correlation: Array
    channels: tuple[ChannelFit, ...]
    sources: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    converged: bool
    misfit: bool = False
    fitted_layers: tuple[str, ...] = ()
    offset_sd_K: float = OFFSET_SD_K

    def __repr__(self) -> str:
        parts = [f"{item.key} = {item.value:.4g} {item.unit} {item.interval}" for item in self.parameters]
        return f"RigFit({self.rig.name}: {', '.join(parts)})"

    def __getitem__(self, key: str) -> FittedParameter:
        """The parameter of a key; raises KeyError with the keys there are."""
        fitted = {item.key: item for item in self.parameters}
        if key not in fitted:
            raise KeyError(f"{key} was not fitted; fitted were {', '.join(fitted)}")
        return fitted[key]

    @property
    def unidentified(self) -> tuple[FittedParameter, ...]:
        """Parameters that the logs do not identify, each with the measurement that would."""
        return tuple(item for item in self.parameters if not item.identified)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per parameter: key, unit, start, value, low, high, identified, cure."""
        import pandas as pd

        names = ("key", "unit", "start", "value", "low", "high", "identified", "cure")
        return pd.DataFrame([{name: getattr(item, name) for name in names} for item in self.parameters])

    def plot(self, ax: Axes | None = None, column: str | None = None) -> Axes:
        """Draw the residuals of every column, or of one, in K (voltages in V) against time; returns the Axes."""
        from .fit_figure import plot_residuals

        return plot_residuals([each for each in self.channels if column in (None, each.column)], ax)

    def rig_text(self, name: str) -> str:
        """Return the rig file of the fitted rig, every fitted value with interval and logs, under a name."""
        document: dict[str, Any] = json.loads(self.rig.document)
        document["name"] = name
        origin, by, logs = document.setdefault("source", {}), f"thermicon {own_version()}", named(self.sources)
        for item in self.parameters:
            text = (
                f"fitted by {by}: {item.value:.6g} {item.unit}, 95 % {item.low:.6g} to {item.high:.6g}, before "
                f"{item.start:.6g}; log {logs}"
            )
            if not item.identified:
                earlier = f"{origin[item.key]}; " if item.key in origin else ""
                kept = f"kept at {item.start:.6g} {item.unit}: not identified by these logs, {by}; log {logs}"
                text = earlier + kept
            origin[item.key] = text
        for layer in self.fitted_layers:
            place, how = f"skin.layer.{layer}", "fitted along at this thickness, within the spread between people"
            origin[place] = f"{origin.get(place, '')}; {how}, by {by}; log {logs}".lstrip("; ")
        free = ", ".join(item.key for item in self.parameters if item.identified) or "nothing"
        digests = "; ".join(f"{log} sha256 {digest}" for log, digest in self.sources)
        note = f"fitted: {free}; logs {digests}; {by}. {MISFIT if self.misfit else HOLDS}"
        earlier_notes = [each for each in document.get("notes", []) if not each.startswith("fitted:")]
        document["notes"] = [*earlier_notes, note]
        return toml_text(document)

    def save(self, path: str | Path) -> None:
        """Write the fitted rig to a `.toml` file, by that file's name; FitError for a path that cannot be."""
        where = Path(path)
        if where.suffix != ".toml":
            raise FitError(f"{where}: the name of a rig file ends in .toml; call it {where.name}.toml")
        try:
            with complete_or_absent(where) as draft:
                draft.write_text(self.rig_text(where.stem[:LONGEST_NAME]), encoding="utf-8")
        except OutputError as problem:
            raise FitError(str(problem)) from None


def channel_fits(problem: FitProblem, theta: Array) -> tuple[ChannelFit, ...]:
    """Return every channel beside the simulation at a point, on the clock of its run's drive."""
    found = problem.simulated(theta)
    fits = []
    for r, c, channel in problem.channels():
        inside = problem.inside(theta, r, channel)
        measured = channel.values[inside]
        fitted = problem.modelled(theta, r, c, found[r])[inside]
        time, offset = problem.run_time_s(theta, r, channel)[inside], problem.nuisance(theta, "offset", r, c)
        unit, run = "K" if channel.temperature else "V", problem.runs[r].name
        fits.append(ChannelFit(channel.column, time, measured, fitted, run, channel.file, unit, offset))
    return tuple(fits)


DIGEST_DIGITS = 16
PLATES = ("module.hot_plate_J_per_K", "module.cold_plate_J_per_K")
MISFIT = (
    "Rig and logs do not agree, so that the intervals cannot be trusted: [uncertainty] is as wide as before the fit, "
    "or wider."
)
HOLDS = "The intervals hold for the person, the contact and the room of these logs."
LEAST_SHARE = 0.5
"""Share of the shipped uncertainty that is written at least: what a fit holds fixed, the heat sink above all, may bias
it by more than its interval says, and the safety gate relies on it."""

_SHIPPED = Uncertainty()
LARGEST = {
    name: float(schema["maximum"])
    for name, schema in Uncertainty.model_json_schema()["properties"].items()
    if name != "reason"
}
"""The largest uncertainty that a rig file may state."""


def uncertainties(
    keys: Sequence[FitKey],
    parameters: Sequence[FittedParameter],
    *,
    before: Uncertainty,
    misfit: bool = False,
) -> dict[str, float]:
    """Half widths for [uncertainty] of what was identified; for both plates the wider, or nothing where one is lacking.

    After a `misfit`, and for what was not identified, only what must be wider than `before`.
    """
    stated: dict[str, float] = {}
    identified = {item.key for item in parameters if item.identified}
    for key, item in zip(keys, parameters, strict=True):
        if not key.uncertainty:
            continue
        held = getattr(before, key.uncertainty)
        if misfit or not item.identified:
            width = min(_rounded_up(_covering(item, held)), LARGEST[key.uncertainty])
            if width > held:
                stated[key.uncertainty] = max(width, stated.get(key.uncertainty, 0.0))
            continue
        if key.key in PLATES and not set(PLATES) <= identified:
            continue
        least = LEAST_SHARE * getattr(_SHIPPED, key.uncertainty)
        width = min(max(least, _rounded_up(item.half_width)), LARGEST[key.uncertainty])
        stated[key.uncertainty] = max(width, stated.get(key.uncertainty, 0.0))
    return stated


def _covering(item: FittedParameter, before: float) -> float:
    """Half width that holds the fitted interval and the one before; the value alone where the interval says nothing."""
    if not item.identified and item.half_width > before:
        return abs(item.value - item.start) / (item.start if item.log else 1.0)
    ends = before * item.start if item.log else before
    low, high = min(item.low, item.start - ends), max(item.high, item.start + ends)
    most = max(high - item.value, item.value - low)
    return most / item.value if item.log else most


def reason_of(rig: Rig, sources: Sequence[tuple[str, str]]) -> str:
    """Return the reason why a fitted rig's uncertainty is smaller than the shipped one."""
    before = f"{rig.uncertainty.reason}; " if rig.uncertainty.reason else ""
    return f"{before}95 % intervals of a fit by thermicon {own_version()} to {named(sources)}"


def named(sources: Sequence[tuple[str, str]]) -> str:
    """Logs with the beginning of their digests."""
    return ", ".join(f"{name} (sha256 {digest[:DIGEST_DIGITS] or 'not from a file'})" for name, digest in sources)


def _rounded_up(value: float) -> float:
    """Two significant digits, never less than the value."""
    digits = 1 - math.floor(math.log10(value)) if value > 0 else 2
    scale = 10.0**digits
    return float(round(math.ceil(value * scale - 1e-9) / scale, digits))
