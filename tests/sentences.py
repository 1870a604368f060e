"""Cases of what verdicts, notes and refusals say: both sides of each condition, on records made by hand."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace as Record
from typing import Any

from tests.circuit.verdicts import CUT_OFF, LOOP, MADE_UP, POLARITY
from thermicon.circuit import Limits
from thermicon.circuit.delivery import delivered_drive as drives
from thermicon.circuit.delivery.setpoints import Setpoints
from thermicon.circuit.rig.uncertainty import Uncertainty
from thermicon.circuit.safety.checks import Before, Check, Scenario, cures_of, hard_of, hard_reason
from thermicon.circuit.safety.demands import CutOff, Harm, HeldCutOff, SingleFault
from thermicon.circuit.safety.gate import Gate
from thermicon.circuit.safety.repeated import Repeated
from thermicon.circuit.solver.trace import Outcome

SKIN = Check("skin surface", "hard", 42.004, 42.0, "°C", 1.0, 0.5, "a source", run=Scenario("a lane"))
COLD = replace(SKIN, value=14.5, limit=15.0, upper=False, time_s=nan, since_s=nan, run=Scenario())
KEPT = replace(SKIN, value=41.99999, since_s=None, from_start_K=3.0)
RATE = replace(SKIN, quantity="rate of skin temperature", value=12.0, limit=10.0, unit="K/s", since_s=2.0)
DOSE = replace(SKIN, quantity="thermal dose", unit="min CEM43")
SOFT = replace(SKIN, severity="soft", limit=40.0)
HELD, HOT = HeldCutOff(22.0, 39.5, 8.2), Harm("display", 46.0, "°C")
NO_CORNER, NO_CUT_OFF = (0.0,) * 7, replace(CUT_OFF, react_within_s=0.0)


def fault(kind: str, **values: object) -> SingleFault:
    """A fault of that kind."""
    return SingleFault(kind, "red", values)


FAULTS = {
    "hang, watchdog": fault("hang", lasts_s=0.5, harm=Harm("skin surface", 42.3, "°C"), watchdog_s=0.4),
    "hang, none quick enough": fault("hang", lasts_s=0.06, harm=None, watchdog_s=0.0),
    "stuck, cut-off": fault("stuck", harms=((HOT, -1.5),), cut_off=CUT_OFF, most_A=1.5, limit_A=1.2),
    "stuck, current limit": fault("stuck", harms=((HOT, -1.5), (Harm("skin surface", 43.0, "°C"), 1.5)),
                                  cut_off=NO_CUT_OFF, most_A=1.5, limit_A=1.2),
    "stuck inside": fault("stuck inside", held=HELD, cut_off=CUT_OFF),
    "stuck fast, kept": fault("stuck fast", rate=11.6, kept=True, limit_A=(-1.2, 1.2)),
    "stuck fast, needed": fault("stuck fast", rate=10.5, kept=False, limit_A=(-1.29, 1.5)),
    "swapped fast": fault("swapped fast", rate=13.2, kept=False, limit_A=(-0.8, 1.5)),
    "stuck, nothing": fault("stuck", harms=(), cut_off=NO_CUT_OFF, most_A=1.5, limit_A=None),
    "unpowered, rest": fault("unpowered", finding=SKIN, rest_s=5.0),
    "unpowered, at once": fault("unpowered", finding=None, rest_s=0.0),
    "unpowered, never": fault("unpowered", finding=SKIN, rest_s=None),
    "swapped": fault("swapped", check=POLARITY),
    "set-point hang": fault("set-point hang", levels_C=(26.0, 38.0), watchdog_s=12.0),
    "loop stuck, cut-off": fault("loop stuck", levels_C=(0.0, 60.0), passed_s=0.25, cut_off=CUT_OFF),
    "loop stuck, its maker": fault("loop stuck", levels_C=(60.0,), passed_s=0.0, cut_off=NO_CUT_OFF),
    "unpowered loop": fault("unpowered loop", display_C=(24.0, 33.0), rest_s=30.0),
    "unpowered loop, long": fault("unpowered loop", display_C=(-4.0, 33.0), rest_s=None),
    "loop lost": fault("loop lost", harms=((Harm("display", 50.0, "°C"), -1.5),), cut_off=CUT_OFF),
    "loop lost, doses": fault("loop lost", cut_off=CUT_OFF, harms=((Harm("thermal dose", 999.9, "min CEM43"), -1.4),
                                                                   (Harm("thermal dose", 1000.1, "min CEM43"), -1.5))),
}  # fmt: skip

LANES = [Scenario("lane", before=Before(plays, 12.34567)) for plays in ("cycle", "warm", "cold", "once", "others")]
SCENARIOS = [Scenario(), Scenario(NO_CORNER, "slow", Before("another", 3.0), "zero current"), *LANES]
BEYOND = [[SKIN, RATE, DOSE], [replace(SKIN, quantity="hot plate")], [replace(SKIN, since_s=0.0)], [SOFT]]
REPEATED = Repeated(pause_s=30.0, recovery_s=12.0, shortest_pause_s=20.0, plays=40, session_s=1800.0, checks=())
PASSED, QUICKER = replace(REPEATED, checks=(SKIN,)), replace(REPEATED, faultless_pause_s=8.0)
PAUSES = [
    replace(PASSED, shortest_pause_s=None),
    replace(PASSED, shortest_pause_s=40.0, faultless_pause_s=8.0),
    replace(QUICKER, pause_s=10.0),
    replace(QUICKER, pause_s=20.0),
]
WORDS = {
    "corner": lambda m: m.corner_text((-0.3, *NO_CORNER[1:-1], 0.1)),
    "scenarios": lambda m: [m.scenario_text(run) for run in SCENARIOS],
    "checks": lambda m: [m.check_text(check) for check in (SKIN, COLD, KEPT)],
    "cures": lambda m: [m.more_and_cure(hard_of(checks), cures_of(checks)) for checks in BEYOND],
    "repeated": lambda m: [m.repeated_reason(repeated, hard_reason(repeated.findings)) for repeated in PAUSES],
    "what it is not": lambda m: m.WHAT_IT_IS_NOT,
    **{f"fault, {name}": lambda m, one=one: list(m.fault_table(one).values()) for name, one in FAULTS.items()},
}

GREEN = Gate("a rig", 8.0, Uncertainty(), Limits.shipped(), 10, (), (), {}, None, REPEATED, MADE_UP)
RED = replace(GREEN, checks=(SKIN,), once=(SKIN,))
AMBER = replace(GREEN, checks=(SOFT,), repeated=replace(REPEATED, checks=(SOFT,)))
SLOW = replace(MADE_UP, cut_off_display_C=NO_CUT_OFF, faults=(FAULTS["stuck, nothing"],))
STUCK = replace(SLOW, faults=(FAULTS["stuck fast, needed"], FAULTS["swapped fast"], *SLOW.faults))
NEAR, NEARLY = (replace(SLOW, cut_off_display_C=CutOff(20.0, 40.0, react_s)) for react_s in (0.02, 0.0199))
LIMITED = replace(SLOW, faults=(FAULTS["stuck, current limit"],))
STRICT = replace(
    MADE_UP, watchdog_s=0.0, cut_off_display_C=CutOff(22.0, 39.0, 0.05), polarity_check=replace(POLARITY, needed=False),
    rest_before_first_play_s=0.0, pause_at_least_s=None, zero_current_at_most_s=300.0, current_limit_A=(-1.0, 1.2),
    loop=LOOP,
)  # fmt: skip
DRIVEN = replace(SLOW, held_cut_off_display_C=HELD, current_limit_A=(-1.2, 1.2), faults=(FAULTS["stuck fast, kept"],))
QUICK = replace(DRIVEN, cut_off_display_C=CUT_OFF)
FAST = replace(QUICK, faults=(FAULTS["stuck fast, kept"], FAULTS["hang, watchdog"], FAULTS["stuck fast, needed"]))
NO_REST = replace(MADE_UP, rest_before_first_play_s=None, pause_at_least_s=0.0, polarity_check=None)


def of(*demands: Any) -> list[tuple[str, Gate]]:
    """Icons a and b with those demands."""
    return [(name, replace(GREEN, demands=one)) for name, one in zip("ab", demands, strict=False)]


def again(name: str, **values: Any) -> tuple[str, Gate]:
    """An icon that is repeated with those values."""
    return name, replace(GREEN, repeated=replace(REPEATED, **values))


def ready(name: str, verdict: Gate, *warnings: str) -> Any:
    """An icon with its verdict and its warnings."""
    return Record(delivery=Record(name=name), verdict=verdict, warnings=warnings)


UNLIKE = [again("a", recovery_s=None, plays=30, faultless_pause_s=8.0, shortest_pause_s=None), ("b", AMBER)]
RECOVERIES = [again("a", faultless_pause_s=20.0, recovery_s=30.0), again("b", recovery_s=12.0)]
WARNED = [ready("a", GREEN, "0.5 K off", "else"), ready("b", GREEN, "0.7 K off"), ready("c", GREEN, "0.7 K off")]
GATE_WORDS = {
    "none": lambda m: m.gate_words([ready("a", RED)]),
    "one": lambda m: m.gate_words([ready("a", GREEN), ready("b", RED), Record(verdict=None, delivery=None)]),
    "two": lambda m: [about for about, _ in m.gate_words([ready("a", GREEN), ready("b", GREEN)])],
    "stuck and stuck fast": lambda m: m.gate_words([ready("a", replace(GREEN, demands=STUCK))]),
    "stuck, two cures": lambda m: m.stuck_text(of(SLOW, LIMITED)),
    "stuck, nearly quick": lambda m: (m.stuck_text(of(NEARLY)), m.stuck_text(of(NEAR)), m.demands_text(of(NEAR))),
    "stuck fast": lambda m: (m.fast_text(of(QUICK, FAST), "stuck fast"), m.fast_text(of(QUICK, MADE_UP), "stuck fast")),
    "repeated, unlike": lambda m: m.repeated_text(UNLIKE),
    "repeated, recoveries": lambda m: m.repeated_text(RECOVERIES),
    "repeated, seven amber": lambda m: m.repeated_text([*((f"i{k}", AMBER) for k in range(7)), ("green", GREEN)]),
    "demands, of a driver": lambda m: m.demands_text(of(QUICK, MADE_UP)),
    "demands, too slow": lambda m: m.demands_text(of(DRIVEN)),
    "demands, strict": lambda m: m.demands_text(of(STRICT)),
    "demands, of two": lambda m: m.demands_text(of(MADE_UP, STRICT)),
    "demands, no rest": lambda m: m.demands_text(of(NO_REST)),
    "warnings": lambda m: list(m.warning_lines(WARNED)),
    "spread": lambda m: m.spread_text(Record(step_K=(-5.0, 6.0), baseline_C=(31.0, 33.0))),
    "steps": lambda m: (m.steps_of(Record(played=None, rate_Hz=99.96)), m.steps_of(THERMODE)),
    "caution": lambda m: m.CAUTION,
}

COLD_LOST = drives.Deviation("cold receptor", 0.3, 1.0, 0.2)
LOST = drives.DeliveryDeviation((COLD_LOST, replace(COLD_LOST, place="warm receptor", rms_K=0.4)))
WITHIN = drives.DeliveryDeviation((replace(COLD_LOST, rms_K=0.05), drives.Deviation("skin", 9.0, 1.0, 9.0)))
OUT = Outcome(False, -1.2, 3.0, 0.4, (("current limit", 2.5),))
NARROW = drives.Narrowed("D plays at most 0.5 A", 0.5, replace(OUT, reached=True))
UNEXPLAINED = Record(colour="red", reason=None, mended_by_pause=False, repeated=REPEATED, findings=())
RIG = Record(driver=Record(current_max_A=1.5, voltage_limit_V=12.0), controller=None)
DEVICE = vars(Record(name="D", unit="A", kind=Record(switches=False), driven_by="amperes"))
LOOPED = Record(**{**DEVICE, "driven_by": "temperatures"})
BRIDGE = Record(**{**DEVICE, "kind": Record(switches=True)})
SHARED: dict[str, Any] = {
    **{"icon": None, "rig": RIG, "device": Record(**DEVICE), "requested_Hz": 100.0, "rate_Hz": 90.0},
    **{"designed_trace": None, "trace": Record(beyond=()), "outcome": None},
}
MODULE = drives.ModuleDrive(**SHARED, played=Record(scale=Record(step=0.01)), designed=None, delivered=None)
THERMODE = drives.ThermodeDrive(**SHARED, played=Setpoints(0.1, 0.5, 64, ((10, 60),)), prompt_trace=None)
NARROWED, LOUD = replace(MODULE, narrowed=NARROW), replace(MODULE, device_warnings=("w", NARROW.text))


def refused(m: Any, drive: Any = MODULE, verdict: Any = GREEN, deviation: Any = LOST, **values: Any) -> list[object]:
    """The refusals of a drive with those values."""
    refusals = m.refusals_of(replace(drive, **values), verdict, deviation)
    return [(one.text, one.tells, dict(one.changes), one.forcible) for one in refusals]


PREPARE = {
    "unsafe, mended by a pause": lambda m: refused(m, verdict=replace(RED, once=(), repeated=PASSED)),
    "unsafe without a finding": lambda m: refused(m, verdict=UNEXPLAINED),
    "lossy and narrowed": lambda m: refused(m, NARROWED),
    "lossy, the range misses": lambda m: refused(m, narrowed=replace(NARROW, outcome=OUT)),
    "lossy by set-points": lambda m: refused(m, THERMODE, device_warnings=("w",)),
    "lossy by warnings": lambda m: refused(m, device_warnings=("w", "v")),
    "lossy by its loop": lambda m: refused(m, device=LOOPED),
    "lossy by its rate": lambda m: refused(m, device=LOOPED, rate_Hz=89.9),
    "lossy by its duty": lambda m: refused(m, device=BRIDGE),
    "missed": lambda m: refused(m, outcome=OUT),
    "missed and narrowed": lambda m: refused(m, outcome=OUT, narrowed=NARROW),
    "missed, unsafe": lambda m: refused(m, verdict=RED, outcome=OUT),
    "missed without a limit": lambda m: refused(m, deviation=WITHIN, outcome=replace(OUT, limits=())),
    "missed for lack of voltage": lambda m: refused(m, outcome=replace(OUT, limits=(("compliance voltage", 1.0),))),
    "reached": lambda m: refused(m, deviation=WITHIN, outcome=replace(OUT, reached=True)),
    "missed without words": lambda m: refused(m, THERMODE, outcome=Record(reached=False, reason=None)),
    "warnings": lambda m: m.Prepared(LOUD, AMBER, LOST, m.refusals_of(NARROWED, GREEN, LOST)).warnings,
}
