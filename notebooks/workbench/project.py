"""What a workbench works on: the set with the file it came from, what is unsaved of it, and the rig."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.files.shipped import library_names

from ..editing.icon_edits import only, with_copy, with_name, with_new, without
from ..files.autosave import Autosave, Unsaved, unsaved_texts
from ..files.cue_document import ChangedOnDisk, CueDocument, create_document, open_document
from ..files.kept_draft import KeptVersion
from ..files.outputs import OutputError
from ..files.start_folder import below_start

if TYPE_CHECKING:
    from .design_model import DesignModel

MOST_FILES = 200
SHIPPED = "shipped: "
"""What stands before the name of a shipped set in the list of what can be opened."""


class Project:
    """File, unsaved text and icons of one ``DesignModel``; verbs raise OutputError or ValueError with a sentence.

    ``autosaves`` says whether unsaved text is kept beside the file: where a kernel serves a page.
    """

    def __init__(self, design: DesignModel, document: CueDocument | None, name: str, autosaves: bool = False) -> None:
        self.design = design
        self.document = document
        self.name = name
        self._base = design.text if document is None else document.text
        self._autosaves = autosaves
        self._overwrites = False
        self._seen: tuple[object, bool] | None = None
        self._autosave = self._new_autosave()
        self._version: KeptVersion | None = None
        self.offers: list[Unsaved] = []
        self.look_for_unsaved()
        design.on_change(self.changed)

    @property
    def folder(self) -> Path:
        """Where files are looked for and new ones are written."""
        return below_start(Path() if self.document is None else self.document.path.parent)

    @property
    def dirty(self) -> bool:
        """Whether the text differs from what was opened or saved last."""
        return self.design.text != self._base

    @property
    def title(self) -> str:
        """The name of the file or the shipped set, and what is to be known of it."""
        if self.document is None:
            return f"{self.name} (not saved to a file)" if self.dirty else self.name
        return f"{self.document.path.name}{', unsaved changes' if self.dirty else ''}"

    def warning(self) -> str:
        """What may cost somebody their text, in one sentence; empty where nothing does."""
        if self.document is not None and self._changed_on_disk():
            name = self.document.path.name
            if not self.document.path.exists():
                return f"{name} was removed on disk since it was opened here: Save as writes your text to a file again"
            return (
                f"{name} has changed on disk since it was opened here: open it again to see it, or save your text "
                "under another name"
            )
        if (self.dirty or self._version) and self._autosave is not None and self._autosave.failed:
            return f"{'unsaved text' if self.dirty else 'version A'} is not kept: {self._autosave.failed}"
        return ""

    def _changed_on_disk(self) -> bool:
        """Whether the file is another now: read again only when its time, size or place differ, as every frame asks."""
        assert self.document is not None
        try:
            status = self.document.path.stat()
            seen = (self.document, status.st_ino, status.st_size, status.st_mtime_ns)
        except OSError:
            return True
        if self._seen is None or self._seen[0] != seen:
            self._seen = (seen, self.document.changed)
        return self._seen[1]

    def changed(self) -> None:
        """Keep the text as it is now with version A, and forget what is kept once it is saved and there is no A."""
        self._overwrites = False
        if self._autosave is None:
            return
        if self.dirty or self._version is not None:
            self._autosave.keep(self.design.text, self._version)
        else:
            self._autosave.forget()

    def keep_version(self, version: KeptVersion | None) -> None:
        """Keep a version A beside the text from now on; None for none."""
        self._version = version
        self.changed()

    def look_for_unsaved(self) -> None:
        """Find what was typed for this file elsewhere and never saved, and versions A that were kept there."""
        own = self._autosave
        self.offers = [] if own is None else unsaved_texts(own.place, self.design.text, own.path)

    def restore(self) -> KeptVersion | None:
        """Put the newest unsaved text into the editor, as a step that can be undone; return the newest version A.

        Other texts are dropped, but for those of editors that are running.
        """
        offers, self.offers = self.offers, []
        text = next((each.text for each in offers if each.text is not None), None)
        if text is not None:
            self.design.show_text(text)
        version = next((each.version for each in offers if each.version is not None), None)
        for each in offers:
            taken = each.text in (None, text) and each.version in (None, version)
            if taken or not each.alive:  # what is taken is kept again by this editor
                each.path.unlink(missing_ok=True)
        return version

    def discard(self) -> None:
        """Drop unsaved texts of editors that are gone; those of running ones stay theirs."""
        for each in self.offers:
            if not each.alive:
                each.path.unlink(missing_ok=True)
        self.offers = []

    def discard_texts(self) -> None:
        """Drop unsaved texts of editors that are gone, and go on to offer versions A alone."""
        held = [replace(each, text=None) for each in self.offers if each.version is not None]
        self.offers = [each for each in self.offers if each.version is None]
        self.discard()
        self.offers = held

    def openable(self) -> list[str]:
        """What can be opened: cue files of the folder by name, and the shipped sets."""
        return [*self.files("*.cue")[:MOST_FILES], *(f"{SHIPPED}{name}" for name in library_names())]

    def files(self, pattern: str) -> list[str]:
        """Names of files of the folder, without hidden ones; none of a folder that a page may not look into."""
        try:
            return sorted(path.name for path in self.folder.glob(pattern) if not path.name.startswith("."))
        except (OSError, OutputError):
            return []

    def open(self, source: str) -> None:
        """Open a file or a shipped set; what is unsaved of the one before stays kept beside its file."""
        from .workbench import text_of

        before = self._autosave
        if self.dirty and (before is None or before.failed):
            raise OutputError(f"{self.title}: save it first, or undo the changes; nothing was opened")
        if source.startswith(SHIPPED):
            name = source.removeprefix(SHIPPED)
            document, text = None, text_of(name)
        else:
            document = open_document(self.place(source))
            name, text = document.path.name, document.text
        if not self.dirty and before is not None:
            before.forget()  # version A goes along
        self.document, self.name, self._base = document, name, text
        self._autosave = self._new_autosave()
        self.design.open_text(text)
        self.changed()  # an equal text is no change of the design
        self.look_for_unsaved()

    def save(self) -> Path:
        """Save to the file it came from; pressed twice, over a file that has changed in between too."""
        if self.document is None:
            raise OutputError("this set has no file yet: save it under a name")
        try:
            self._saved(self.document.saved(self.design.text, overwrite=self._overwrites))
        except ChangedOnDisk:
            self._overwrites = True
            raise
        return self._path

    def save_as(self, name: str, overwrite: bool = False) -> Path:
        """Save to another file, which is that of the set from now on."""
        wanted = name.strip()
        if not wanted:
            raise OutputError("give the name of a file, such as alerts.cue")
        path = self.place(wanted if Path(wanted).suffix else f"{wanted}.cue")
        self._saved(create_document(path, self.design.text, overwrite))
        return self._path

    def new_icon(self) -> None:
        """Add an icon at the end of the text, and show it."""
        self.design.show_text(*with_new(self.design.text))

    def duplicate(self, icon: str) -> None:
        """Add a copy of an icon behind it, and show the copy."""
        self.design.show_text(*with_copy(self.design.text, icon))

    def rename(self, icon: str, name: str) -> None:
        """Give an icon another name, wherever it is played too."""
        self.design.show_text(with_name(self.design.text, icon, name), name.strip())

    def delete(self, icon: str) -> None:
        """Remove an icon from the text."""
        self.design.show_text(without(self.design.text, icon))

    def keep_only(self, icons: tuple[str, ...]) -> None:
        """Remove all icons but these."""
        self.design.show_text(only(self.design.text, icons))

    def place(self, name: str) -> Path:
        """The path of a name in the folder of the set, or of a path; OutputError outside the folder of a page."""
        path = Path(name).expanduser()
        whole = path if path.is_absolute() else self.folder / path
        return below_start(whole.parent) / whole.name

    def _saved(self, document: CueDocument) -> None:
        self.document, self.name, self._base = document, document.path.name, document.text
        before, self._autosave = self._autosave, self._new_autosave()
        if before is not None:
            before.forget()
        self.changed()

    @property
    def _path(self) -> Path:
        assert self.document is not None
        return self.document.path

    def _new_autosave(self) -> Autosave | None:
        if not self._autosaves:
            return None
        try:
            place = self.document.path if self.document is not None else self.folder / f"{Path(self.name).stem}.cue"
        except OutputError:
            return None
        return Autosave(place)
