"""Single faults in any play of exported files, prevented as the sidecar demands, on the independent circuit.

A play begins from rest, after no power, after many plays, or after a restart. From instants of it a current (or the
set-point of a loop) hangs until the watchdog acts; a driver is stuck at any current, at its limits, or where it would
hold the display just inside the cut-off; a loop has lost its sensor and sends its limit. Only the cut-off acts on
these, and where it never does, the current stays.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tests.circuit.delivery.benches import Bench, Display, Loop
from tests.circuit.delivery.exported_files import Course, read_file, sidecar_in
from tests.circuit.delivery.independent import Array, Circuit, Json, meshed, worlds_of
from tests.circuit.delivery.lanes import Lanes, joined
from tests.circuit.delivery.replay import CLOSE_K, LEVELS, WATCHED, Skin

LEAST, INSTANTS, PLAYS = 25, 5, 20
"""Faults of a sort at least; instants after each start; plays one after the other."""
STUCK_S, AFTER_S, LOOP_S, LONGEST_REST_S = 600.0, 120.0, 10.0, 1800.0
INSIDE_K = 0.02
NUISANCE = "the cut-off acts without a fault"
LIMITS = np.array([LEVELS[name] for name in WATCHED])


@dataclass
class Faults:
    """Of each (sort, start): how many were tried, the nearest they came to a hard limit in K, and what passed."""

    tried: Counter[tuple[str, str]] = field(default_factory=Counter)
    margin_K: dict[tuple[str, str], float] = field(default_factory=dict)
    unsafe: list[str] = field(default_factory=list)
    told: Counter[str] = field(default_factory=Counter)

    def note(self, sort: str, start: str, whats: list[str], far: Array) -> None:
        """Extremes (lanes, watched, 2) of faults, those of one fault side by side."""
        limits = LIMITS[: far.shape[1]]
        inside_K = np.minimum(far[:, :, 0] - limits[:, 0], limits[:, 1] - far[:, :, 1])
        self.tried[sort, start] += len(whats)
        self.margin_K[sort, start] = min(self.margin_K.get((sort, start), np.inf), float(inside_K.min()))
        if inside_K.min() < -CLOSE_K:
            lane, rule = np.unravel_index(inside_K.argmin(), inside_K.shape)
            low, high = far[lane, rule]
            what = whats[lane * len(whats) // len(far)]
            self.unsafe.append(f"{sort} {what}, {start}: {WATCHED[rule]} {low:.2f} … {high:.2f} °C")

    def add(self, other: Faults) -> None:
        """Add those of another export."""
        self.tried += other.tried
        self.told += other.told
        self.unsafe += other.unsafe
        for key, margin in other.margin_K.items():
            self.margin_K[key] = min(margin, self.margin_K.get(key, np.inf))

    def table(self) -> str:
        """What was tried, a line each."""
        rows = (f"{sort:22} {start:24} {self.tried[sort, start]:7} {self.margin_K[sort, start]:8.3f} K"
                for sort, start in sorted(self.tried))  # fmt: skip
        return "\n".join([*rows, str(dict(self.told))])


def faulted(
    files: Mapping[str, bytes], stems: Sequence[str], rng: np.random.Generator, lumps: int, changed: Json | None = None
) -> Faults:
    """Faults of every sort after every start, in worlds with so many `lumps`: the rig as given, others by chance.

    `changed` demands stand in the place of those of the sidecars.
    """
    found, told = Faults(), [sidecar_in(files, stem) for stem in stems]
    demands = [one["hardware_must_prevent"] | (changed or {}) for one in told]
    benches = _benches(files, stems, demands, rng, lumps)
    begun = list(_starts(benches, demands, rng))
    count = max(INSTANTS, -(-LEAST // len(begun)))
    for start, which, state in begun:
        _tried(benches[which], demands[which], start, state, count, rng, found)
    return found


def _benches(
    files: Mapping[str, bytes], stems: Sequence[str], demands: list[Json], rng: np.random.Generator, lumps: int
) -> list[Bench]:
    told, played = sidecar_in(files, stems[0]), [read_file(files, stem) for stem in stems]
    rig, records = told["rig"]["document"], {each["quantity"]: each for each in told["device"]["records"]}
    if told["device"]["driven_by"] == "set-points":
        skin, span, cut = Skin(rig, rng).circuit, records["set-point range"], demands[0]["cut_off_display_C"]
        ends = (span["low"], span["high"]) if cut["react_within_s"] else (cut["low"], cut["high"])  # by its maker
        return [Display(skin, one, ends) for one in played if isinstance(one, Course)]
    worlds = worlds_of(rig, rng, 6)
    most = max(4, lumps // (2 + len(meshed(rig)[0])))
    if len(worlds) > most:
        worlds = [worlds[k] for k in (0, *rng.choice(np.arange(1, len(worlds)), most - 1, replace=False))]
    lanes, driver = Lanes.of(Circuit.of(rig, worlds)), rig["driver"]
    limits = driver.get("current_min_A") or -driver["current_limit_A"], driver["current_limit_A"]
    peak = None
    if told["device"]["driven_by"] == "duty":
        peak = min(-records["output range"]["low"], records["output range"]["high"])
        limits = -peak, peak
    return [
        Loop(lanes, one, demand, driver["update_Hz"], rng)
        if isinstance(one, Course)
        else Bench(lanes, one, limits, peak)
        for one, demand in zip(played, demands, strict=True)
    ]


def _starts(benches: list[Bench], demands: list[Json], rng: np.random.Generator) -> Iterator[tuple[str, int, Array]]:
    """How a play may begin: the start, which icon is played, and states (worlds, n)."""
    pauses = [demand["pause_at_least_s"] for demand in demands]
    rests = [demand["rest_before_first_play_s"] for demand in demands]
    rest_s = LONGEST_REST_S if None in rests else max(rests)
    check = demands[0]["polarity_check"] or {"test_current_A": 0.0, "test_s": 0.0}

    def some() -> int:
        return int(rng.integers(len(benches)))

    def cold(bench: Bench, tested: bool) -> Array:
        state = bench.unpowered()
        if tested:
            bench.lanes.hold(state, bench.every, bench.flow(check["test_current_A"]), check["test_s"])
        bench.wait(state, rest_s)
        return state

    which = some()
    yield "rest", which, benches[which].rest()
    for tested in (False, True)[: 1 + bool(check["test_s"])]:
        which = some()
        yield "no power" + ", then a polarity check" * tested, which, cold(benches[which], tested)
    if None in pauses:
        return
    pause_s, which = max(pauses), some()
    state = cold(benches[which], False)
    benches[which].run(state, 0.0, benches[which].end_s + pause_s)
    yield "second play, no power", some(), state
    for longer_s in (0.0, float(np.exp(rng.uniform(0, 4)))):
        which = some()
        state = benches[which].rest()
        for _ in range(PLAYS):
            benches[which].run(state, 0.0, benches[which].end_s + pause_s + longer_s)
            which = some()
        yield f"{PLAYS} plays" + ", longer pause" * bool(longer_s), which, state
    state = cold(benches[which], False) if rng.random() < 0.5 else benches[which].rest()
    for _ in range(int(rng.integers(1, 4))):
        which = some()
        benches[which].run(state, 0.0, float(rng.uniform(0, benches[which].end_s)))
        benches[which].off(state, benches[which].every, float(np.exp(rng.uniform(-2, 6))))
        which = some()
        benches[which].wait(state, max(rest_s, pause_s))
    yield "restart", which, state


def _tried(
    bench: Bench, demand: Json, start: str, state: Array, count: int, rng: np.random.Generator, found: Faults
) -> None:
    """Every sort of fault at some instants of a play and its pause, and the play without one."""
    cut, watchdog_s = demand["cut_off_display_C"], float(demand["watchdog_s"])
    react_s, wrong_K = cut["react_within_s"], (demand["loop"] or {}).get("sensor_offset_at_most_K", 0.0)
    pause_s = float(demand["pause_at_least_s"] or 0.0)
    changes = rng.choice(bench.edges_s, count // 3)
    times = [*changes, *rng.uniform(0, bench.end_s, count - 1 - len(changes))]
    times += [bench.end_s + rng.uniform(0, pause_s + 10.0)]
    now, far, moments = 0.0, [], []
    for time in sorted(times):
        far.append(bench.run(state, now, time))
        now = float(time)
        moments.append((now, state.copy()))
    if now < bench.end_s:
        far.append(bench.run(state, now, bench.end_s))
    normal = joined(far, len(bench.every))
    found.note("none", start, [""], bench.watched(normal))
    shown = normal[:, 4:6]
    acts = (shown[:, 0] < cut["low"] - wrong_K) | (shown[:, 1] > cut["high"] + wrong_K)
    found.told[f"{NUISANCE}, {start}"] += bool(acts.any())
    found.told["no watchdog is quick enough"] += not watchdog_s
    found.told["no cut-off is quick enough"] += not react_s
    faults: list[tuple[str, str, Array, Array, Array | float]] = []
    for time, begun in moments:
        hung, at = bench.flow(*bench.at(time)), f"at {time:.2f} s"
        if watchdog_s:
            left = begun.copy()
            held = bench.hang(left, time, watchdog_s)
            after = bench.wait(left, LOOP_S) if isinstance(bench, Loop) else bench.off(left, bench.every, AFTER_S)
            found.note("hang", start, [at], bench.watched(joined([held, after], len(left))))
        elif react_s and "cut-off" in demand["faults"][0]["prevented_by"]:
            faults.append(("hang", at, begun, *hung.T))
        inside = rng.choice([cut["low"] + INSIDE_K, cut["high"] - INSIDE_K, rng.uniform(cut["low"], cut["high"])])
        share = rng.uniform()
        flows = share * bench.least + (1 - share) * bench.most, bench.settling(inside), bench.least, bench.most
        sorts = ("stuck", "stuck inside the cut-off", *[f"{'stuck' if bench.open else 'sensor lost,'} at a limit"] * 2)
        faults += [
            (sort, f"{at}, {one.min():.3f} … {one.max():.3f}", begun, one, bench.squares(one))
            for sort, one in zip(sorts, flows, strict=True)
        ]
    worlds, count = len(bench.every), len(faults)
    lanes, states = np.tile(bench.every, count), np.concatenate([begun for _, _, begun, _, _ in faults])
    flow = np.concatenate([np.column_stack([one, square]) for _, _, _, one, square in faults])
    cuts = np.array([cut["low"], cut["high"], react_s]) - rng.choice([-1, 0, 1], (len(lanes), 1)) * [
        wrong_K,
        wrong_K,
        0,
    ]
    far = bench.lanes.hold(states, lanes, flow, STUCK_S, cuts)
    cut_off = np.flatnonzero(far[:, 8] < STUCK_S)
    ended = states[cut_off]
    far[cut_off] = joined([far[cut_off], bench.off(ended, lanes[cut_off], AFTER_S)], len(cut_off))
    if not react_s:  # the sidecar says so
        far[cut_off] = joined([], len(cut_off))
    for sort in dict.fromkeys(sort for sort, *_ in faults):
        which = [k for k, fault in enumerate(faults) if fault[0] == sort]
        rows = np.concatenate([far[k * worlds : (k + 1) * worlds] for k in which])
        found.note(sort, start, [faults[k][1] for k in which], bench.watched(rows))
