"""A cue file that an editor has open: what it held then, so that nothing is overwritten that came in between."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from thermicon.circuit.inputs import read_bytes
from thermicon.icons.files.input_files import NotRegular, TooLarge, read_limited

from .outputs import OutputError, check_output, complete_or_absent

MOST_BYTES = 4_000_000
"""Bytes of a file that is opened for editing; the editor takes a million letters."""


class ChangedOnDisk(OutputError):
    """A file is not what it was when it was opened or saved here."""


@dataclass(frozen=True, slots=True)
class CueDocument:
    """A file as it was read or written last: its path, its text with line feeds, and the hash of its bytes."""

    path: Path
    text: str
    stamp: str
    crlf: bool = False

    @property
    def changed(self) -> bool:
        """Whether the file is another now, or gone."""
        try:
            return _stamp(read_limited(self.path, MOST_BYTES)) != self.stamp
        except (OSError, NotRegular, TooLarge):
            return True

    def saved(self, text: str, overwrite: bool = False) -> CueDocument:
        """Write a text in the place of the file; raises ChangedOnDisk unless ``overwrite``, OutputError if it cannot.

        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     first = create_document(Path(folder) / "a.cue", "cue 1")
        ...     second = open_document(first.path)
        ...     _ = first.saved("cue 1 # mine")
        ...     try:
        ...         second.saved("cue 1 # of another window")
        ...     except ChangedOnDisk as refused:
        ...         str(refused).partition(":")[0]
        'a.cue has changed on disk since it was opened here'
        """
        if not overwrite and self.changed:
            gone = "was removed" if not self.path.exists() else "has changed on disk"
            raise ChangedOnDisk(
                f"{self.path.name} {gone} since it was opened here: save your text under another name, or press "
                "Save again to write it over the file"
            )
        return _written(self.path, text, self.crlf)


def open_document(path: Path) -> CueDocument:
    """Read a cue file for editing; raises OutputError for what is not a text file of an editor's size."""
    data = read_bytes(path, "cue file", MOST_BYTES / 1e6, OutputError)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise OutputError(f"cannot open {path}: it is not UTF-8 text; convert it first") from None
    return CueDocument(path, text.replace("\r\n", "\n"), _stamp(data), "\r\n" in text)


def create_document(path: Path, text: str, overwrite: bool = False) -> CueDocument:
    """Write a new cue file; raises OutputError where there is one already (unless ``overwrite``) or it cannot be."""
    check_output(path, (".cue",), "cue text")
    if path.exists() and not overwrite:
        raise OutputError(f"{path} already exists and was kept: give another name, or tick overwrite")
    return _written(path, text, False)


def _written(path: Path, text: str, crlf: bool) -> CueDocument:
    check_output(path, (), "cue text")
    data = (text.replace("\n", "\r\n") if crlf else text).encode("utf-8")
    with complete_or_absent(path) as draft:
        draft.write_bytes(data)
    return CueDocument(path, text, _stamp(data), crlf)


def _stamp(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
