"""Live play on a page that can stop it."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anywidget
import ipywidgets as widgets
import traitlets

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import InputError
from thermicon.circuit import Device, Rig
from thermicon.circuit.rig.rig import AnyRig
from thermicon.icons import Icon
from thermicon.icons.files.shipped import Icons, by_name

from ..report.blocks import fragment, shown
from .live_view import BackgroundJob, BackgroundWorker, button, safely

if TYPE_CHECKING:
    from thermicon.circuit.live.play_live import LiveResult
    from thermicon.circuit.play.logged_line import LineRow

    from ..figures.live_figure import LiveFigure

DEVICES = (("simulated controller", "simulated"), ("a board of your own", "board"))
EVERY_S = 0.2
"""How often the figure is drawn anew."""
UNHEARD_S = 3.0
"""A page that is closed or run anew, or a notebook that is busy for so long, cannot stop a device: the play ends."""
FIELDS: Mapping[str, str] = {
    "port": "/dev/ttyACM0 or COM5, of a board",
    "folder": "a new folder for logs; none: no logs",
    "stated": "DEMAND: WHAT, WHO: what a person provides, not the device",
}
STOP_KEY = """
function render({ model }) {
  const pressed = (event) => {
    const typing = event.target.closest?.("input:not([type=checkbox]), textarea, select, [contenteditable]");
    if (!model.get("plays") || !(event.key === "Escape" || (event.key === " " && !typing))) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    model.send("stop");
  };
  const beat = setInterval(() => model.get("plays") && model.send("here"), 500);
  document.addEventListener("keydown", pressed, true);
  return () => {
    clearInterval(beat);
    document.removeEventListener("keydown", pressed, true);
  };
}
export default { render };
"""
Wanted = Callable[[], tuple[Sequence[Icon], Sequence[str], Rig]]


class StopKey(anywidget.AnyWidget):
    """While a device plays, Space anywhere on the page but in a text, and Escape, are a message."""

    _esm = STOP_KEY
    plays = traitlets.Bool(default_value=False).tag(sync=True)


class LivePanel:
    """Controls, state and figure of live play; ``box`` is what is shown.

    ``wanted`` returns the icons of the set, the names in the order of play, and the rig. ``playing`` is called with
    True when a play begins, and with False when the output is off again. Icons are played in a thread, and only while
    the page can stop them.
    """

    timer = time.monotonic, time.sleep
    """Clock and sleep of a play, s."""

    def __init__(self, wanted: Wanted, playing: Callable[[bool], None] = lambda on: None) -> None:
        self._wanted, self._playing = wanted, playing
        self.on = False
        self.result: LiveResult | None = None
        self._worker = BackgroundWorker(self._failed)
        self._why, self._heard_s = "", 0.0
        self._figures: dict[str, LiveFigure] = {}
        self._rows: list[LineRow] = []
        self._name, self._begun = "", 0
        self.device = widgets.Dropdown(options=DEVICES, description="device")
        self.fields = {
            name: widgets.Text(placeholder=hint, description=name, continuous_update=False)
            for name, hint in FIELDS.items()
        }
        self.amber = widgets.Checkbox(description="play what the gate judges amber", indent=False)
        for control in (self.device, *self.fields.values()):
            control.layout.width = "100%"
            control.style.description_width = "52px"
        self.start = button("▶ Play on the device", "", lambda: safely(self.play, self._failed))
        self.check = button("Check", "", lambda: safely(partial(self.play, checks_only=True), self._failed))
        self.halt = button("■ Stop", "", partial(self.stop, "the Stop button"), button_style="danger", disabled=True)
        self.key = StopKey()
        self.key.on_msg(lambda _, message, __: self._hear() if message == "here" else self.stop("Space or Escape"))
        self.said = {name: widgets.HTML() for name in ("status", "figure", "report")}
        buttons = widgets.Box([self.start, self.check, self.halt, self.key]).add_class("thermicon-row")
        controls = [self.device, *self.fields.values(), self.amber, buttons, self.said["status"]]
        left = widgets.VBox(controls, layout={"flex": "1 1 260px"})
        right = widgets.VBox([self.said["figure"], self.said["report"]], layout={"flex": "2 1 500px", "min_width": "0"})
        self.box = widgets.VBox([widgets.Box([left, right]).add_class("thermicon-row")]).add_class("thermicon-live")
        self._say("written from documents: no device was ever driven; a computer that hangs cannot stop anything")

    def play(self, *, checks_only: bool = False) -> None:
        """Begin to play, or only to show how each demand is met; raises InputError for what cannot be played."""
        if self.on:
            raise InputError("a device plays already")
        try:
            loop = asyncio.get_running_loop()
        except RuntimeError:
            raise InputError("there is no notebook that could stop it: use thermicon.circuit.play_live") from None
        from thermicon.circuit.live.play_live import check_empty

        icons, names, rig = self._wanted()
        port, folder, stated = (field.value.strip() for field in self.fields.values())
        if (self.device.value == "board") != bool(port):
            raise InputError("a port belongs to a board, which needs one")
        where = Path(folder).expanduser() if folder and not checks_only else None
        if where is not None:
            check_empty(where)
        how = {
            "amber": self.amber.value,
            "folder": where,
            "stated": [stated] if stated else [],
            "port": port or None,
            "checks_only": checks_only,
        }
        played = icons if port else [icon for icon in icons if icon.name in names]
        self.on, self.result, self._why = True, None, ""
        self._figures, self._rows, self._name = {}, [], ""
        self._allow()
        self.said["figure"].value = self.said["report"].value = ""
        self._say("judging …")
        self.halt.focus()
        self._playing(True)
        self._hear()
        self._follow(loop)
        self._worker.ask(partial(self._work, icons=played, names=names, rig=rig, how=how))

    def stop(self, why: str = "a person") -> None:
        """Switch the output off; it is off within a tick of the player."""
        if not self.on:
            self._say("nothing plays")
            return
        self._why = self._why or why
        self._say(f"stopping: {self._why} …", "th-bad")

    def tell(self) -> None:
        """Say to a page that was opened later whether a device plays."""
        self._playing(self.on)

    def _work(
        self, job: BackgroundJob, icons: Sequence[Icon], names: Sequence[str], rig: Rig, how: Mapping[str, Any]
    ) -> None:
        """In a thread: judge, and play."""
        from thermicon.circuit.delivery.delivered_drive import ModuleDrive
        from thermicon.circuit.live.play_live import play_export
        from thermicon.circuit.live.ready import CONTROLLER, judged
        from thermicon.circuit.play.watch import Stopped

        from ..figures.live_figure import LiveFigure
        from ..report.play_report import check_report, play_report

        def tell(text: str) -> None:
            if text == f"plays {self._name}":
                self._begun = len(self._rows)
            job.on_page(partial(self._say, f"{text} …", "th-caution"))

        try:
            made = judged(tuple(icons), rig, Device.load(CONTROLLER), None)
            drives = [each.delivery for each in made.prepared]
            self._figures = {
                each.icon.name: LiveFigure(each.icon.name, each.trace)
                for each in drives
                if isinstance(each, ModuleDrive) and each.icon.name in names
            }
            if self._why:
                raise Stopped(f"{self._why}; nothing was put out")
            self._hear()  # judging may have kept the processor; the output is off for longer than a page may be silent
            how = {**how, "timer": self.timer, "why_stop": self._why_stop, "tell": tell, "seen": self._seen}
            result = play_export(made, names, real_time=True, **how)
        finally:
            job.on_page(self._off)
        report = check_report(result) if how["checks_only"] else play_report(result)
        job.on_page(partial(self._finish, result, shown(*report)))

    def _why_stop(self) -> str:
        if not self._why and time.monotonic() - self._heard_s > UNHEARD_S:
            self._why = f"for {UNHEARD_S:g} s nobody could have stopped it: the page is closed, or the notebook busy"
        return self._why

    def _seen(self, name: str, rows: Sequence[LineRow]) -> None:
        if name != self._name:
            self._name, self._rows, self._begun = name, [], 0
        self._rows += rows

    def _hear(self) -> None:
        """A sign of life of the page, which comes as a press of Stop would."""
        self._heard_s = time.monotonic()

    def _follow(self, loop: asyncio.AbstractEventLoop) -> None:
        if self.on:
            loop.call_later(EVERY_S, self._follow, loop)
            safely(self._draw, lambda wrong: self.stop(f"the page failed: {wrong}"))

    def _draw(self) -> None:
        figure, rows = self._figures.get(self._name), self._rows[self._begun :]
        if figure is None or not rows or not self._begun:
            return
        time_s = [row.time_s - rows[0].time_s for row in rows]
        self.said["figure"].value = figure.svg(time_s, [row.loop_C for row in rows])

    def _off(self) -> None:
        self.on = False
        self._draw()
        self._allow()
        self._playing(False)

    def _finish(self, result: LiveResult, report: str) -> None:
        self.result = result
        self.said["report"].value = report
        if result.stopped:
            self._say(f"stopped: {result.stopped}; the output is off", "th-bad")
        else:
            self._say("done; take the hand off: without power the display drifts by itself", "th-good")

    def _failed(self, message: str) -> None:
        self._say(f"refused: {message}", "th-bad")

    def _allow(self) -> None:
        self.start.disabled = self.check.disabled = self.key.plays = self.on
        self.halt.disabled = not self.on

    def _say(self, text: str, kind: str = "th-status") -> None:
        self.said["status"].value = fragment("marked", text, f"{kind} th-wrap")


class LivePlay(LivePanel):
    """Live play of icons in a notebook: **Play**, a red **Stop**, and the display that is measured as it comes.

    A device plays only while the page can stop it: a page that is closed, a cell that is run anew, or a kernel that
    hears nothing of the page for three seconds ends the play. In a script use `thermicon.circuit.play_live`.

    Parameters
    ----------
    icons
        A set, its name or file, or icons.
    rig
        The rig, or the name or file of one; None: the shipped rig of the icons' site, else thenar.
    order
        Names in the order in which they are played, which may repeat; empty: each icon once.

    Raises
    ------
    InputError
        For icons, names and rigs that there are not.

    Examples
    --------
    >>> live = LivePlay("six-icons", "thenar", order=["double-dip"])
    >>> live.on, live.halt.disabled
    (False, True)
    """

    @checked
    def __init__(self, icons: Icons, rig: AnyRig = None, order: Sequence[str] = ()) -> None:
        known = by_name(icons)
        if not known:
            raise InputError("there is no icon to play; give at least one")
        if unknown := [name for name in order if name not in known]:
            raise InputError(f"{unknown[0]} is not among the icons: {', '.join(known)}")
        chosen = tuple(known.values())
        on = Rig.of(rig, chosen[0].context.site)
        super().__init__(lambda: (chosen, tuple(order) or tuple(known), on))

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        return {**self.box._repr_mimebundle_(include=include, exclude=exclude), "text/plain": repr(self)}

    def __repr__(self) -> str:
        return f"LivePlay({'playing' if self.on else self.result or 'nothing was played'})"
