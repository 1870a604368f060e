"""Set the observer's parameters, on the records marked `calibrate` and on nothing else.

Records marked `assumed` enter with their intervals; records marked `predict` are never read. The
constants of the second receptor model are those published for it, taken over as `reference`.
`python -m thermicon.perception.validation.calibrate` writes the shipped file again.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from thermicon.circuit.records import Record, RecordError, Table, dump_records

from ..identification.rate_task import gain_strength, memory_noise, memory_record, with_gain
from ..observer.channels import CHANNELS, NORMS
from ..observer.observer import DATA, Observer, load_thresholds
from ..observer.variants import VARIANTS, Model, Variable, drive_unit, source_of
from ..sensation.detection import criterion_of
from ..sensation.fits import SITE, neutral_flux, threshold_drive, with_unit_drives, wrist_factor
from ..sensation.sensation import amplitude_jnd

DIGITS = 4
MODEL_CONSTANTS = ("static gain", "dynamic gain", "window of counted impulses", "start of static discharge")
COMMENT = """Constants of the nominal observer, written by `python -m thermicon.perception.validation.calibrate`.
Set on the records marked `calibrate` in thresholds.toml; `use = "assumed"` has no data behind it.
low and high are what the data or the assumption allow; nothing here was set on a predicted record.
Numbers `from heat flow` and `from impulses` are those of the other variants, set by the same steps.
Written by a program: change thresholds.toml and run it again."""


def calibrate(thresholds: Table | None = None) -> Table:
    """Records of the calibrated observer and its variants, from the shipped table or another one like it."""
    table = load_thresholds() if thresholds is None else thresholds
    known = _usable(table)
    shared = (
        *_taken_over(known),
        *_model_constants(table),
        *(neutral_flux(known, channel) for channel in CHANNELS),
        _slope(known),
        _criterion(known),
    )
    own = [record for variant in VARIANTS for record in _variant(known, shared, *variant)]
    return Table("observer.toml", tuple(_rounded(r) for r in (*shared, *own)))


def _variant(known: Table, shared: tuple[Record, ...], variable: Variable, model: Model) -> list[Record]:
    """Records that depend on the sensory variable and the receptor model, each after those that it needs."""
    draft = Observer.from_table(Table("draft", (*shared, *_unset(variable, model))), variable=variable, model=model)
    strength = [gain_strength(known, draft)] if model == "adapting" else []
    person = with_unit_drives(known, with_gain(draft, strength[0].central) if strength else draft)
    return [
        *strength,
        *(threshold_drive(known, channel, person) for channel in CHANNELS),
        *(wrist_factor(known, channel, person) for channel in CHANNELS),
        *memory_noise(known, person),
    ]


def to_toml(observer: Table) -> str:
    """Text of the parameter file, the same bytes for the same records."""
    return dump_records(observer, comment=COMMENT)


def _usable(table: Table) -> Table:
    return Table(table.name, tuple(r for r in table if r.use in ("calibrate", "assumed")))


def _model_constants(table: Table) -> tuple[Record, ...]:
    """Constants of the Ring & de Dear type, as published for it."""
    published = Table(table.name, tuple(r for r in table if r.use == "reference"))
    return tuple(record for quantity in MODEL_CONSTANTS for record in published.select(quantity))


def _taken_over(known: Table) -> tuple[Record, ...]:
    """Records that enter as they are, under the observer's own names."""
    fast = "fast adaptation"
    low, high = known.one("complete adaptation").interval
    zone = known.one("complete adaptation")
    return (
        replace(known.one("integration time constant"), quantity="integration time constant"),
        *(replace(known.one("adaptation time constant", channel=c), quantity="slow adaptation time constant")
          for c in CHANNELS),
        known.one(f"{fast} time constant"),
        known.one(f"{fast} weight"),
        known.one("gain control time constant"),
        known.one("gain control scale"),
        replace(zone, quantity="neutral zone", low=low, high=high),
        *(_area_exponent(known.one("area exponent at threshold", channel=c)) for c in CHANNELS),
        replace(known.one("thermode area of the forced-choice thresholds"), quantity="reference area"),
        known.one("noise correlation time"),
        *(known.one("conduction velocity", channel=c, site="leg") for c in CHANNELS),
        *(known.one("path length to the cord", site=s) for s in ("hand", "forearm")),
        replace(known.one("decision and motor time"), quantity="decision time"),
        known.one("onset uncertainty"),
        known.one("lapse rate"),
    )  # fmt: skip


def _area_exponent(record: Record) -> Record:
    return replace(record, quantity="area exponent", value=record.central)


def _criterion(known: Table) -> Record:
    """Criterion whose false alarms are as rare as assumed; the interval takes both assumptions to their ends."""
    rate = known.one("false-alarm rate of a cautious criterion")
    tau = known.one("noise correlation time")
    wait = known.one("wait of a cautious observer").central
    found = [criterion_of(r, t, wait) for r, t in itertools.product(rate.interval, tau.interval)]
    return Record(
        quantity="criterion",
        unit="d′",
        source=f"computed from the false-alarm rate ({rate.source}) and the noise correlation time ({tau.source})",
        value=criterion_of(rate.central, tau.central, wait),
        low=min(found),
        high=max(found),
        channel="both",
        method="Rice's rate of upward crossings, two channels",
        conditions=f"false alarms {rate.central:g} in {wait:g} s",
        confidence="low",
        use="assumed",
    )


def _slope(known: Table) -> Record:
    """Slope whose amplitude thresholds all lie in the published bands; the middle of the logs is taken."""
    pedestals = np.linspace(*known.one("pedestal of the amplitude difference").interval, 13)
    grid = np.geomspace(1.0, 100.0, 2001)
    allowed = np.ones(grid.size, dtype=bool)
    sources = []
    for channel in CHANNELS:
        band = known.one("amplitude difference threshold", channel=channel)
        threshold = known.one("detection threshold", channel=channel, site=SITE).central
        sources.append(band.source)
        low, high = band.interval
        for k, a in enumerate(grid):
            jnds = [threshold * amplitude_jnd(float(p), float(a)) for p in pedestals]
            allowed[k] &= low <= min(jnds) and max(jnds) <= high
    if not allowed.any():
        raise RecordError(f"{known.name}: no slope of sensation gives the amplitude difference thresholds: check them")
    span = grid[allowed]
    return Record(
        quantity="slope of sensation",
        unit="1",
        source="calibrated on amplitude difference thresholds: " + "; ".join(sources),
        value=math.sqrt(float(span[0] * span[-1])),
        low=float(span[0]),
        high=float(span[-1]),
        channel="both",
        site=SITE,
        method="interval of slopes that keep both bands; geometric middle",
        conditions=f"pedestals {pedestals[0]:g} to {pedestals[-1]:g} times the threshold (assumed)",
        confidence="low",
        use="calibrate",
    )


def _unset(variable: Variable, model: Model) -> list[Record]:
    """What a draft of an observer needs before it is calibrated."""
    variant, unit, source = source_of(variable, model), drive_unit(variable, model), "not calibrated yet"
    return [
        Record(f"gain control strength{variant}", "1", source, value=0.0),
        *(Record(f"drive of a threshold step{variant}", unit, source, value=1.0, channel=c) for c in CHANNELS),
        *(Record(f"threshold at the wrist{variant}", "1", source, value=1.0, channel=c) for c in CHANNELS),
        *(replace(memory_record(norm, None, 0.0, 0.0, 0.0), quantity=f"memory noise{variant}") for norm in NORMS),
    ]


def _rounded(record: Record) -> Record:
    def short(number: float | None) -> float | None:
        return None if number is None else float(f"{number:.{DIGITS}g}")

    return replace(record, value=short(record.value), low=short(record.low), high=short(record.high))


def main() -> None:
    """Write the parameter file of the package."""
    (DATA / "observer.toml").write_text(to_toml(calibrate()), encoding="utf-8")


if __name__ == "__main__":
    main()
