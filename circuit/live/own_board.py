"""A laboratory's board with what it holds beside the demands of the gate."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace

from ..delivery.export import Export
from ..delivery.formats import load_format
from ..delivery.formats.c_array import PLAYER, identifier
from ..play.board import Board
from ..play.watch import Numbers
from ..safety.demands import CutOff, Demands, HeldCutOff
from .controller import TURN_S

DIGEST = re.compile(r'#define THERMICON_DIGEST "([0-9a-f]+)"')
LATER_S = 1.0
"""What an answer and a turn of the board may take more than its rest."""


class OwnBoard(Board):
    """A board whose status has the names of demands.

    The gains of its loop and the lag of its sensors are not asked: a person states them.
    """

    def __init__(self, port: str, made: Export, clock: Callable[[], float]) -> None:
        icons = [each.delivery.icon.name for each in made.prepared]
        super().__init__(port, digest_of(made), sorted(icons, key=identifier), clock)

    def status(self) -> Mapping[str, object]:
        """Return what the board was compiled with, by the names of demands; it acts within a turn."""
        told, own = super().status(), self.settings
        return {
            "identity": told["identity"],
            "stopped": told["stopped"],
            "watchdog_s": own["watchdog"],
            "cut_off_display_C": CutOff(own["low_C"], own["high_C"], TURN_S),
            "held_cut_off_display_C": HeldCutOff(own["held_low_C"], own["held_high_C"], own["held"]),
            "current_limit_A": (own["low_A"], own["high_A"]),
        }


def digest_of(made: Export) -> str:
    """The digest of the player that is compiled for an export."""
    player = replace(made, form=load_format("c-array"), felt=()).files[PLAYER]
    found = DIGEST.search(player.decode("ascii"))
    assert found is not None
    return found[1]


def board_numbers(numbers: Numbers, demands: Demands) -> Numbers:
    """What the guard keeps to where the board tests the polarity and holds the rest by itself."""
    test = demands.test
    tested_s = test.off_before_s + test.test_s if test else 0.0
    return numbers._replace(test_polarity=False, rest_s=numbers.rest_s + tested_s + LATER_S)
