"""Finished chunks on disk, one Parquet file each, so that a run that was killed goes on where it stopped.

A file is there whole or not at all, and carries checksums: one that is damaged, or of other work, counts as not there.
"""

from __future__ import annotations

import os
import threading
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from .chunks import BatchResult, Job

KEY, CHUNK = b"thermicon.work", b"thermicon.chunk"


class BatchStoreError(ValueError):
    """Chunks cannot be kept where they should be; the text says why and what to change."""


@dataclass(frozen=True, slots=True)
class BatchStore:
    """Where the chunks of one piece of work are kept: a folder named by all that its numbers hang on."""

    folder: Path
    key: str

    @classmethod
    def of(cls, work: Job, keep: Path) -> BatchStore:
        """The shelf of some work in a folder, which is made; raises `BatchStoreError` where it cannot be."""
        folder = keep / work.key[:32]
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BatchStoreError(f"cannot keep finished parts in {keep}: {error.strerror or error}") from error
        return cls(folder, work.key)

    def path(self, number: int) -> Path:
        """File of a chunk."""
        return self.folder / f"{number:06d}.parquet"

    def put(self, work: Job, number: int, found: BatchResult) -> None:
        """Write a chunk: under another name first, so that no half of it is ever taken for the whole."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        start, stop = work.span(number)
        columns = {"person": pa.array(range(start, stop), pa.int64())}
        for field in fields(BatchResult):
            columns[field.name] = _column(getattr(found, field.name), stop - start)
        held = pa.table(columns).replace_schema_metadata({KEY: self.key.encode(), CHUNK: str(number).encode()})
        goal = self.path(number)
        draft = goal.with_name(f".{goal.stem}.{os.getpid()}.{threading.get_ident()}.part")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            pq.write_table(held, draft, compression="zstd", write_page_checksum=True, use_dictionary=False)
            draft.replace(goal)
        except OSError as error:
            raise BatchStoreError(f"cannot keep finished parts in {self.folder}: {error.strerror or error}") from error
        finally:
            draft.unlink(missing_ok=True)

    def get(self, work: Job, number: int) -> BatchResult | None:
        """A chunk that was finished; None where there is none, or none that can be trusted."""
        if not self.path(number).exists():
            return None
        import pyarrow.parquet as pq

        start, stop = work.span(number)
        try:
            with pq.ParquetFile(self.path(number), page_checksum_verification=True) as file:
                held = file.read()
            told = held.schema.metadata or {}
            if told.get(KEY) != self.key.encode() or told.get(CHUNK) != str(number).encode():
                return None
            if held["person"].to_pylist() != list(range(start, stop)):
                return None
            return _checked(
                BatchResult(**{field.name: _array(held[field.name]) for field in fields(BatchResult)}), work
            )
        except Exception:
            # Whatever is wrong with it, to do the chunk again is the cure.
            return None

    def finished(self, work: Job) -> list[int]:
        """Numbers of the chunks that have a file, trusted or not."""
        return [number for number in range(work.chunks) if self.path(number).exists()]

    def clear(self) -> None:
        """Remove the files and the folder of this work; what is not ours stays."""
        for file in [*self.folder.glob("*.parquet"), *self.folder.glob(".*.part")]:
            file.unlink(missing_ok=True)
        if not any(self.folder.iterdir()):
            self.folder.rmdir()


def _column(values: Array, people: int) -> Any:
    """A number or a flat list for each person, with its shape; none where there is nothing for the later ones."""
    import pyarrow as pa

    if values.ndim == 1:
        return pa.array(values, pa.float64())
    shape = pa.array([list(values.shape[1:])] * people, pa.list_(pa.int64()))
    size = int(np.prod(values.shape[1:]))
    ends = np.minimum(np.arange(people + 1), len(values)) * size
    flat = pa.ListArray.from_arrays(pa.array(ends, pa.int32()), pa.array(values.reshape(-1), pa.float64()))
    return pa.StructArray.from_arrays([shape, flat], ["shape", "values"])


def _array(column: Any) -> Array:
    import pyarrow as pa

    whole = column.combine_chunks()
    whole = whole.chunk(0) if isinstance(whole, pa.ChunkedArray) else whole
    if not pa.types.is_struct(whole.type):
        return np.array(whole, dtype=np.float64)
    shape = whole.field("shape")[0].as_py()
    values = np.array(whole.field("values").flatten(), dtype=np.float64)
    return values.reshape(-1, *shape)


def _checked(found: BatchResult, work: Job) -> BatchResult:
    icons, people = len(work.icons), len(found.stress)
    shapes = {
        "detected": (people, icons),
        "correct": (people, icons),
        "confusion": (people, icons, icons),
        "stress": (people,),
    }
    shapes["d_prime"] = (people, icons * (icons - 1) // 2)
    for name, shape in shapes.items():
        if getattr(found, name).shape != shape:
            raise ValueError(f"a chunk's {name} has shape {getattr(found, name).shape}, not {shape}")
    return found
