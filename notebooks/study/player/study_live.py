"""The display of a study on a device that plays by itself and must hear from this computer all the time.

Nothing here has a thread that feeds: the tick of the experiment calls keep(), and a device that has not heard from it
for a second switches off. The guard is that of play_icons.py, in steps.
"""

from __future__ import annotations

import argparse
import math
import re
import time
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from .study_answers import HERE, line_of, told
from .study_bench import Display, load_player

if TYPE_CHECKING:
    from thermicon.circuit.play.logged_line import LoggedLine

SILENCE_S, PROOF_S = 1.0, 1.3
"""A device hears nothing for this long at most; before the first play it must have switched off in the second time."""
OFF_BEFORE_S, OFF_AFTER_S = 5.0, 0.02
"""Logged before anything is put out, and after."""
LOOK_EVERY_S, LATER_S, READS_S = 0.05, 1.0, 0.005
"""Looks of the guard; what answers of a board may take more than its rest; waited in a tick for a look to end."""
HEADER = b"time_s,host_s,icon,event,set_point_C,probe_loop_C,probe_second_C,current_A,voltage_V\n"


class LiveDisplay(Display):
    """A display that is looked after in each keep(); `about` says in every log what it is.

    Its device proves before the first play that it switches off when this computer is silent.
    """

    def __init__(self, player: Any, line: LoggedLine, about: str, reads_s: float) -> None:
        self.player, self._line, self._about, self._reads_s = player, line, about, reads_s
        self.plays, self.error, self._thread = "send", None, None
        player.REACT_S = player.LATE_S = SILENCE_S  # the device protects
        player.LOOK_EVERY_S = min(player.LOOK_EVERY_S, LOOK_EVERY_S)
        self._guard, self._sensors = player._guard, (line.read, line.read_second)
        self._zero_s = self._flushed_s = self._now_s
        self._log: BinaryIO | None = None
        self._beginning: Iterator[float] | None = None
        self._due_s = 0.0
        self._icon = self._event = ""

    def log_into(self, path: Path) -> None:
        """Log each turn of the device into a new file from now on; times count as those of events do."""
        self._end_log()
        with told(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._log, self._event = path.open("xb"), self._about
            self._log.write(HEADER)

    def rest(self, drive: str) -> None:
        """Begin with the output off, a silence, the test of the polarity, and the rest."""
        self._beginning, self._due_s = self._begin_rest(drive), self._now_s

    def play(self, drive: str) -> None:
        """Begin a play, which the next calls of keep() carry on."""
        times, levels_C = self.player._rows(drive, "display_C")
        name, course = Path(drive).name, self.player._course(drive)
        rows = self._line.play_rows(name, list(zip(times, levels_C, strict=True)))
        self._guard.begin_play(self._line, rows, self._line.rest_row(name, levels_C[0]), course, self._sensors)
        self._take_rows()
        self._icon, self._event = Path(drive).stem, "play"
        self.keep()

    @property
    def busy(self) -> bool:
        """Whether the device begins, rests or plays."""
        return self._beginning is not None or self._guard.busy

    def keep(self) -> None:
        """Log, look and feed, and do what is due. Raises what stopped the device."""
        self._take_rows()
        if self._beginning is not None:
            if self._now_s >= self._due_s:
                self._due_s = self._now_s + next(self._beginning, math.inf)
            if self._due_s == math.inf:
                self._beginning = None
        elif self._guard.busy:
            self._guard.step(self._now_s)
            if self._guard.is_answered(self._reads_s):
                self._guard.step(self._now_s)
        else:
            self.player.keep()
            self._guard.is_answered(self._reads_s)
        if self._icon and not self.busy:
            self._icon, self._event = "", "end"

    def switch_off(self) -> None:
        """Switch off, and end the log."""
        try:
            self._line.off()
        finally:
            self._event = "output off"
            self.player.time.sleep(OFF_AFTER_S)
            self._end_log()

    @property
    def _now_s(self) -> float:
        return float(self.player.time.monotonic())

    def _begin_rest(self, drive: str) -> Iterator[float]:
        """Yields how many s to wait, unfed."""
        self._line.open()
        yield OFF_BEFORE_S
        self._event = "silence"
        self._line.test(0.0)
        yield PROOF_S
        stopped = str(self._line.status()["stopped"])
        if "silent" not in stopped:
            why = f"switched off by itself: {stopped}" if stopped else "did not switch off; set its watchdog to 1 s"
            raise self.player.Refused(f"after {PROOF_S:g} s of silence the device {why}")
        self._event = "polarity test and rest"
        level_C = self.player._rows(drive, "display_C")[1][0]
        self._guard.begin_rest(self._line, self._line.rest_row(Path(drive).name, level_C), self._sensors)

    def _take_rows(self) -> None:
        log, now_s = self._log, self._now_s
        path, self._log = Path(log.name if log else ""), None  # one that fails is not written to again
        for row in self._line.rows():
            cells = ("" if cell is None else f"{cell:.5f}" for cell in row[1:])
            times = (f"{time_s - self._zero_s:.4f}" for time_s in (row.time_s, now_s))
            if log is not None:
                with told(path):
                    log.write(line_of(path, [*times, self._icon, self._event, *cells]))
                self._event = ""
        if log is not None and now_s >= self._flushed_s + SILENCE_S:
            with told(path):
                log.flush()
            self._flushed_s = now_s
        self._log = log

    def _end_log(self) -> None:
        self._take_rows()
        log, self._log = self._log, None
        if log is not None:
            with told(Path(log.name)):
                log.close()


def live_display(study: Mapping[str, Any], chosen: argparse.Namespace, timer: Any) -> Display:
    """The display of a device that may play, by a clock with `monotonic` and `sleep`; else SystemExit."""
    live = study["live"]
    if chosen.bench is not None or chosen.channel is not None:
        raise SystemExit(f"--device {chosen.device} reads and feeds by itself; leave out --bench and --channel")
    if (chosen.device == "board") != (chosen.port is not None):
        raise SystemExit("--port belongs to --device board, which needs it, such as --port COM3")
    if chosen.device == "simulated":
        return _simulated(live["controller"], timer)
    if chosen.simulate:
        raise SystemExit("a board plays in real time; leave out --simulate, or give --device simulated")
    for label, demand in live["stated"].items():
        if not any(re.match(rf"{label}:.*\S.*,.*\S", text) for text in chosen.stated):
            raise SystemExit(
                f"nothing was put out, since nobody provides: {label} ({demand}); say who: --stated "
                f"'{label}: gains of the header, A. Name'"
            )
    from thermicon.circuit.play.board import Board

    board, player = Board(chosen.port, live["digest"], live["drives"], timer.monotonic), load_player()
    board.open()
    player.time = timer
    if player.TEST_POLARITY:  # the board does that by itself
        player.REST_S += player.OFF_BEFORE_TEST_S + player.TEST_S
        player.TEST_POLARITY = False
    player.REST_S += LATER_S
    return LiveDisplay(player, board, "; ".join([str(board.status()["identity"]), *chosen.stated]), READS_S)


def _simulated(settings: Mapping[str, Any], timer: Any) -> Display:
    from thermicon.circuit import Rig
    from thermicon.circuit.live.controller import SimulatedController
    from thermicon.circuit.safety.demands import Demands

    demands = import_module("pydantic").TypeAdapter(Demands).validate_python(settings)
    controller, player = SimulatedController(Rig.load(HERE / "rig.toml"), demands, timer.monotonic), load_player()
    player.time = timer
    return LiveDisplay(player, controller, str(controller.status()["identity"]), READS_S if timer is time else 1.0)
