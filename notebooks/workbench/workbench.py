"""The workbench: all views as one page of widgets or as figures."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from IPython import get_ipython

from thermicon.base.checks.arguments import checked
from thermicon.base.files.atomic import OutputError
from thermicon.base.files.inputs import InputError
from thermicon.circuit import Rig, Trace
from thermicon.icons import CueErrors, Icon, IconSet, parse
from thermicon.icons.model.words import nearest
from thermicon.perception import Percept
from thermicon.perception.observer.observer_model import ObserverModel

from ..files.document import Document
from ..timeline.scene import Scene
from .design_model import ONE_AT_A_TIME, DesignModel
from .document_bar import document_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.perception import Ranking

    from .design_view import DesignView
    from .document_bar import DocumentBar
    from .export_view import ExportView
    from .set_strip import SetStrip
    from .set_view import SetView

View = Literal["design", "set", "export"]
VIEWS: tuple[View, ...] = ("design", "set", "export")


@checked
class Workbench:
    """A workbench for one set of icons on one rig, shown as a page where a notebook can show widgets.

    Parameters
    ----------
    text
        Cue text, the path of a cue file, the name of a shipped set, an icon or a set; None: six-icons. Errors in a cue
        text are shown on the page.
    rig
        A rig, its name, or the path of a rig file; None: the shipped rig of the set's site, else thenar.
    icon
        Name of the icon that is shown first; None: the first.
    folder
        Folder into which drives are exported.
    observer
        Observer file that predicts in place of the shipped one, as ``rank --observer`` takes it: the draws that
        ``pilot --keep lab.csv`` wrote, or one observer's records (.toml).

    Raises
    ------
    CueErrors
        For a file or a name that does not exist.
    RigError
        For a rig that does not exist, or cannot be.
    ValueError
        For a cue file that cannot be edited (unreadable, not UTF-8, or too large), an icon that the set does not have,
        and an observer file that cannot be read or is of another version (`RecordError`).

    Examples
    --------
    >>> bench = Workbench("cue 1; icon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s }")
    >>> bench
    Workbench('dip' of 1 on thenar, green)
    >>> bench.figure("design").get_suptitle().splitlines()[0]
    'dip on the thenar rig'
    """

    def __init__(
        self,
        text: str | Path | Icon | IconSet | None = None,
        rig: str | Path | Rig | None = None,
        icon: str | None = None,
        folder: str | Path = "drives",
        observer: str | Path | None = None,
    ) -> None:
        try:
            document = document_of(text, keeps=has_kernel())
        except OutputError as wrong:
            raise ValueError(str(wrong)) from None
        site = None
        with suppress(CueErrors):
            site = parse(document.text).context.site
        loaded = Rig.of(rig, site)
        model = None if observer is None else ObserverModel.load(observer)
        self._design = DesignModel(document, loaded, icon, model)
        scene = self._design.scene
        # A name that is asked for must be there; while people write, another icon may take its place.
        if icon is not None and not scene.troubles and scene.icon != icon:
            near = nearest(icon, scene.names)
            has = f"did you mean {near}?" if near else f"there are {', '.join(scene.names[:20])}"
            raise ValueError(f"no icon is called {icon!r}; {has}")
        self._folder = Path(folder)
        self._page: Any = None
        self.design_view: DesignView | None = None
        self.set_strip: SetStrip | None = None
        self.set_view: SetView | None = None
        self.export_view: ExportView | None = None
        self.bar: DocumentBar | None = None

    @property
    def text(self) -> str:
        """The cue text as it stands in the editor; setting it is one step that can be undone."""
        return self._design.text

    @text.setter
    def text(self, text: str) -> None:
        with ONE_AT_A_TIME:
            frame = self._design.show_text(text)
            if self.design_view is not None:
                self.design_view.send(frame)

    @property
    def document(self) -> Document:
        """The text with its file, undo, and what is unsaved of it."""
        return self._design.document

    @property
    def icons(self) -> IconSet:
        """The set as it is written; raises CueErrors where the text has errors."""
        return parse(self.text, "text")

    @property
    def icon(self) -> Icon | None:
        """The icon that is shown; None where there is none yet."""
        drawing = self._design.scene.drawing
        return None if drawing is None else drawing.icon

    @property
    def rig(self) -> Rig:
        """The rig with the sliders set."""
        return self._design.rig

    @property
    def scene(self) -> Scene:
        """All that the design view shows, as data."""
        return self._design.scene

    @property
    def trace(self) -> Trace | None:
        """The run of the icon that is shown."""
        drawing = self._design.scene.drawing
        return None if drawing is None else drawing.trace

    @property
    def percept(self) -> Percept | None:
        """The percept of the icon."""
        drawing = self._design.scene.drawing
        return None if drawing is None else drawing.percept

    def ranking(self, people: int = 200) -> Ranking:
        """Rank the set as it is written, for so many people.

        Raises CueErrors for a bad text, ValueError for more icons than are compared at once.
        """
        from thermicon.perception import rank
        from thermicon.perception.criteria import MOST_ICONS

        if len(self.icons) > MOST_ICONS:
            many = f"{len(self.icons):,} icons are more than the {MOST_ICONS:,} that are compared at once"
            raise ValueError(f"{many}: narrow the family")
        return rank(self.icons, self.rig, people=people, observer=self._design.model)

    def figure(self, view: View = "design") -> Figure:
        """Return what a view shows as a matplotlib Figure.

        Raises ValueError for a view that there is not, and CueErrors for a set or an export of a bad text.
        """
        if view not in VIEWS:
            raise ValueError(f"there is no view {view!r}; there are {', '.join(VIEWS)}")
        if view == "design":
            from ..figures.overview import scene_figure

            return scene_figure(self.scene)
        if view == "set":
            from ..figures.set_figures import set_figure

            return set_figure(self.ranking())
        from thermicon.circuit import export

        from ..figures.compare_figure import export_figure

        icons = self.icons  # raises for a bad text, of which the icon before it is drawn still
        shown = icons.find(self.scene.icon or "") or icons.icons[0]
        return export_figure(export(shown, self.rig))

    @property
    def page(self) -> Any:
        """The widgets; they are made when they are first asked for."""
        if self._page is None:
            self._page = self._made()
        return self._page

    def _made(self) -> Any:
        import ipywidgets as widgets

        from .design_view import DesignView
        from .document_bar import DocumentBar
        from .export_view import ExportView
        from .live_panel import LivePanel
        from .set_strip import SetStrip
        from .set_view import SetView

        sheet = (files("thermicon.notebooks") / "workbench.css").read_text(encoding="utf-8")
        style = widgets.HTML(f"<style>{sheet}</style>").add_class("thermicon-style")
        self.design_view = design = DesignView(self._design)

        def show_text(text: str) -> None:
            design.send(self._design.show_text(text))

        self.set_strip = strip = SetStrip(self._design, design.canvas.send)
        self.set_view = ranked = SetView(self._design, show_text, strip.known, lambda: strip.pinned)
        self.export_view = export = ExportView(self._design, self._folder)
        self.bar = bar = DocumentBar(design)
        self.live = LivePanel(self._to_play, lambda on: design.canvas.send({"type": "device", "plays": on}))

        def greeted(_: object) -> None:
            strip.tell(anew=True)
            self.live.tell()

        design.on_page |= {"save": bar.saved_by_key, "left": bar.take_left, "hello": greeted}
        design.stop_device = lambda: self.live.stop("Stop on the time line")
        views = [design.box, ranked.box, export.box, self.live.box]
        tabs = widgets.Tab(views, titles=("Design", "Set", "Export", "Live"))

        live: tuple[SetStrip | SetView | ExportView, ...] = (strip, ranked, export)

        for part in (*ranked.stale_parts, *export.stale_parts):
            part.add_class("thermicon-judged")  # pale where the page itself knows that it is older than the text

        def shown(change: Any) -> None:
            with ONE_AT_A_TIME:
                bar.beside(design=change["new"] == 0)
                for place, view in enumerate(live):
                    view.shown = change["new"] == place
                    view.renew(0.0)  # who opens a tab has finished typing

        def changed() -> None:
            for view in live:
                view.renew()

        strip.shown = has_kernel()
        strip.renew(1.0)  # once the page is drawn
        tabs.observe(shown, "selected_index")
        self._design.on_change(changed)
        self.tabs = tabs
        return widgets.VBox([style, bar.box, tabs]).add_class("thermicon")

    def _to_play(self) -> tuple[Sequence[Icon], Sequence[str], Rig]:
        """The set as it is written, of which the icon that is shown is played, and the rig with its sliders."""
        icons, scene = self.icons, self._design.scene
        if scene.icon is None or icons.find(scene.icon) is None:
            raise InputError("there is no icon to play")
        return tuple(icons), (scene.icon,), self.rig

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        """The page, with a line and a small picture for where widgets are not shown; the figure where none can be."""
        light: dict[str, Any] = {"text/plain": repr(self)}
        if not has_kernel():
            from ..figures.print_figure import small_png

            return {**light, "image/png": small_png(self.figure())}
        try:
            light["text/html"] = self.icons._repr_html_()
        except CueErrors as wrong:
            light["text/html"] = f"<pre>{escape(str(wrong))}</pre>"
        return {**light, **self.page._repr_mimebundle_(include=include, exclude=exclude), "text/plain": repr(self)}

    def __repr__(self) -> str:
        return f"Workbench{repr(self.scene).removeprefix('Scene')}"


def has_kernel() -> bool:
    """Whether there is a kernel whose front end could show widgets."""
    return getattr(get_ipython(), "kernel", None) is not None
