"""Cases of what verdicts, notes and refusals say: both sides of each condition, on records made by hand."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace as Record
from typing import Any

import numpy as np

from tests.circuit.verdicts import CUT_OFF, LOOP, MADE_UP, POLARITY
from thermicon.circuit import Limits
from thermicon.circuit.delivery.delivered_drive import (
    DeliveryDeviation,
    Deviation,
    ModuleDrive,
    Narrowed,
    ThermodeDrive,
)
from thermicon.circuit.delivery.setpoints import Setpoints
from thermicon.circuit.rig.uncertainty import Uncertainty
from thermicon.circuit.safety.checks import Before, Check, Scenario
from thermicon.circuit.safety.demands import CutOff, Harm, HeldCutOff, SingleFault
from thermicon.circuit.safety.gate import Gate
from thermicon.circuit.safety.repeated import Repeated
from thermicon.circuit.solver.trace import Outcome
from thermicon.notebooks.report.blocks import Grid
from thermicon.perception.pilot.conditioning import Namings
from thermicon.perception.pilot.prediction import ChangedPrediction, Fit, PairFit, SetPrediction
from thermicon.perception.pilot.trials import Trials

SKIN = Check("skin surface", "hard", 42.004, 42.0, "°C", 1.0, 0.5, "a source", run=Scenario("a lane"))
COLD = replace(SKIN, value=14.5, limit=15.0, upper=False, time_s=nan, since_s=nan, run=Scenario())
KEPT = replace(SKIN, value=41.0, since_s=None, from_start_K=3.0)
SLOW = replace(SKIN, quantity="rate of skin temperature", value=12.0, limit=10.0, unit="K/s", since_s=2.0)
SOFT = replace(SKIN, severity="soft", limit=40.0)
FIRST = replace(SKIN, since_s=0.0)
HELD, HOT = HeldCutOff(22.0, 39.5, 8.2), Harm("display", 46.0, "°C")
NO_CORNER, NO_CUT_OFF = (0.0,) * 7, replace(CUT_OFF, react_within_s=0.0)


def fault(kind: str, **values: object) -> SingleFault:
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
}  # fmt: skip


def repeated(*checks: Check, **values: Any) -> Repeated:
    usual = {"pause_s": 30.0, "recovery_s": 12.0, "shortest_pause_s": 20.0, "plays": 40, "session_s": 1800.0}
    return Repeated(checks=checks, **{**usual, **values})


WORDS = {
    "corner, two": lambda m: m.corner_text((-0.3, *NO_CORNER[1:-1], 0.1)),
    "scenario, bare": lambda m: m.scenario_text(Scenario()),
    "scenario, all": lambda m: m.scenario_text(Scenario(NO_CORNER, "slow", Before("another", 3.0), "zero current")),
    **{
        f"scenario, {plays}": lambda m, plays=plays: m.scenario_text(Scenario("lane", before=Before(plays, 12.34567)))
        for plays in ("cycle", "warm", "cold", "once", "others")
    },
    "check, hard and just above": lambda m: m.check_text(SKIN),
    "check, below in any play": lambda m: m.check_text(COLD),
    "check, kept": lambda m: m.check_text(KEPT),
    "check, figures": lambda m: m.figures(replace(KEPT, value=41.99999)),
    "cures, one": lambda m: m.more_and_cure([SKIN, SOFT]),
    "cures, several": lambda m: m.more_and_cure([SKIN, SLOW, replace(SKIN, quantity="thermal dose", unit="min CEM43")]),
    "cures, hot plate": lambda m: m.more_and_cure([replace(SKIN, quantity="hot plate")]),
    "cures, baseline": lambda m: m.more_and_cure([FIRST]),
    "cures, soft alone": lambda m: m.more_and_cure([SOFT]),
    "repeated, no pause": lambda m: m.repeated_reason(repeated(SKIN, shortest_pause_s=None)),
    "repeated, too soon for hardware": lambda m: m.repeated_reason(
        repeated(SKIN, shortest_pause_s=40.0, faultless_pause_s=8.0)
    ),
    "repeated, too soon": lambda m: m.repeated_reason(repeated(pause_s=10.0, faultless_pause_s=8.0)),
    "repeated, just not too soon": lambda m: m.repeated_reason(repeated(pause_s=20.0, faultless_pause_s=8.0)),
    "what it is not": lambda m: m.WHAT_IT_IS_NOT,
    **{f"fault, {name}": lambda m, one=one: list(m.fault_table(one).values()) for name, one in FAULTS.items()},
    **{f"cure, {name}": lambda m, one=one: m.fault_cure(one) for name, one in list(FAULTS.items())[2:4]},
}


def gated(*findings: Check, demands: Any = MADE_UP, **values: Any) -> Gate:
    return Gate(
        "a rig", 8.0, Uncertainty(), Limits.shipped(), 10, findings, findings, {}, None, repeated(**values), demands
    )


def ready(name: str, verdict: Gate, *warnings: str) -> Any:
    return Record(delivery=Record(icon=Record(name=name)), verdict=verdict, warnings=warnings)


SLOW_CUT = replace(MADE_UP, cut_off_display_C=CutOff(20.0, 40.0, 0.0), faults=(FAULTS["stuck, nothing"],))
NEAR_CUT, NEARLY_CUT = (replace(SLOW_CUT, cut_off_display_C=CutOff(20.0, 40.0, react_s)) for react_s in (0.02, 0.0199))
LIMITED = replace(SLOW_CUT, faults=(FAULTS["stuck, current limit"],))
STRICT = replace(
    MADE_UP, watchdog_s=0.0, cut_off_display_C=CutOff(22.0, 39.0, 0.05), polarity_check=replace(POLARITY, needed=False),
    rest_before_first_play_s=0.0, pause_at_least_s=None, zero_current_at_most_s=300.0, current_limit_A=(-1.0, 1.2),
    loop=LOOP,
)  # fmt: skip
DRIVEN = replace(
    MADE_UP, held_cut_off_display_C=HELD, current_limit_A=(-1.2, 1.2), faults=(FAULTS["stuck fast, kept"],)
)
FAST = replace(DRIVEN, faults=(FAULTS["stuck fast, kept"], FAULTS["stuck fast, needed"], FAULTS["hang, watchdog"]))
PLAIN, AMBER = gated(), replace(gated(), repeated=repeated(SOFT))


def of(*demands: Any) -> list[tuple[str, Gate]]:
    return [(name, gated(demands=one)) for name, one in zip("ab", demands, strict=False)]


GATE_WORDS = {
    "none": lambda m: m.gate_words([ready("a", gated(SKIN))]),
    "one": lambda m: m.gate_words([ready("a", PLAIN), ready("b", gated(SKIN)), Record(verdict=None, delivery=None)]),
    "two": lambda m: [about for about, _ in m.gate_words([ready("a", PLAIN), ready("b", PLAIN)])],
    "stuck": lambda m: m.gate_words([ready("a", gated(demands=SLOW_CUT))]),
    "stuck, two cures": lambda m: m.stuck_text(of(SLOW_CUT, LIMITED)),
    "stuck, just too slow": lambda m: m.stuck_text(of(NEARLY_CUT)),
    "stuck, just quick enough": lambda m: (m.stuck_text(of(NEAR_CUT)), m.demands_text(of(NEAR_CUT))),
    "stuck fast": lambda m: (m.stuck_fast_text(of(DRIVEN, FAST)), m.stuck_fast_text(of(DRIVEN, MADE_UP))),
    "stuck fast, in lines": lambda m: [about for about, _ in m.gate_words([ready("a", gated(demands=FAST))])],
    "demands, of a driver": lambda m: m.demands_text(of(DRIVEN, MADE_UP)),
    "demands, too slow": lambda m: m.demands_text(of(replace(DRIVEN, cut_off_display_C=NO_CUT_OFF))),
    "repeated, unlike": lambda m: m.repeated_text([
        ("a", gated(recovery_s=None, plays=30, faultless_pause_s=8.0, shortest_pause_s=None)),
        ("b", AMBER),
    ]),
    "repeated, recoveries": lambda m: m.repeated_text([("a", gated(recovery_s=30.0)), ("b", gated(recovery_s=12.0))]),
    "repeated, faults need no more": lambda m: m.repeated_text([("a", gated(faultless_pause_s=20.0))]),
    "repeated, seven amber": lambda m: m.repeated_text([
        *((f"i{k}", AMBER) for k in range(7)),
        ("green", PLAIN),
    ]),
    "demands, strict": lambda m: m.demands_text(of(STRICT)),
    "demands, of two": lambda m: m.demands_text(of(MADE_UP, STRICT)),
    "demands, no rest": lambda m: m.demands_text(of(
        replace(MADE_UP, rest_before_first_play_s=None, pause_at_least_s=0.0, polarity_check=None))),
    "warnings": lambda m: list(m.warning_lines(
        [ready("a", PLAIN, "0.5 K off", "else"), *(ready(name, PLAIN, "0.7 K off") for name in "bc")])),
    "spread": lambda m: m.spread_text(Record(step_K=(-5.0, 6.0), baseline_C=(31.0, 33.0))),
    "steps of a module": lambda m: m.steps_of(Record(played=None, rate_Hz=99.96)),
    "steps of a thermode": lambda m: m.steps_of(thermode()),
    "caution": lambda m: m.CAUTION,
}  # fmt: skip


OUT = Outcome(False, -1.2, 3.0, 0.4, (("current limit", 2.5),))
LOST = DeliveryDeviation((Deviation("cold receptor", 0.3, 1.0, 0.2), Deviation("warm receptor", 0.3, 1.0, 0.4)))
WITHIN = DeliveryDeviation((Deviation("cold receptor", 0.1, 1.0, 0.05), Deviation("skin", 9.0, 1.0, 9.0)))
NARROW = Narrowed("D plays at most 0.5 A", 0.5, replace(OUT, reached=True))
RED, DRIVER = gated(SKIN), Record(current_max_A=1.5, voltage_limit_V=12.0)
PAUSE = Gate("", 8.0, Uncertainty(), Limits.shipped(), 10, (SKIN,), (), {}, None, repeated(SKIN), MADE_UP)


def delivered(**values: Any) -> ModuleDrive:
    device = Record(name="D", unit="A", kind=Record(switches=False), driven_by="amperes")
    usual = {
        **{"icon": None, "rig": Record(driver=DRIVER, controller=None), "device": device, "requested_Hz": 100.0},
        **{"rate_Hz": 90.0, "played": Record(scale=Record(step=0.01)), "designed_trace": None, "outcome": None},
        **{"trace": Record(beyond=()), "designed": None, "delivered": None},
    }
    return ModuleDrive(**{**usual, **values})


def thermode(**values: Any) -> ThermodeDrive:
    one = delivered()
    usual = {
        name: getattr(one, name) for name in ("icon", "rig", "device", "requested_Hz", "rate_Hz", "trace", "outcome")
    }
    played = Setpoints(0.1, 0.5, 64, ((10, 60),))
    return ThermodeDrive(**{**usual, "designed_trace": None, "prompt_trace": None, "played": played, **values})


LOOPED = Record(**{**vars(delivered().device), "driven_by": "temperatures"})
BRIDGE = Record(**{**vars(delivered().device), "kind": Record(switches=True)})


def refused(m: Any, delivery: Any, verdict: Any = PLAIN, deviation: Any = WITHIN) -> list[object]:
    return [
        (one.text, one.tells, dict(one.changes), one.forcible) for one in m.refusals_of(delivery, verdict, deviation)
    ]


PREPARE = {
    "unsafe, mended by a pause": lambda m: refused(m, delivered(), PAUSE, LOST),
    "unsafe without a finding": lambda m: refused(m, delivered(), Record(
        colour="red", reason=None, mended_by_pause=False, repeated=repeated(), findings=())),
    "lossy and narrowed": lambda m: refused(m, delivered(narrowed=NARROW), PLAIN, LOST),
    "lossy, the range misses": lambda m: refused(m, delivered(narrowed=replace(NARROW, outcome=OUT)), PLAIN, LOST),
    "lossy by set-points": lambda m: refused(m, thermode(device_warnings=("w",)), PLAIN, LOST),
    "lossy by warnings": lambda m: refused(m, delivered(device_warnings=("w", "v")), PLAIN, LOST),
    "lossy by its loop": lambda m: refused(m, delivered(device=LOOPED), PLAIN, LOST),
    "lossy by its rate": lambda m: refused(m, delivered(device=LOOPED, rate_Hz=89.9), PLAIN, LOST),
    "lossy by its duty": lambda m: refused(m, delivered(device=BRIDGE), PLAIN, LOST),
    "missed": lambda m: refused(m, delivered(outcome=OUT), PLAIN, LOST),
    "missed and narrowed": lambda m: refused(m, delivered(outcome=OUT, narrowed=NARROW), PLAIN, LOST),
    "missed, unsafe": lambda m: refused(m, delivered(outcome=OUT), RED),
    "missed without a limit": lambda m: refused(m, delivered(outcome=replace(OUT, limits=()))),
    "missed for lack of voltage": lambda m: refused(m, delivered(
        outcome=replace(OUT, limits=(("compliance voltage", 1.0),)))),
    "reached": lambda m: refused(m, delivered(outcome=replace(OUT, reached=True))),
    "missed without words": lambda m: refused(m, thermode(outcome=Record(reached=False, reason=None))),
    "warnings": lambda m: m.Prepared(
        delivered(device_warnings=("w", NARROW.text)), gated(SOFT), LOST,
        m.refusals_of(delivered(narrowed=NARROW), PLAIN, LOST)).warnings,
}  # fmt: skip


def conditioned(draws: int, **values: Any) -> Record:
    return Record(
        **{"before": [0] * 400, "after": [0] * draws, "effective": 55.4, "effective_after": 30.0, "rounds": 0, **values}
    )


def pair(number: int, missed: bool = True, observed: float = 0.3) -> PairFit:
    return PairFit(f"a{number}", f"b{number}", 20, observed, 0.2, (0.1, 0.25), missed)


def fit(p: float = 0.4, pairs: Any = (), p_people: float | None = None) -> Fit:
    return Fit(p, p_people, (0.7, 0.6, 0.8), (1.2, 1.0, 1.4), tuple(pairs))


def answers(count: int = 20, unanswered: int = 0, people: int = 1, **values: Any) -> Any:
    """So many answers of each of some people, all of them x, to x and y by turns."""
    counts = np.tile([[count // 2, 0], [count - count // 2, 0]], (people, 1, 1)).astype(float)
    missing = np.tile([unanswered, 0], (people, 1)).astype(float)
    trials = Trials(("x", "y"), tuple(f"p{k}" for k in range(people)), counts, unanswered=missing, **values)
    data = object.__new__(Namings)
    object.__setattr__(data, "trials", trials)
    return data


def change(title: str, width: float) -> ChangedPrediction:
    """A set's prediction, 0.2 wide before, and after."""
    ends = (0.7 - width / 2.0, 0.7 + width / 2.0)
    before, after = (SetPrediction(title, 50, (0.7, *span), (1.2, 1.0, 1.4)) for span in ((0.6, 0.8), ends))
    return ChangedPrediction(before, after)


def named(
    before: Fit | None = None, after: Fit | None = None, draws: int = 100, data: Any = None, **values: Any
) -> Any:
    usual = {"conditioned": conditioned(draws), "predictions": (change("A set", 0.1),), "constants": (), "prior": PRIOR}
    return Record(**{**usual, "data": data or answers(), "fit": before or fit(), "fit_after": after or fit(), **values})


def measured(
    p: float = 0.4, after: float = 0.4, missed: bool = False, total: int = 6, draws: int = 100, **values: Any
) -> Any:
    condition = Record(unit="K", label="cool", kind="threshold")
    fits = [
        Record(
            p=q,
            conditions=(
                Record(condition=condition, participants=4, observed=1.234, predicted=(1.1, 0.9, 1.4), missed=missed),
            ),
        )
        for q in (p, after)
    ]
    data = Record(measurements=Record(**{"total": total, "assumed_errors": 0, "conditions": (condition,), **values}))
    return named(fits[0], fits[1], draws, data)


def sealed(own: float, best: float, chance: float = 0.1) -> Any:
    prediction = Record(source="a.json", version="0.1", sha256="abc")
    scores = {"it": (own, 0.7), "chance": (-2.0, 0.5), "rules": (own, 0.6), "best": (best, 0.8)}
    return Record(sealed=prediction, scores=scores, chance_bits=chance, trials=40, observed_correct=0.75)


def shown(blocks: Any) -> list[object]:
    """Texts, points, columns and cells of blocks of a report."""
    return [
        [block.columns, *([cell.text for cell in row] for row in block.rows), block.numbers]
        if isinstance(block, Grid)
        else getattr(block, "points", None) or block.text
        for block in blocks
    ]


MOVED = Record(constant="gain", unit="1", before=(1.0, 0.5, 2.0), after=(1.1, 0.9, 1.3))
PRIOR = Record(draws=Record(header=Record(offsets=("lab offset",))))
PILOT = {
    "opened, kept": lambda m: shown(m.opened_report(sealed(-1.2, -1.0))),
    "opened, promised more": lambda m: shown(m.opened_report(sealed(-1.21, -1.0)))[-1],
    "opened, did better": lambda m: shown(m.opened_report(sealed(-0.79, -1.0)))[-1],
    "observed": lambda m: shown(m.observed_report(named(), ["a/six.cue"], "The end.")),
    "measured": lambda m: shown(m.observed_report(measured(), ["a/six.cue"])),
    "untitled": lambda m: shown(m.observed_report(named(predictions=(change("", 0.2),)), ["six.cue"]))[0],
    "as wide": lambda m: shown([m.sets_table(named(predictions=(change("", 0.2),)), ["six.cue"])]),
    "wider": lambda m: shown([m.sets_table(named(predictions=(change("", 0.202),)), ["six.cue"])]),
    "few draws": lambda m: (shown([m.sets_table(named(draws=99), ["six.cue"])]), m.draws_sentences(named(draws=99))),
    "fresh ones of answers": lambda m: m.draws_sentences(
        named(conditioned=conditioned(100, rounds=1, effective_after=29.0))),
    "fresh ones of values": lambda m: m.draws_sentences(named(data="values", conditioned=conditioned(100, rounds=2))),
    "few carry": lambda m: m.draws_sentences(named(data="values", conditioned=conditioned(100, effective_after=29.9))),
    "constants": lambda m: shown(m.constants(named(constants=[MOVED, Record(constant="lab offset")]))),
    "nine constants": lambda m: len(shown(m.constants(named(constants=[MOVED] * 9)))[1]),
    "values, missed": lambda m: shown(m.measured_blocks(measured(missed=True, assumed_errors=1))),
    "values, too few": lambda m: m.measured_sentences(measured(total=5)),
    "values, a rating": lambda m: m.measured_sentences(measured(conditions=(Record(kind="rating"),))),
    "values, unlike": lambda m: m.measured_sentences(measured(p=0.01, after=0.049)),
    "21 people": lambda m: shown([m.people_table(answers(2, people=21))])[0][-3:],
    "one group": lambda m: shown([m.people_table(answers(grouped=True))]),
    "unanswered": lambda m: (
        shown([m.people_table(answers(unanswered=4))]), m.observed_sentences(answers(unanswered=4)),
        m.fit_sentences(named(data=answers(unanswered=4)))[0]),
    "said of a group": lambda m: m.observed_sentences(answers(grouped=True, passed=3)),
    "said of one answer": lambda m: m.observed_sentences(answers(1))[-1],
    "fit": lambda m: m.fit_sentences(named(fit(0.05, p_people=0.2))),
    "fit, near": lambda m: m.fit_sentences(named(fit(0.0999)))[1],
    "fit, allowed": lambda m: m.fit_sentences(named(fit(0.1)))[1],
    "fit, one answer": lambda m: m.fit_sentences(named(data=answers(1)))[1],
    "fit, 19 answers": lambda m: m.fit_sentences(named(data=answers(19)))[1],
    "fit, unlikely": lambda m: m.fit_sentences(named(fit(0.3), fit(0.0499), 99))[1],
    "fit, kept by few": lambda m: m.fit_sentences(named(fit(0.3), fit(0.05), 99))[1],
    "fit, more pairs": lambda m: m.fit_sentences(named(fit(pairs=[pair(k, k < 3) for k in range(15)])))[1],
    "pairs": lambda m: shown(m.pairs(
        fit(pairs=[pair(0), pair(1, observed=0.1), *(pair(k, False) for k in range(28))]))),
    "nine pairs": lambda m: shown(m.pairs(fit(pairs=[pair(k) for k in range(9)])))[1][-1],
    "p": lambda m: [m.p_text(p) for p in (0.0099, 0.01)],
    "misfit": lambda m: [m.misfit(0.04, 0.3, "values", 500), m.misfit(0.3, 0.04, "values", 100, "; cure")],
}  # fmt: skip
