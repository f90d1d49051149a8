"""Array types shared by the records."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.signal.passes import blocks_of

FloatArray: TypeAlias = npt.NDArray[np.float64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
FlagArray: TypeAlias = npt.NDArray[np.uint16]
IndexArray: TypeAlias = npt.NDArray[np.intp]


def increases(time: FloatArray) -> bool:
    """Return whether every value is larger than the one before it."""
    return all(
        bool(np.all(time[start + 1 : stop + 1] > time[start : min(stop, time.size - 1)]))
        for start, stop in blocks_of(time.size)
    )


def frozen(values: npt.ArrayLike, dtype: Any = np.float64) -> npt.NDArray[Any]:
    """Return a read-only array; the caller's own array stays writable."""
    array = np.array(values, dtype=dtype, copy=None, order="C")
    view = array.view()
    view.setflags(write=False)
    return view
