"""Long records in consecutive blocks, so that no rule needs more memory than the record itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

#: samples that a rule looks at together, where it can: two megabytes of float64. A usual run is one block
BLOCK: Final = 1 << 18


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
