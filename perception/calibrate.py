"""Set the observer's parameters, on the records marked `calibrate` and on nothing else.

Records marked `assumed` enter with their intervals; records marked `predict` are never read.
`python -m thermicon.perception.calibrate` writes the shipped file again.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.circuit.records import Record, RecordError, Table, dump_records
from thermicon.perception.detection import criterion_of
from thermicon.perception.distance import differences, memory_from_task
from thermicon.perception.observer import CHANNELS, DATA, NORMS, Channel, Norm, Observer, load_thresholds
from thermicon.perception.percept import perceive_many, uniform_clock
from thermicon.perception.receptors import Array, receptor_drive
from thermicon.perception.sensation import amplitude_jnd

RIG = "thenar"
SITE = "thenar"
BASELINE_C = 32.0
DIGITS = 4
TAIL_S = 10.0
COMMENT = """Constants of the nominal observer, written by `python -m thermicon.perception.calibrate`.
Set on the records marked `calibrate` in thresholds.toml; `use = "assumed"` has no data behind it.
low and high are what the data or the assumption allow; nothing here was set on a predicted record.
Written by a program: change thresholds.toml and run it again."""


def calibrate(thresholds: Table | None = None) -> Table:
    """Records of the calibrated observer, from the shipped table or another one like it."""
    known = _usable(load_thresholds() if thresholds is None else thresholds)
    fixed = _taken_over(known)
    slope = _slope(known)
    criterion = _criterion(known)
    known_so_far = (*fixed, slope, criterion)
    unset = [_memory(norm, 0.0, 0.0, 0.0) for norm in NORMS]
    draft = Observer.from_table(Table("draft", (*known_so_far, *_unit_drives(), *unset)))
    drives = [_threshold_drive(known, channel, draft) for channel in CHANNELS]
    memory = _memory_noise(known, Observer.from_table(Table("draft", (*known_so_far, *drives, *unset))))
    return Table("observer.toml", tuple(_rounded(r) for r in (*known_so_far, *drives, *memory)))


def to_toml(observer: Table) -> str:
    """Text of the parameter file, the same bytes for the same records."""
    return dump_records(observer, comment=COMMENT)


def _usable(table: Table) -> Table:
    return Table(table.name, tuple(r for r in table if r.use in ("calibrate", "assumed")))


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


def _threshold_drive(known: Table, channel: Channel, observer: Observer) -> Record:
    """Peak receptor drive of a fast step as large as the forced-choice threshold."""
    record = known.one("detection threshold", channel=channel, site=SITE)
    rate = known.one("rate of the threshold step")
    depth = known.one("receptor depth", channel=channel)

    def drive(rate_K_per_s: float) -> float:
        dt, traces = _receptors([_ramp(channel, record.central, rate_K_per_s)])
        return float(receptor_drive(traces[0][channel], dt, channel, observer).max())

    ends = [drive(r) for r in rate.interval]
    value = drive(rate.central)
    return Record(
        quantity="drive of a threshold step",
        unit="K",
        source=f"calibrated on: {record.source}; depth {depth.central:g} mm: {depth.source}",
        value=value,
        low=min(*ends, value),
        high=max(*ends, value),
        channel=channel,
        site=SITE,
        method=f"skin-surface ramp of {record.central:g} K at {rate.central:g} K/s, held, on the {RIG} rig",
        conditions=f"interval: rate of {rate.interval[0]:g} to {rate.interval[1]:g} K/s (assumed)",
        confidence=record.confidence,
        use="calibrate",
    )


def _memory_noise(known: Table, observer: Observer) -> list[Record]:
    """Memory noise at which the rate task comes out as published, for each norm of distance."""
    fraction = known.one("rate Weber fraction")
    rates = known.one("rate of the rate task").interval
    spans = known.one("span of the rate task").interval
    criteria = known.one("criterion of the rate task").interval
    found: dict[Norm, list[list[float]]] = {norm: [[] for _ in criteria] for norm in NORMS}
    for rate, span in itertools.product(rates, spans):
        cues = [_ramp("cold", span, rate), _ramp("cold", span, rate * (1.0 + fraction.central))]
        dt, traces = _receptors(cues, end_s=span / rate + TAIL_S)
        cold, warm = perceive_many(_stack(traces, "cold"), _stack(traces, "warm"), dt, observer)
        apart = differences(cold[None], warm[None], dt, observer)
        duration = dt * (cold.shape[-1] - 1)
        for norm in NORMS:
            for k, proportion in enumerate(criteria):
                size = float(apart[norm][0, 0, 1])
                found[norm][k].append(memory_from_task(size, proportion, observer, norm, duration))
    records = []
    for norm in NORMS:
        ends = [_geometric_mean(values) for values in found[norm]]
        every = [v for values in found[norm] for v in values]
        spread = max(max(values) / min(values) for values in found[norm])
        value = _geometric_mean(ends)
        conditions = (
            f"skin-surface coolings at {rates[0]:g} and {rates[1]:g} K/s over {spans[0]:g} and {spans[1]:g} K against "
            f"{1 + fraction.central:g} times the rate; {criteria[0]:g} and {criteria[1]:g} correct are the ends; "
            f"largest over smallest condition {spread:.3f}, all {min(every):.3f} to {max(every):.3f}"
        )
        made = _memory(norm, value, min(ends), max(ends))
        records.append(replace(made, source=f"calibrated on: {fraction.source}", conditions=conditions))
    return records


def _memory(norm: Norm, value: float, low: float, high: float) -> Record:
    return Record(
        quantity="memory noise",
        unit="log units",
        source="not calibrated yet",
        value=value,
        low=low,
        high=high,
        channel="both",
        method=norm,
        confidence="low",
        use="calibrate",
    )


def _unit_drives() -> list[Record]:
    return [Record("drive of a threshold step", "K", "not calibrated yet", value=1.0, channel=c) for c in CHANNELS]


def _ramp(channel: Channel, size_K: float, rate_K_per_s: float) -> str:
    verb = "cool" if channel == "cold" else "warm"
    return f"  {verb} by {size_K:.9g} K at {rate_K_per_s:.9g} K/s\n  hold for {TAIL_S:g} s"


def _receptors(cues: Sequence[str], end_s: float | None = None) -> tuple[float, list[dict[Channel, Array]]]:
    """Step (s) and receptor temperatures of skin-controlled cues on the nominal rig, to one common end."""
    from thermicon.circuit import Rig, simulate
    from thermicon.icons import parse

    head = f"cue 1\nset calibration {{\n  control skin\n  baseline {BASELINE_C:g} °C\n}}\n"
    icons = parse(head + "\n".join(f"icon cue-{k} {{\n{body}\n}}" for k, body in enumerate(cues)))
    rig = Rig.load(RIG)
    runs = [simulate(icon, rig, rate_Hz=100) for icon in icons]
    dt, rows = uniform_clock(runs[0].time_s)
    rows = min([rows, *(uniform_clock(run.time_s)[1] for run in runs)])
    if end_s is not None:
        rows = min(rows, round(end_s / dt) + 1)
    return dt, [{"cold": run.cold_receptor_C[:rows], "warm": run.warm_receptor_C[:rows]} for run in runs]


def _stack(traces: Sequence[dict[Channel, Array]], channel: Channel) -> Array:
    return np.stack([trace[channel] for trace in traces])


def _geometric_mean(values: Sequence[float]) -> float:
    return math.exp(sum(math.log(v) for v in values) / len(values))


def _rounded(record: Record) -> Record:
    def short(number: float | None) -> float | None:
        return None if number is None else float(f"{number:.{DIGITS}g}")

    return replace(record, value=short(record.value), low=short(record.low), high=short(record.high))


def main() -> None:
    """Write the parameter file of the package."""
    (DATA / "observer.toml").write_text(to_toml(calibrate()), encoding="utf-8")


if __name__ == "__main__":
    main()
