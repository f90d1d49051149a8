"""Long records in consecutive blocks, so that no rule needs more memory than the record itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

#: samples that a rule looks at together, where it can: two megabytes of float64. A usual run is one block
BLOCK: Final = 1 << 18
#: a record of more samples is filtered block by block, and thinned or cut before it is transformed
LONGEST: Final = 1 << 18


def blocks_of(size: int, block: int = BLOCK) -> Iterator[tuple[int, int]]:
    """Yield first and last + 1 sample of every block.

    Parameters
    ----------
    size : int
        Samples of the record.
    block : int
        Samples of a block; the last one may have fewer.
    """
    for start in range(0, size, block):
        yield start, min(start + block, size)


def overlapped(
    apply: Callable[[int, int], npt.NDArray[np.float64]], size: int, reach: int
) -> npt.NDArray[np.float64]:
    """Return what a filter makes of a record, of a long one block by block.

    Parameters
    ----------
    apply : callable
        First row, and last + 1 -> what the filter makes of these rows alone (n,).
    size : int
        Samples of the record.
    reach : int
        Samples on either side of one that it may depend on.
    """
    if size <= max(LONGEST, 4 * reach):
        return apply(0, size)
    result = np.empty(size)
    for start, stop in blocks_of(size, max(BLOCK, 2 * reach)):
        first = max(start - reach, 0)
        result[start:stop] = apply(first, min(stop + reach, size))[start - first : stop - first]
    return result
