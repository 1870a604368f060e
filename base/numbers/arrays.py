"""The forms of arrays that results hold and kernels take."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]


def own_arrays(holder: object, *names: str) -> None:
    """Replace fields of a frozen object by read-only copies of their own, as float64; for `__post_init__`."""
    for name in names:
        own = np.array(getattr(holder, name), dtype=np.float64)
        own.setflags(write=False)
        object.__setattr__(holder, name, own)


def held(courses: Array, rows: int) -> Array:
    """Courses (..., n_time) of so many rows, the last of them held."""
    if rows == courses.shape[-1]:
        return courses
    return np.pad(courses, [(0, 0)] * (courses.ndim - 1) + [(0, rows - courses.shape[-1])], "edge")


def as_rows(values: npt.ArrayLike) -> tuple[Array, tuple[int, ...]]:
    """(rows, n_time) read-only view of a contiguous float64 array, and the shape it came in.

    Always read-only, so that kernels are compiled for one kind of array and not for two.

    >>> as_rows([[[1.0, 2.0, 3.0]]])[0].shape
    (1, 3)
    """
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] < 2:
        raise ValueError(f"a trace needs at least two samples on its last axis, not shape {array.shape}")
    rows = array.reshape(-1, array.shape[-1]).view()
    rows.flags.writeable = False
    return rows, array.shape
