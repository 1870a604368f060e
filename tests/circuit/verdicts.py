"""A made-up verdict for tests of the output after the gate."""

from types import SimpleNamespace

from thermicon.circuit.safety.demands import CutOff, Demands, Loop, PolarityCheck

CUT_OFF = CutOff(low=20.0, high=40.0, react_within_s=0.1)
POLARITY = PolarityCheck(
    True, off_before_s=10.0, test_current_A=0.2, test_s=0.5, display_change_at_least_K=0.15, swapped_skin_C=(31, 33)
)
LOOP = Loop((0.1, 0.2), (0.02, 0.05), 0.0, 0.02, 0.1, 0.3, 3.0, (0.19, 0.21), (0.04, 0.06), 0.1)
MADE_UP = Demands(
    0.4, CUT_OFF, POLARITY, rest_before_first_play_s=30.0, pause_at_least_s=20.0, zero_current_at_most_s=None, faults=()
)


class GreenVerdict:
    """A gate that is green and says what the hardware must prevent."""

    colour, reason, cautions, scenarios, findings, mended_by_pause = "green", None, (), 1, (), False

    def __init__(self, delivery: object) -> None:
        self.delivery = delivery

    notes: tuple[str, ...] = ()
    repeated = SimpleNamespace(recovery_s=None, shortest_pause_s=None)
    demands = MADE_UP
    demanded = MADE_UP.to_dict()

    def to_dict(self) -> dict[str, object]:
        return {"colour": "green"}
