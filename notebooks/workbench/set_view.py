"""The set view: confusions, the selected pair with its cheapest edit, the perceptual map, and the best few icons."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import ipywidgets as widgets

from ..editing.cue_check import read_text
from ..editing.number_literals import only, with_edit
from ..figures.print_figure import themed_svg
from ..report.blocks import Bullets, fragment, shown
from ..report.choices import NAMES
from .design_view import SideCanvas
from .goal_field import GoalField
from .live_view import BackgroundWorker, Job, LiveView
from .set_model import QUICK, WELL, RankedSet, heat_frame, overlay_frame, rank_set, why_not
from .view_blocks import chosen_html, edit_html, pair_html, set_html

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception.identification.map import PerceptualMap
    from thermicon.perception.selection.edit import Edit, NoEdit
    from thermicon.perception.selection.goal import Goal
    from thermicon.perception.selection.request import Selection

    from .design_model import DesignModel

ShowText = Callable[[str], None]
SetRequest = tuple[str, "Rig", "Selection | None", "Goal | None"]
"""Text, rig, the choice of a few icons, if any, and the goal, if any."""
SHARES = 10
SMALL = """cue 1
icon dip { cool by 2 K at 2 K/s; return at 2 K/s }
icon glow { warm by 2 K at 2 K/s; return at 2 K/s }
icon beat { repeat 2 { pulse cool by 2 K for 1 s; rest for 1 s } }
"""
"""A set that calls what a first ranking of any set calls: three icons, since two are easier to place."""
MAP_INCHES = (3.7, 3.3)
WIDE, BESIDE = "1 1 500px", 6
"""Table and heat maps are side by side for at most this number of icons."""


class SetView(LiveView[SetRequest]):
    """The set of one ``DesignModel``, ranked while its tab is ``shown``; ``box`` holds the widgets.

    ``show_text`` is called with the text after an edit is applied.
    """

    settles_s = 0.25

    def __init__(self, design: DesignModel, show_text: ShowText) -> None:
        super().__init__(design)
        self._show_text = show_text
        self.made: RankedSet | None = None
        self.picked: tuple[str, str] | None = None
        self.edit: Edit | NoEdit | None = None
        self.editor, self._warmer = BackgroundWorker(self._no_edit), BackgroundWorker()
        self._build()

    def _build(self) -> None:
        self.heat, self.overlay = SideCanvas("heat"), SideCanvas("traces")
        self.heat.on_message(self._receive)
        names = ("scores", "status", "table", "notes", "pair", "edit_text", "why", "map", "choice", "caveat")
        self.said = {name: widgets.HTML() for name in names}
        said = self.said
        self.count = widgets.Dropdown(options=[("all", 0)], value=0, description="choose", layout={"width": "150px"})
        by = [(name, key) for key, name in NAMES.items()]
        self.objective = widgets.Dropdown(options=by, value="worst", description="by", layout={"width": "210px"})
        for control in (self.count, self.objective):
            control.style.description_width = "auto"
            control.observe(lambda _: self._safely(lambda: self.renew(0.0)), "value")
        self.apply = widgets.Button(description="Apply edit", disabled=True, layout={"width": "100px"})
        self.apply.on_click(lambda _: self._safely(self.apply_edit))
        self.take = widgets.Button(description="Keep these", layout={"width": "100px", "display": "none"})
        self.take.tooltip = "take the other icons out of the text, as one step that can be undone"
        self.take.on_click(lambda _: self._safely(self.keep_chosen))
        top = _row(said["scores"], said["status"]).add_class("thermicon-top")
        self.goal = GoalField(lambda: self._safely(lambda: self.renew(0.0)))
        choosing = _row(self.count, self.objective, self.take)
        table = widgets.VBox([said["table"], choosing, said["choice"], self.goal.box])
        self._table = table.add_class("thermicon-side")
        self._maps = widgets.VBox([self.heat], layout={"flex": WIDE, "min_width": "0"})
        overlay = widgets.VBox([self.overlay], layout={"flex": "3 1 400px", "min_width": "0"})
        reasons = widgets.VBox([said["pair"], said["edit_text"], self.apply, said["why"]], layout={"flex": "3 1 300px"})
        placed = widgets.VBox([said["map"]], layout={"flex": "2 1 270px", "min_width": "0"})
        self._below = _row(overlay, reasons, placed).add_class("thermicon-pair")
        self.body = widgets.VBox([_row(table, self._maps), said["notes"], self._below, said["caveat"]])
        self.box = widgets.VBox([top, self.body]).add_class("thermicon-set")
        self.body.layout.display = "none"
        self._say("the set is ranked when this tab opens")

    def warm(self) -> None:
        """Load what ranking needs in the background, so that the first ranking starts at once."""
        self._warmer.ask(self._load, 1.0)

    def _load(self, job: Job) -> None:
        rank_set(SMALL, self.design.nominal, *QUICK, progress=job.go_on)

    def _mark_outdated(self, request: SetRequest) -> None:
        self._mark(self.made is not None and request[:2] != self._source())

    def _obstacle(self, request: SetRequest) -> str | None:
        reason = why_not(read_text(request[0]))
        if reason is None or self.made is None:
            return reason
        return f"{reason}; the last valid set is shown, for {self.made.ranking.people} people"

    def _job(self, request: SetRequest) -> Callable[[Job], None]:
        quick = self.made is None or request[:2] != self._source()
        doing = "choosing" if request[2] else "judging the goal" if request[3] else "ranking"
        self._say("ranking …" if quick else f"{doing} …")
        return lambda job: self._rank(job, request, quick)

    def _show_finished(self) -> None:
        if self.made is not None:
            self._say(f"{self.made.ranking.people} people")

    def _stale_parts(self) -> tuple[widgets.Widget, ...]:
        return self.body, self.said["scores"]

    def pick(self, a: str, b: str) -> None:
        """Select a pair: show both icons together, why they are confused, and the cheapest edit."""
        made = self.made
        if made is None:
            return
        self.picked, self.edit = (a, b), None
        frame = overlay_frame(made, a, b)
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
        self.editor.ask(lambda job: self._look_for_edit(job, made, a, b), 0.1)

    def apply_edit(self) -> None:
        """Apply the suggested edit to the text, as one step that can be undone."""
        from thermicon.perception.selection.edit import Edit

        edit = self.edit
        if not isinstance(edit, Edit):
            raise ValueError("there is no edit to apply")
        text = with_edit(self.design.text, edit.edited, edit.old, edit.new)
        self.apply.disabled = True
        self.said["edit_text"].value = fragment("marked", f"applied: {edit.new}", "th-good")
        self._show_text(text)

    def keep_chosen(self) -> None:
        """Take the icons that were not chosen out of the text, as one step that can be undone."""
        chosen = None if self.made is None else self.made.report.choice
        if chosen is None:
            raise ValueError("no icons are chosen yet: say above how many")
        self._show_text(only(self.design.text, tuple(chosen.icons)))
        self.take.layout.display = "none"
        self.count.value = 0

    def _rank(self, job: Job, request: SetRequest, quick: bool) -> None:
        """The background job: a quick ranking with a few people, then one with enough for the final numbers."""
        text, rig, choosing, goal = request
        if quick:
            reference = None if self.made is None else self.made.map
            first = rank_set(text, rig, *QUICK, None, reference, job.go_on, goal, self.design.model)
            job.on_page(lambda: self._show(first, request, False))
        reference = None if self.made is None else self.made.map
        reported = [0]

        def progress(done: int, total: int) -> None:
            job.go_on()
            share = SHARES * done // max(total, 1)
            if share != reported[0]:  # it starts again where icons are chosen after the ranking
                reported[0] = share
                doing = "choosing" if choosing is not None and not quick else "refining"
                status = f"{doing} with {WELL[0]} people … {100 * share // SHARES} %"
                job.on_page(lambda: self._say(status))

        well = rank_set(text, rig, *WELL, choosing, reference, progress, goal, self.design.model)
        picture = "" if well.map is None else map_html(well.map)
        job.on_page(lambda: self._show(well, request, True, picture))

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
        result = made.report.to_dict(mapped=False)  # the map exists already, aligned with the one before
        for name, html in set_html(ranking, result).items():
            said[name].value = html
        said["choice"].value = chosen_html(made.report)
        self.goal.show(made.report.goal, well)
        self.take.layout.display = "none" if made.report.choice is None else ""
        people = f"{ranking.people} people"
        self._say(f"{people}" if well else f"preliminary: {people}; refining …")
        self._offer(len(made.icons))
        if alone:
            return
        if picture:  # the one before stays until the ranking is refined
            said["map"].value = picture
        if well or self.picked is None:
            self._safely(lambda: self.pick(*pair))

    def _look_for_edit(self, job: Job, made: RankedSet, a: str, b: str) -> None:
        from thermicon.perception import cheapest_edit

        found = cheapest_edit(made.ranking, a, b)
        job.on_page(lambda: self._offer_edit(found))

    def _no_edit(self, said: str) -> None:
        self.said["edit_text"].value = fragment("marked", f"no edit: {said}", "th-caution")

    def _offer_edit(self, found: Edit | NoEdit) -> None:
        from thermicon.perception.selection.edit import NoEdit

        self.edit = found
        self.said["edit_text"].value = edit_html(found)
        self.apply.disabled = isinstance(found, NoEdit)

    def _receive(self, message: dict[str, Any]) -> None:
        self._safely(lambda: self._cell(message))

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
        return self.design.text, self.design.rig, self._choosing(), self.goal.goal

    def _choosing(self) -> Selection | None:
        from thermicon.perception.selection.request import Selection

        return Selection(self.count.value, self.objective.value) if self.count.value else None

    def _offer(self, icons: int) -> None:
        """Offer the possible numbers of chosen icons."""
        options = [("all", 0), *((f"best {k}", k) for k in range(2, icons))]
        if list(self.count.options) != options:
            kept = self.count.value if any(value == self.count.value for _, value in options) else 0
            self.count.options = options
            self.count.value = kept

    def _source(self) -> tuple[str, Rig] | None:
        """Text and rig of the ranking on the page."""
        return None if self.made is None else (self.made.text, self.made.rig)


def map_html(found: PerceptualMap) -> str:
    """The perceptual map with its caption; takes a fifth of a second, so that it is drawn in the background."""
    from matplotlib.figure import Figure

    from thermicon.perception.plots.draw_map import plot_map

    spread = f"; each ellipse holds half of {found.people} people" if found.covariance is not None else ""
    note = fragment("block", f"distances are d′, stress {found.stress:.2f}{spread}", "th-soft")
    figure = Figure(figsize=MAP_INCHES, layout="constrained")
    plot_map(found, figure.add_subplot()).set_title("", loc="left")
    return f"{fragment('block', 'perceptual map', 'th-head')}{note}{themed_svg(figure)}"


def _row(*parts: Any) -> widgets.Box:
    return widgets.Box(parts).add_class("thermicon-row")
