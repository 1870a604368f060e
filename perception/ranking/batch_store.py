"""Finished batches on disk, one .npz file each, so that an interrupted run continues where it stopped.

A file is complete or absent. Zip checksums and the key of the job guard its content: a file that is damaged, or belongs
to another job, counts as absent.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.icons.atomic import MARK, OutputError, complete_or_absent
from thermicon.icons.userfolder import remove_unused

from ..arrays import Array

STALE_S = 3600.0
"""A draft is written in milliseconds; one as old as this was left by a run that was killed, and is removed."""


class BatchStoreError(ValueError):
    """Finished batches cannot be kept where they should be; the text states why."""


@dataclass(frozen=True, slots=True)
class BatchStore:
    """The folder that holds the finished batches of one job, named by the key of the job."""

    folder: Path
    key: str

    @classmethod
    def of(cls, key: str, keep: Path) -> BatchStore:
        """The store of a job inside a folder; both folders are made. Raises `BatchStoreError` where that fails."""
        folder = keep / key[:32]
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BatchStoreError(f"cannot keep finished parts in {keep}: {error.strerror or error}") from error
        remove_unused(folder.glob(f".*.{MARK}.npz"), STALE_S)
        return cls(folder, key)

    def path(self, number: int) -> Path:
        """File of a batch."""
        return self.folder / f"{number:06d}.npz"

    def put(self, number: int, arrays: Mapping[str, Array]) -> None:
        """Write a batch."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with complete_or_absent(self.path(number)) as draft:
                np.savez(draft, allow_pickle=False, key=np.array(self._label(number)), **arrays)
        except (OSError, OutputError) as error:
            raise BatchStoreError(f"cannot keep finished parts in {self.folder}: {error}") from error

    def get(self, number: int) -> dict[str, Array] | None:
        """The arrays of a finished batch; None where there is no file, or none that can be trusted."""
        if not self.path(number).exists():
            return None
        try:
            with np.load(self.path(number), allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
            return arrays if str(arrays.pop("key")) == self._label(number) else None
        except Exception:
            # Whatever is wrong with the file, computing the batch again is the remedy.
            return None

    def _label(self, number: int) -> str:
        return f"{self.key} {number}"
