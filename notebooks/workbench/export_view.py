"""The export view: icons as a device would play them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import ipywidgets as widgets

from thermicon.base.files.atomic import OutputError
from thermicon.base.files.read_limited import NotRegular, TooLarge, read_limited
from thermicon.circuit import Device, Export, Rig, export
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.delivery.formats import format_names, load_format
from thermicon.perception.identification.exported import felt_in, others

from ..editing.cue_check import read_text
from ..figures.compare_figure import export_figure
from ..figures.print_figure import themed_svg
from ..report.blocks import fragment
from .design_model import DesignModel
from .live_view import BackgroundJob, LiveView
from .set_model import MOST_RANKED
from .view_blocks import delivered_html, gate_html, written_html

FORMAT = "csv"
ExportRequest = tuple[str, Rig, str | None, str, str]
"""Text, rig, name of the icon (None: all), device, format."""


class ExportView(LiveView[ExportRequest]):
    """The drives of one ``DesignModel``, prepared while its tab is ``shown``; ``box`` holds the widgets."""

    settles_s = 0.2
    status_style = "th-wrap"

    def __init__(self, design: DesignModel, folder: Path) -> None:
        super().__init__(design)
        self.ready: Export | None = None
        names = device_names()
        usual = last_device(folder) or load_format(FORMAT).device
        wide = {"width": "100%"}
        titles = [(f"{name}: {Device.load(name).title}", name) for name in names]
        self.device = widgets.Dropdown(options=titles, value=usual, description="device", layout=wide)
        self.form = widgets.Dropdown(options=self._forms(usual), description="format", layout=wide)
        which = [("all icons of the set", "all"), ("the selected icon", "shown")]
        self.which = widgets.Dropdown(options=which, description="icons", layout=wide)
        self.folder = widgets.Text(value=str(folder), description="folder", continuous_update=False, layout=wide)
        self.overwrite = widgets.Checkbox(value=False, description="overwrite existing files", indent=False)
        self.insist = widgets.Checkbox(value=False, description="also export lossy or unreached icons", indent=False)
        self.button = widgets.Button(description="Write", button_style="primary", disabled=True)
        for control in (self.device, self.form, self.folder, self.which):
            control.style.description_width = "52px"
        self.said = {name: widgets.HTML() for name in ("status", "written", "delivered", "figure", "gate")}
        self.device.observe(lambda _: self._safely(self._device_chosen), "value")
        for control in (self.form, self.which):
            control.observe(lambda _: self._safely(self.renew), "value")
        self.folder.observe(lambda _: self._safely(self._forget_result), "value")
        self.insist.observe(lambda _: self._safely(self._allow), "value")
        self.button.on_click(lambda _: self._safely(self.write))
        said = self.said
        controls = [self.device, self.form, self.which, self.folder]
        controls += [self.overwrite, self.insist, self.button]
        left = widgets.VBox([*controls, said["status"], said["written"]], layout={"flex": "1 1 300px"})
        verdicts = widgets.VBox([said["delivered"], said["gate"], said["figure"]]).add_class("thermicon-safety")
        self.body = widgets.VBox([verdicts], layout={"flex": "3 1 700px", "min_width": "0"})
        self.stale_parts = (self.body,)
        row = widgets.Box([left, self.body]).add_class("thermicon-row")
        self.box = widgets.VBox([row]).add_class("thermicon-export")
        self._say("drives are prepared when this tab opens")

    def _mark_outdated(self, request: ExportRequest) -> None:
        self.button.disabled = True
        self.said["written"].value = ""
        super()._mark_outdated(request)

    def _obstacle(self, request: ExportRequest) -> str | None:
        icons = read_text(request[0]).icons
        if icons is None:
            return "the text has errors, so nothing is exported"
        if request[2] is None and len(icons) > MOST_RANKED:
            return f"{len(icons):,} icons are more than {MOST_RANKED}: use the command thermicon export"
        return None

    def _job(self, request: ExportRequest) -> Callable[[BackgroundJob], None]:
        self._say("working …")
        return lambda job: self._prepare(job, request)

    def _show_finished(self) -> None:
        self._allow()

    def write(self) -> None:
        """Write the files, or report why that is refused; then nothing is written."""
        if self.ready is None or self._request() != self._finished:
            raise OutputError("the drives are not ready yet")
        try:
            folder = Path(self.folder.value.strip() or ".").expanduser()
            ready = replace(self.ready, force=self.insist.value)
            before = ready.write(folder, self.overwrite.value, "tick overwrite to replace it")
        except (OutputError, ValueError, RuntimeError) as wrong:
            self.said["written"].value = fragment("block", f"nothing was written: {wrong}", "th-bad")
            self._say("")
            return
        self.said["written"].value = written_html(ready, folder, before)
        self._say("")

    def _forget_result(self) -> None:
        """A result for another folder does not apply to this one."""
        self.said["written"].value = ""
        self._allow()

    def _request(self) -> ExportRequest:
        name = self.design.scene.icon if self.which.value == "shown" else None
        return self.design.text, self.design.rig, name, self.device.value, self.form.value

    def _prepare(self, job: BackgroundJob, request: ExportRequest) -> None:
        text, rig, name, device, form = request
        icons = read_text(text).icons
        assert icons is not None
        found = None if name is None else icons.find(name)
        chosen = list(icons) if found is None else [found]

        def step(done: int, total: int) -> None:
            job.on_page(lambda: self._say(f"working … {done} of {total}"))

        remarks: list[str] = []
        felt = partial(felt_in, rest=others(icons, chosen), warn=remarks.append)
        made = export(chosen, rig, device, form, felt=felt, step=step)
        shown = self.design.scene.icon
        colours = [one.verdict.colour for one in made.prepared]
        names = [one.delivery.icon.name for one in made.prepared]
        # The icon that stops the export is shown first.
        place = colours.index("red") if "red" in colours else names.index(shown) if shown in names else 0
        picture = themed_svg(export_figure(made, place, (8.6, 5.0)))
        told = delivered_html(made, remarks)
        job.on_page(lambda: self._show(made, place, told, picture, request))

    def _show(self, made: Export, place: int, told: str, picture: str, request: ExportRequest) -> None:
        self.ready, self._running, self._finished, self._failed_request = made, None, request, None
        self._mark(False)
        self.said["delivered"].value = told
        self.said["figure"].value = picture
        self.said["gate"].value = gate_html(made.prepared[place])
        self._allow()

    def _allow(self) -> None:
        """Report whether the drives can be written, and if not, why."""
        if self.ready is None or self._request() != self._finished:
            return
        stops = [refusal for _, refusal in replace(self.ready, force=self.insist.value).barred]
        self.button.disabled = bool(stops)
        if not stops:
            self._say("ready to be written", "th-good")
        elif all(refusal.forcible for refusal in stops):
            self._say("refused: lossy or unreached icons are written only if you tick the box", "th-caution")
        else:
            names = dict.fromkeys(name for name, refusal in self.ready.refused if not refusal.forcible)
            cure = "; remove the red icons, or export the others one by one" if len(self.ready.prepared) > 1 else ""
            self._say(f"refused: unsafe icons are never written ({', '.join(names)}){cure}", "th-bad")

    def _failed(self, message: str) -> None:
        super()._failed(message)
        self._finished, self.ready = None, None
        for name in ("delivered", "figure", "gate"):
            self.said[name].value = ""
        self._mark(False)

    def _show_failure(self) -> None:
        self._say(self._failure, "th-bad")

    def _device_chosen(self) -> None:
        """Offer the formats of the device; the chosen one is kept if possible."""
        forms = self._forms(self.device.value)
        kept = self.form.value if any(name == self.form.value for _, name in forms) else forms[0][1]
        self.form.options = forms
        self.form.value = kept
        self.renew()

    @staticmethod
    def _forms(device: str) -> list[tuple[str, str]]:
        driven_by, forms = Device.load(device).driven_by, map(load_format, format_names())
        return [(f"{form.name}: {form.title}", form.name) for form in forms if driven_by in form.takes]


def last_device(folder: Path) -> str | None:
    """The shipped device of the newest drive in a folder, as its sidecar has it; None where there is none."""
    try:
        newest = max(folder.glob("*.json"), key=lambda path: path.stat().st_mtime)
        name = json.loads(read_limited(newest, 4_000_000))["device"]["name"]
    except (OSError, ValueError, KeyError, TypeError, NotRegular, TooLarge):
        return None
    return name if name in device_names() else None
