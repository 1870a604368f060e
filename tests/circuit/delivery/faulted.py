"""Single faults in plays of exported files on the independent circuit.

A play begins from rest, after no power, after many plays, or after a restart. From instants of it a current (or the
set-point of a loop) hangs until the watchdog acts; a driver is stuck at any current, at its limits, or where it holds
the display just inside a cut-off, or creeps there; a loop has lost its sensor and sends its limit; power fails. Only
the cut-offs act on these, and where they never do, the current stays for half an hour.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tests.circuit.delivery.benches import Bench, Display, Loop
from tests.circuit.delivery.exported_files import Course, read_file, sidecar_in
from tests.circuit.delivery.independent import Array, Circuit, Json, meshed, worlds_of
from tests.circuit.delivery.lanes import DOSE, LONGEST, NEVER, RATE, STAGE, Lanes, joined
from tests.circuit.delivery.replay import CLOSE_K, CLOSE_SHARE, DOSE_MIN, LEVELS, RATE_K_PER_S, SESSION_S, WATCHED, Skin

LEAST, INSTANTS, PLAYS = 25, 5, 20
"""Faults of a sort at least; instants after each start; plays one after the other."""
STUCK_S, AFTER_S, LOOP_S, LONGEST_REST_S = 1800.0, 30.0, 10.0, 1800.0
INSIDE_K, SENSOR_K, LATE_S = 0.02, 0.3, 1.0
"""So near to a cut-off a display stays; so wrong may be its sensor; so late may act a second cut-off."""
NUISANCE = "the cut-off acts without a fault"
TOO_FAST = "driver stuck at its limit moves the skin too fast"
LIMITS = np.array([LEVELS[name] for name in WATCHED])
WIDER = LIMITS + np.array([[-1.0, 1.0], [-1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
"""What skin and receptor may reach in a fault."""
FAULT_DOSE_MIN = 0.5 * DOSE_MIN


@dataclass
class Faults:
    """Of each (sort, start): how many were tried and how near they came to the limits, and what passed one.

    Nearest in K to a temperature; shares of dose and rate, of which 1 is the limit.
    """

    tried: Counter[tuple[str, str]] = field(default_factory=Counter)
    margin_K: dict[tuple[str, str], float] = field(default_factory=dict)
    share: dict[tuple[str, str, str], float] = field(default_factory=dict)
    unsafe: list[str] = field(default_factory=list)
    told: Counter[str] = field(default_factory=Counter)

    def note(self, sort: str, start: str, whats: list[str], far: Array, limits: Array) -> None:
        """Extremes (lanes, watched, 2) of faults, those of one fault side by side, against limits (watched, 2)."""
        limits = limits[: far.shape[1]]
        inside_K = np.minimum(far[:, :, 0] - limits[:, 0], limits[:, 1] - far[:, :, 1])
        self.tried[sort, start] += len(whats)
        self.margin_K[sort, start] = min(self.margin_K.get((sort, start), np.inf), float(inside_K.min()))
        if inside_K.min() < -CLOSE_K:
            lane, rule = np.unravel_index(inside_K.argmin(), inside_K.shape)
            low, high = far[lane, rule]
            what = whats[lane * len(whats) // len(far)]
            self.unsafe.append(f"{sort} {what}, {start}: {WATCHED[rule]} {low:.2f} … {high:.2f} °C")

    def note_share(self, sort: str, start: str, whats: list[str], rule: str, values: Array, limit: float) -> None:
        """Doses or rates (lanes,), those of one fault side by side."""
        lane = int(values.argmax())
        share = float(values[lane]) / limit
        self.share[sort, start, rule] = max(self.share.get((sort, start, rule), 0.0), share)
        if share > 1.0 + CLOSE_SHARE:
            what = whats[lane * len(whats) // len(values)]
            self.unsafe.append(f"{sort} {what}, {start}: {rule} {values[lane]:.3f} (limit {limit:g})")

    def add(self, other: Faults) -> None:
        """Add those of another export."""
        self.tried += other.tried
        self.told += other.told
        self.unsafe += other.unsafe
        for key, margin in other.margin_K.items():
            self.margin_K[key] = min(margin, self.margin_K.get(key, np.inf))
        for key, share in other.share.items():
            self.share[key] = max(share, self.share.get(key, 0.0))

    def table(self) -> str:
        """What was tried, a line each: how often, the nearest temperature, and the greatest shares."""
        rows = []
        for sort, start in sorted(self.tried):
            shares = (f"{rule} {self.share[sort, start, rule]:.3f}" for rule in ("dose", "rate")
                      if (sort, start, rule) in self.share)  # fmt: skip
            numbers = f"{self.tried[sort, start]:7} {self.margin_K[sort, start]:8.3f} K"
            rows.append(f"{sort:28} {start:32} {numbers}  {'  '.join(shares)}")
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
    lanes, driver = Lanes.of(Circuit.of(rig, worlds), _healthy_C(demands)), rig["driver"]
    limits = driver.get("current_min_A") or -driver["current_limit_A"], driver["current_limit_A"]
    peak = None
    if told["device"]["driven_by"] == "duty":
        peak = min(-records["output range"]["low"], records["output range"]["high"])
        limits = -peak, peak
    limits = demands[0]["current_limit_A"] or limits
    return [
        Loop(lanes, one, demand, driver["update_Hz"], rng)
        if isinstance(one, Course)
        else Bench(lanes, one, limits, peak)
        for one, demand in zip(played, demands, strict=True)
    ]


def _healthy_C(demands: list[Json]) -> tuple[float, float]:
    """Where a display is outside the second cut-off as a wrong sensor shows it."""
    spans = [demand["held_cut_off_display_C"] for demand in demands]
    ends = [(span["low"] + SENSOR_K, span["high"] - SENSOR_K) for span in spans if span]
    return max((low for low, _ in ends), default=-NEVER), min((high for _, high in ends), default=NEVER)


def _starts(benches: list[Bench], demands: list[Json], rng: np.random.Generator) -> Iterator[tuple[str, int, Array]]:
    """How a play may begin: the start, which icon is played, and states (worlds, n)."""
    pauses = [demand["pause_at_least_s"] for demand in demands]
    rests = [demand["rest_before_first_play_s"] for demand in demands]
    rest_s = LONGEST_REST_S if None in rests else max(rests)
    check = demands[0]["polarity_check"] or {"off_before_s": 0.0, "test_current_A": 0.0, "test_s": 0.0}

    def some() -> int:
        return int(rng.integers(len(benches)))

    def test(bench: Bench, state: Array) -> None:
        bench.off(state, bench.every, check["off_before_s"])
        bench.lanes.hold(state, bench.every, bench.flow(check["test_current_A"]), check["test_s"])

    def cold(bench: Bench, tested: bool) -> Array:
        state = bench.unpowered()
        if tested:
            test(bench, state)
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
        if check["test_s"] and rng.random() < 0.5:
            test(benches[which], state)
        which = some()
        benches[which].wait(state, max(rest_s, pause_s))
    yield "restart", which, state


def _tried(
    bench: Bench, demand: Json, start: str, state: Array, count: int, rng: np.random.Generator, found: Faults
) -> None:
    """Every sort of fault at some instants of a play and its pause, and the play without one."""
    moments, normal = _played(bench, demand, start, state, count, rng, found)
    faults = _Tries(bench, demand, start, normal, found)
    for time, begun in moments:
        hung, at = bench.flow(*bench.at(time)), f"at {time:.2f} s"
        if demand["watchdog_s"]:
            left = begun.copy()
            held = bench.hang(left, time, float(demand["watchdog_s"]))
            after = bench.wait(left, LOOP_S) if isinstance(bench, Loop) else bench.off(left, bench.every, AFTER_S)
            faults.judge("hang", [at], joined([held, after], len(left)))
        elif faults.react_s and "cut-off" in demand["faults"][0]["prevented_by"]:
            faults.add("hang", at, begun, *hung.T)
        share, wrong_K = rng.uniform(), faults.sensor_K * rng.choice([-1, 0, 1], len(bench.every))
        cut, second = faults.cut, faults.second
        low, high = rng.choice([cut["low"], second["low"]]), rng.choice([cut["high"], second["high"]])
        inside = rng.choice([low + INSIDE_K, high - INSIDE_K, rng.uniform(low, high)]) - wrong_K
        creeping = rng.choice([[second["low"] + INSIDE_K, cut["low"] + INSIDE_K],
                               [second["high"] - INSIDE_K, cut["high"] - INSIDE_K]])  # fmt: skip
        faults.add("stuck", at, begun, share * bench.least + (1 - share) * bench.most)
        faults.add("stuck inside a cut-off", at, begun, bench.settling(inside), wrong_K=wrong_K)
        first, last = (bench.settling(level - wrong_K) for level in creeping)
        faults.add("creeping", at, begun, last, wrong_K=wrong_K, before=first, before_s=rng.uniform(60, 1500))
        for end in (bench.least, bench.most):
            faults.add(f"{'stuck' if bench.open else 'sensor lost,'} at a limit", at, begun, end)
        if not faults.made:
            faults.without_power(at, begun)
    faults.play()


def _played(
    bench: Bench, demand: Json, start: str, state: Array, count: int, rng: np.random.Generator, found: Faults
) -> tuple[list[tuple[float, Array]], Array]:
    """A play without a fault: instants with states, and how far it went."""
    cut, second = demand["cut_off_display_C"], demand["held_cut_off_display_C"]
    wrong_K, pause_s = (
        (demand["loop"] or {}).get("sensor_offset_at_most_K", 0.0),
        float(demand["pause_at_least_s"] or 0),
    )
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
    found.note("none", start, [""], bench.watched(normal), LIMITS)
    found.note_share("none", start, [""], "dose", normal[:, DOSE], DOSE_MIN)
    bench.wait(state, LOOP_S if isinstance(bench, Loop) else STUCK_S)
    shown = normal[:, 4:6]
    acts = (shown[:, 0] < cut["low"] + wrong_K) | (shown[:, 1] > cut["high"] - wrong_K)
    found.told[f"{NUISANCE}, {start}"] += bool(acts.any())
    if second:
        longest = float(state[:, LONGEST].max()) / second["longer_than_s"]
        found.told[f"{NUISANCE}, the second, {start}"] += longest > 1.0
        found.share["none", start, "longest stay"] = longest
    found.told["a second cut-off"] += second is not None
    found.told["no watchdog is quick enough"] += not demand["watchdog_s"]
    found.told["no cut-off is quick enough"] += not cut["react_within_s"]
    return moments, normal


class _Tries:
    """Faults that only cut-offs prevent, after one start, collected to be played side by side."""

    def __init__(self, bench: Bench, demand: Json, start: str, normal: Array, found: Faults) -> None:
        self.bench, self.start, self.normal, self.found = bench, start, normal, found
        self.cut, self.react_s = demand["cut_off_display_C"], demand["cut_off_display_C"]["react_within_s"]
        never = {"low": -NEVER, "high": NEVER, "longer_than_s": NEVER}
        self.held = demand["held_cut_off_display_C"] or never
        self.second = demand["held_cut_off_display_C"] or self.cut
        self.made = isinstance(bench, Display)  # a thermode, inside of which its maker prevents faults
        self.sensor_K = 0.0 if self.made else SENSOR_K
        self.off_s = SESSION_S if demand["zero_current_at_most_s"] is None else demand["zero_current_at_most_s"]
        slower = [one["prevented_by"] for one in demand["faults"] if one["fault"] == TOO_FAST]
        self.rated = not self.made and not any(one.startswith("a slower") for one in slower)
        found.told["rates of stuck drivers are not kept"] += not self.rated
        self.faults: list[tuple[str, str]] = []
        self.columns: list[tuple[Array, ...]] = []

    def add(
        self, sort: str, at: str, begun: Array, flow: Array, square: Array | None = None, *,
        wrong_K: Array | None = None, before: Array | None = None, before_s: float = 0.0,
    ) -> None:  # fmt: skip
        """A flow (worlds,) that is stuck, with a sensor of the cut-offs that is wrong, and another flow for a time."""
        wrong = np.zeros(len(flow)) if wrong_K is None else wrong_K
        first = flow if before is None else before
        squares = self.bench.squares(flow) if square is None else square
        self.faults.append((sort, f"{at}, {flow.min():.3f} … {flow.max():.3f}"))
        columns = (begun, flow, squares, first, self.bench.squares(first), np.full(len(flow), before_s), wrong)
        self.columns.append(columns)

    def without_power(self, at: str, begun: Array) -> None:
        """No current at all, for as long as contact may last; the dose counts with that of the play."""
        far = self.bench.off(begun.copy(), self.bench.every, self.off_s)
        far[:, DOSE] += self.normal[:, DOSE]
        self.found.note("no power", self.start, [at], self.bench.watched(far), WIDER)
        self.found.note_share("no power", self.start, [at], "dose", far[:, DOSE], DOSE_MIN)

    def play(self) -> None:
        """Play all of them until a cut-off has acted, then without current."""
        state, flow, square, first, its_square, first_s, wrong_K = (
            np.concatenate(column) for column in zip(*self.columns, strict=True)
        )
        lanes, count = np.tile(self.bench.every, len(self.faults)), len(flow)
        longer_s = self.held["longer_than_s"] + LATE_S
        cuts = np.tile([self.cut["low"], self.cut["high"], self.react_s, self.held["low"], self.held["high"], longer_s],
                       (count, 1))  # fmt: skip
        cuts[:, [0, 1, 3, 4]] -= wrong_K[:, None]
        state[:, -2:] = 0.0
        far = self.bench.lanes.hold(state, lanes, np.column_stack([first, its_square]), first_s, cuts)
        on = np.flatnonzero(far[:, STAGE] == 0)
        stuck = state[on]
        late = self.bench.lanes.hold(
            stuck, lanes[on], np.column_stack([flow, square])[on], STUCK_S - first_s[on], cuts[on]
        )
        state[on], far[on] = stuck, joined([far[on], late], len(on))
        cut_off = np.flatnonzero(far[:, STAGE])
        ended = state[cut_off]
        far[cut_off] = joined([far[cut_off], self.bench.off(ended, lanes[cut_off], AFTER_S)], len(cut_off))
        after = self.bench.off(ended, lanes[cut_off], max(0.0, self.off_s - AFTER_S))
        after[:, DOSE] += far[cut_off, DOSE] + self.normal[lanes[cut_off], DOSE]
        if not self.react_s:  # the sidecar says so
            first_acted = far[:, STAGE] == 1
            far[first_acted] = joined([], int(first_acted.sum()))
            after = after[far[cut_off, STAGE] == 2]
        if len(after) and not self.made:
            self.found.tried["off after a fault", self.start] += len(after) // len(self.bench.every)
            self.found.margin_K["off after a fault", self.start] = np.inf
            self.found.note_share("off after a fault", self.start, [""], "dose", after[:, DOSE], DOSE_MIN)
        by_fault = far.reshape(len(self.faults), len(self.bench.every), -1)
        for sort in dict.fromkeys(sort for sort, _ in self.faults):
            which = [k for k, fault in enumerate(self.faults) if fault[0] == sort]
            rows = by_fault[which].reshape(-1, by_fault.shape[2])
            self.judge(sort, [self.faults[k][1] for k in which], rows)

    def judge(self, sort: str, whats: list[str], far: Array) -> None:
        """Temperatures, doses and rates of faults of a sort."""
        self.found.note(sort, self.start, whats, self.bench.watched(far), LIMITS if self.made else WIDER)
        if not self.made:
            self.found.note_share(sort, self.start, whats, "dose", far[:, DOSE], FAULT_DOSE_MIN)
        if self.rated:
            self.found.note_share(sort, self.start, whats, "rate", far[:, RATE], RATE_K_PER_S)
