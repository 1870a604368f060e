"""The gate of safety: a drive held against every rule, in the worst case of the rig and of what follows the cue."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass

from thermicon.circuit.inputs import signed
from thermicon.circuit.rig.parts import Uncertainty
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.rules import Limits
from thermicon.circuit.rig.uncertainty import surer
from thermicon.circuit.safety.limits import Check, as_dict, checks_of, colour_of, findings_of
from thermicon.circuit.safety.scenarios import ENDING_S, ENDINGS, play_out
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import steady_state

WHAT_IT_IS_NOT = (
    "This is a calculation, no medical or ethical clearance. Hardware that touches people needs a temperature cut-off "
    "of its own that works without any software."
)


@dataclass(frozen=True, slots=True)
class Gate:
    """The verdict on one drive.

    `checks` has every rule once, in the scenario that goes farthest; times count from the drive's first row. `after_C`
    is the skin of the rig as given, 60 s after the last sample, for each of ENDINGS; `drift_C` where zero current takes
    it in the end. Exposure is that of one playing.
    """

    rig_name: str
    duration_s: float
    uncertainty: Uncertainty
    limits: Limits
    scenarios: int
    checks: tuple[Check, ...]
    after_C: tuple[float, ...]
    drift_C: float

    def __repr__(self) -> str:
        return f"Gate({self.colour}: {len(self.checks)} rules in {self.scenarios} scenarios on {self.rig_name})"

    @property
    def findings(self) -> tuple[Check, ...]:
        """The rules that are passed, one for each quantity and side, the hard ones first."""
        return findings_of(self.checks)

    @property
    def colour(self) -> str:
        """Green, amber (only soft limits are passed) or red."""
        return colour_of(self.findings)

    @property
    def safe(self) -> bool:
        """Whether no hard limit is passed."""
        return self.colour != "red"

    @property
    def reason(self) -> str | None:
        """The first hard limit passed, in one sentence; None where there is none."""
        return next((str(finding) for finding in self.findings if finding.severity == "hard"), None)

    @property
    def cautions(self) -> tuple[str, ...]:
        """A sentence for each soft limit passed."""
        return tuple(str(finding) for finding in self.findings if finding.severity != "hard")

    @property
    def text(self) -> str:
        """The verdict as a table to read: every rule, its worst value, the limit, when, where and by whom."""
        return "\n".join(_lines(self))

    def to_dict(self) -> dict[str, object]:
        """All of it, as a sidecar holds it."""
        return {
            "colour": self.colour,
            "what_it_is_not": WHAT_IT_IS_NOT,
            "reason": self.reason,
            "limits": self.limits.to_dict(),
            "uncertainty": {**asdict(self.uncertainty), "smaller_than_shipped": list(surer(self.uncertainty))},
            "scenarios": self.scenarios,
            "ending_s": ENDING_S,
            "skin_after_ending_C": dict(zip(ENDINGS, self.after_C, strict=True)),
            "skin_in_the_end_at_zero_current_C": self.drift_C,
            "findings": [as_dict(finding) for finding in self.findings],
            "checks": [as_dict(check) for check in self.checks],
        }


def gate(
    drive: Drive,
    rig: Rig,
    *,
    rest_A: float | None = None,
    bridge_A: float | None = None,
    limits: Limits | None = None,
) -> Gate:
    """Hold a drive against every rule of safety, on the rig and in all corners of its uncertainty, and 60 s beyond.

    The drive is what the hardware gets, played open loop: one that ends in the middle of a ramp, as a design does,
    leaves that current on, and is judged so. `rest_A` in A has been held for ever before; None: the drive's first
    current. `bridge_A`: the current that a bridge switches, which makes `rest_A` and the last current of the drive
    means. `limits` takes the place of the rig's. Raises RigError where there is no rest to start from, DriveError for a
    rest that cannot be.

    >>> from thermicon.circuit import design
    >>> from thermicon.icons import load_library
    >>> rig = Rig.load("thenar")
    >>> plan = design(load_library("six-icons")["cooling-step"], rig, 8.0)
    >>> gate(plan.drive, rig, rest_A=plan.rest_A)
    Gate(red: 22 rules in 27 scenarios on thenar)
    >>> ended = Drive(plan.drive.time_s, [*plan.drive.current_A[:-1], plan.rest_A], held=True)
    >>> gate(ended, rig, rest_A=plan.rest_A)
    Gate(green: 22 rules in 27 scenarios on thenar)
    """
    held = rig.limits if limits is None else limits
    futures = play_out(drive, rig, rest_A=rest_A, bridge_A=bridge_A)
    columns, names = futures.columns, futures.names
    skin = columns["skin_C"][:: len(futures.corners), -1]
    return Gate(
        rig.name,
        futures.end_s,
        rig.uncertainty,
        held,
        len(names),
        checks_of(held, futures.time_s, columns, names),
        tuple(float(value) for value in skin),
        network_of(rig).read(steady_state(network_of(rig), 0.0), "skin_C"),
    )


def _lines(one: Gate) -> Iterator[str]:
    unsure = one.uncertainty
    yield (
        f"safety {one.colour.upper()}: {one.duration_s:.4g} s on {one.rig_name} and {ENDING_S:g} s after, in "
        f"{one.scenarios} scenarios (contact resistance ±{100 * unsure.contact_resistance_relative:g} %, ambient "
        f"±{unsure.ambient_K:g} K, gain ±{100 * unsure.gain_relative:g} %; {', '.join(ENDINGS)})"
    )
    table = [("", "rule", "worst", "limit", "at", "in", "source"), *(_row(one, check) for check in one.checks)]
    widths = [max(len(row[column]) for row in table) for column in range(len(table[0]) - 1)]
    for row in table:
        yield "  ".join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[-1]]).rstrip()
    after = ", ".join(f"{value:.1f} °C ({ending})" for value, ending in zip(one.after_C, ENDINGS, strict=True))
    yield f"skin {ENDING_S:g} s after the last sample, on the rig as given: {after}"
    yield f"zero current is not the baseline: in the end it takes the skin to {one.drift_C:.1f} °C"
    if one.limits.changed:
        yield f"limits changed by the rig: {'; '.join(one.limits.changed)}"
    if one.limits.loosened:
        yield f"limits LOOSENED: {'; '.join(one.limits.loosened)}. Reason given: {one.limits.reason}"
    if claims := surer(unsure):
        yield f"uncertainty SMALLER than shipped: {'; '.join(claims)}. Reason given: {unsure.reason}"
    yield "exposure is that of one playing; a session adds up its playings"
    yield WHAT_IT_IS_NOT


def _row(one: Gate, check: Check) -> tuple[str, ...]:
    mark = "ok" if check.passed else ("RED" if check.severity == "hard" else "amber")
    unit = "" if check.unit == "1" else f" {check.unit}"
    late = check.time_s - one.duration_s
    when = f"{check.time_s:.2f} s" + (f" ({late:.1f} s after)" if late > 0 else "")
    side = "≤" if check.upper else "≥"
    limit = f"{side} {signed(check.limit, '.4g')}{unit} {check.severity}"
    return mark, check.quantity, f"{signed(check.value, '.4g')}{unit}", limit, when, check.scenario, check.source
