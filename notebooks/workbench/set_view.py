"""The set view: how people confuse the icons of a set."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ipywidgets as widgets

from thermicon.circuit import Rig
from thermicon.perception import Goal, Ranking, cheapest_edit
from thermicon.perception.identification.map import PerceptualMap
from thermicon.perception.plots.draw_map import plot_map
from thermicon.perception.selection.edit import Edit, NoEdit

from ..editing.cue_check import read_text
from ..editing.number_literals import with_edit
from ..figures.print_figure import themed_svg
from ..figures.style import new_figure
from ..report.blocks import Bullets, fragment, shown
from ..report.rank_report import rank_report
from ..report.set_report import SetReport
from ..report.sets_report import sets_report
from .design_model import DesignModel
from .design_view import SideCanvas
from .live_view import BackgroundJob, BackgroundWorker, LiveView, button
from .set_model import QUICK, WELL, RankedSet, SetRequest, draws_of, heat_frame, overlay_frame, rank_set, why_not
from .view_blocks import edit_html, pair_html, set_html

ShowText = Callable[[str], None]
SHARES = 10
MAP_INCHES = (3.7, 3.3)
WIDE, BESIDE = "1 1 500px", 6
"""Table and heat maps are side by side for at most this number of icons."""


class SetView(LiveView[SetRequest]):
    """The set of one ``DesignModel``, ranked while its tab is ``shown``; ``box`` holds the widgets.

    ``show_text`` is called with the text after an edit is applied; ``known`` gives the ranking of a request without
    intervals, where another view has made it, and ``pinned`` that of the pinned version.
    """

    settles_s = 0.25

    def __init__(
        self,
        design: DesignModel,
        show_text: ShowText,
        known: Callable[[SetRequest], Ranking | None] = lambda _: None,
        pinned: Callable[[], Ranking | None] = lambda: None,
    ) -> None:
        super().__init__(design)
        self._known, self._pinned = known, pinned
        self._show_text = show_text
        self.made: RankedSet | None = None
        self.picked: tuple[str, str] | None = None
        self.edit: Edit | NoEdit | None = None
        self.editor, self.chooser = BackgroundWorker(self._no_edit), BackgroundWorker(self._no_choice)
        self.heat, self.overlay = SideCanvas("heat"), SideCanvas("traces")
        self.heat.on_message(lambda message: self._safely(lambda: self._cell(message)))
        names = ("scores", "status", "choice", "versions", "table", "notes", "pair", "edit_text", "why", "map")
        self.said = {name: widgets.HTML() for name in (*names, "caveat")}
        html = self.said
        self.apply = widgets.Button(description="Apply edit", disabled=True, layout={"width": "100px"})
        self.apply.on_click(lambda _: self._safely(self.apply_edit))
        self.count = widgets.BoundedIntText(value=3, min=2, description="best", layout={"width": "96px"})
        self.count.style.description_width = "32px"
        choose = button("Choose", "as thermicon improve --choose does", lambda: self._safely(self.choose_best))
        ask = widgets.Box([self.count, choose]).add_class("thermicon-ask")
        top = _row(html["scores"], html["status"], ask).add_class("thermicon-top")
        table = self._table = widgets.VBox([html["table"]]).add_class("thermicon-side")
        self._maps = widgets.VBox([self.heat], layout={"flex": WIDE, "min_width": "0"})
        overlay = widgets.VBox([self.overlay], layout={"flex": "3 1 400px", "min_width": "0"})
        reasons = widgets.VBox([html["pair"], html["edit_text"], self.apply, html["why"]], layout={"flex": "3 1 300px"})
        placed = widgets.VBox([html["map"]], layout={"flex": "2 1 270px", "min_width": "0"})
        self._below = _row(overlay, reasons, placed).add_class("thermicon-pair")
        self.body = widgets.VBox([_row(table, self._maps), html["notes"], self._below, html["caveat"]])
        html["caveat"].add_class("thermicon-safety")
        html["choice"].add_class("thermicon-choice").layout.display = "none"
        self.box = widgets.VBox([top, html["choice"], html["versions"], self.body]).add_class("thermicon-set")
        self.body.layout.display = "none"
        self.stale_parts = self.body, html["scores"], html["choice"]
        self._say("the set is ranked when this tab opens")

    def _mark_outdated(self, request: SetRequest) -> None:
        self._mark(self.made is not None and request != self._source())

    def _obstacle(self, request: SetRequest) -> str | None:
        reason = why_not(read_text(request[0]))
        if reason is None or self.made is None:
            return reason
        return f"{reason}; the last valid set is shown, for {self.made.ranking.people} people"

    def _job(self, request: SetRequest) -> Callable[[BackgroundJob], None]:
        self._say("ranking …")
        self.chooser.forget()
        self._show_choice("")
        return lambda job: self._rank(job, request)

    def _show_finished(self) -> None:
        if self.made is not None:
            self._say(f"{self.made.ranking.people} people")
            self._compare(self.made.ranking)

    def _compare(self, ranking: Ranking) -> None:
        """The set beside that of the pinned version, as ``thermicon compare`` does."""
        before, other = self.design.pinned, self._pinned()
        html = ""
        if before is not None and other is not None and before.request != self._source():
            table, *_, last = sets_report(("pinned", "now"), (other, ranking))
            html = shown(table, last)
        self.said["versions"].value, self.said["versions"].layout.display = html, "" if html else "none"

    def pick(self, a: str, b: str) -> None:
        """Select a pair: show both icons together, why they are confused, and the cheapest edit."""
        made = self.made
        if made is None:
            return
        self.picked, self.edit = (a, b), None
        frame = overlay_frame(made, self.design.observer, a, b)
        self.overlay.frame(frame.meta, frame.buffers)
        self._below.layout.display = ""
        self.apply.disabled = True
        if a == b:
            self.editor.forget()
            self.said["pair"].value = fragment("block", a, "th-head")
            self.said["why"].value = ""
            hint = "select a cell of two different icons to see what separates them"
            self.said["edit_text"].value = fragment("marked", hint, "th-soft")
            return
        pair = made.pair(a, b)
        self.said["pair"].value, self.said["why"].value = pair_html(pair), shown(Bullets(pair.why))
        self.said["edit_text"].value = edit_html(None)

        def look(job: BackgroundJob) -> None:
            found = cheapest_edit(made.ranking, a, b)
            job.on_page(lambda: self._offer_edit(found))

        self.editor.ask(look, 0.1)

    def apply_edit(self) -> None:
        """Apply the suggested edit to the text, as one step that can be undone."""
        edit = self.edit
        if not isinstance(edit, Edit):
            raise ValueError("there is no edit to apply")
        text = with_edit(self.design.text, edit.edited, edit.old, edit.new)
        self.apply.disabled = True
        self.said["edit_text"].value = fragment("marked", f"applied: {edit.new}", "th-good")
        self._show_text(text)

    def choose_best(self) -> None:
        """Choose the best few icons for the goal of the text, as ``thermicon improve --choose`` does."""
        text, rig = self._request()
        if (reason := why_not(read_text(text))) is not None:
            raise ValueError(reason)
        count, goal = self.count.value, self.design.document.goal
        self._show_choice(fragment("marked", "choosing …", "th-status"))
        self.chooser.ask(lambda job: self._choose(job, text, rig, count, goal))

    def _choose(self, job: BackgroundJob, text: str, rig: Rig, count: int, goal: str) -> None:
        from ..report.set_report import chosen, objective_of

        icons, model, wanted = read_text(text).icons, self.design.model, Goal.parse(goal) if goal else None
        assert icons is not None
        how = {"goal": wanted, "people": WELL[0], "parameters": draws_of(model), "observer": model}
        made = chosen(icons, rig, count, objective_of(wanted), None, False, how)
        told = [part for part in rank_report(made, "")[:-1] if part.type in ("heading", "text", "bullets")]
        job.on_page(lambda: self._show_choice(shown(*told)))

    def _show_choice(self, html: str) -> None:
        self.said["choice"].value, self.said["choice"].layout.display = html, "" if html else "none"

    def _rank(self, job: BackgroundJob, request: SetRequest) -> None:
        """The background job: a quick ranking with a few people, then one with enough for the final numbers."""
        if self.made is None or request != self._source():
            first = self._ranked(request, QUICK, job.go_on)
            job.on_page(lambda: self._show(first, request, False))
        reported = 0

        def progress(done: int, total: int) -> None:
            nonlocal reported
            job.go_on()
            share = SHARES * done // max(total, 1)
            if share != reported:
                reported = share
                status = f"refining with {WELL[0]} people … {100 * share // SHARES} %"
                job.on_page(lambda: self._say(status))

        well = self._ranked(request, WELL, progress)
        picture = "" if well.map is None else map_html(well.map)
        job.on_page(lambda: self._show(well, request, True, picture))

    def _ranked(self, request: SetRequest, how: tuple[int, int], progress: Callable[[int, int], None]) -> RankedSet:
        laid = None if self.made is None else self.made.map
        return rank_set(*request, *how, laid, progress, self.design.model, self._known(request))

    def _failed(self, message: str) -> None:
        super()._failed(f"not ranked: {message}")

    def _show(self, made: RankedSet, request: SetRequest, well: bool, picture: str = "") -> None:
        """Put a ranking on the page; runs on the kernel's event loop."""
        self.made, self._failed_request = made, None
        self._finished = request if well else None
        if well:
            self._running = None
        ranking, said = made.ranking, self.said
        alone = len(made.icons) < 2
        self.body.layout.display = ""
        self._maps.layout.display = self._below.layout.display = "none" if alone else ""
        few = len(made.icons) <= BESIDE
        self._maps.layout.flex = WIDE if few else "1 1 100%"
        (self._table.remove_class if few else self._table.add_class)("thermicon-wide")
        known = set(made.labels)
        self.picked = self.picked if self.picked is not None and known.issuperset(self.picked) else None
        pair = self.picked or ranking.worst_pair or (made.labels[0],) * 2
        if not alone:  # the maps first, since people wait for them
            frame = heat_frame(made, pair)
            self.heat.frame(frame.meta, frame.buffers)
        self._mark(False)
        for name, html in set_html(SetReport(ranking)).items():
            said[name].value = html
        people = f"{ranking.people} people"
        rough = ranking.people < WELL[0]
        self._compare(ranking)
        self._say(people if well else f"rough: {people}; refining …" if rough else f"{people}; intervals follow …")
        for part in (said["scores"], self._table):
            (part.add_class if rough else part.remove_class)("thermicon-rough")
        if alone:
            return
        if picture:  # the one before stays until the ranking is refined
            said["map"].value = picture
        if well or self.picked is None:
            self._safely(lambda: self.pick(*pair))

    def _no_choice(self, said: str) -> None:
        self._show_choice(fragment("marked", f"no choice: {said}", "th-caution"))

    def _no_edit(self, said: str) -> None:
        self.said["edit_text"].value = fragment("marked", f"no edit: {said}", "th-caution")

    def _offer_edit(self, found: Edit | NoEdit) -> None:
        self.edit = found
        self.said["edit_text"].value = edit_html(found)
        self.apply.disabled = isinstance(found, NoEdit)

    def _cell(self, message: dict[str, Any]) -> None:
        """A cell was clicked: answer at once, so that the page knows that the kernel is alive."""
        if message.get("type") != "cell" or self.made is None:
            return
        seq = int(message.get("seq", 0))
        try:
            pair = self.made.names(int(message["row"]), int(message["column"]))
        except (IndexError, KeyError, ValueError) as wrong:
            self._say(str(wrong), "th-caution")
            pair = self.picked or (self.made.labels[0],) * 2
        frame = heat_frame(self.made, pair, seq)
        self.heat.frame(frame.meta, frame.buffers)
        self.pick(*pair)

    def _request(self) -> SetRequest:
        return self.design.text, self.design.rig

    def _source(self) -> tuple[str, Rig] | None:
        """Text and rig of the ranking on the page."""
        return None if self.made is None else (self.made.text, self.made.rig)


def map_html(found: PerceptualMap) -> str:
    """The perceptual map with its caption; takes a fifth of a second, so that it is drawn in the background."""
    spread = f"; each ellipse holds half of {found.people} people" if found.covariance is not None else ""
    note = fragment("block", f"distances are d′, stress {found.stress:.2f}{spread}", "th-soft")
    figure = new_figure(*MAP_INCHES)
    plot_map(found, figure.add_subplot()).set_title("", loc="left")
    return f"{fragment('block', 'perceptual map', 'th-head')}{note}{themed_svg(figure)}"


def _row(*parts: Any) -> widgets.Box:
    return widgets.Box(parts).add_class("thermicon-row")
