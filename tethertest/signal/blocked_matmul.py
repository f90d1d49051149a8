"""Products with tall matrices, slab by slab.

A matrix of tens of thousands of rows and a few dozen columns is limited by memory, not by arithmetic. Handed
to BLAS whole it wakes every thread, which gains nothing and costs several times the work when the other cores
are busy; slabs of this many rows stay below the size at which threads are woken, and in the cache.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

#: rows handled at a time
SLAB = 128


def blocked_cross(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return ``left.T @ right`` (p, q) of (n, p) and (n, q), or (p,) for a right side (n,)."""
    columns = right if right.ndim == 2 else right[:, None]
    slabs = left.shape[0] // SLAB
    head = slabs * SLAB
    first = left[:head].reshape(slabs, SLAB, left.shape[1]).transpose(0, 2, 1)
    second = columns[:head].reshape(slabs, SLAB, columns.shape[1])
    product: FloatArray = np.matmul(first, second).sum(axis=0) + left[head:].T @ columns[head:]
    return product if right.ndim == 2 else product[:, 0]


def blocked_times(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return ``left @ right`` (n, q) of (n, p) and (p, q), or (n,) for a right side (p,)."""
    columns = right if right.ndim == 2 else right[:, None]
    slabs = left.shape[0] // SLAB
    head = slabs * SLAB
    product = np.empty((left.shape[0], columns.shape[1]))
    first = left[:head].reshape(slabs, SLAB, left.shape[1])
    np.matmul(first, columns, out=product[:head].reshape(slabs, SLAB, columns.shape[1]))
    product[head:] = left[head:] @ columns
    return product if right.ndim == 2 else product[:, 0]
