"""Rows of a log as they come, and how they are cut into pieces and put together again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.readers.text.blocks import Integers
from tethertest.records.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RowBlock:
    """Consecutive rows of a log: their time and the values of every channel."""

    time: FloatArray  #: (n,) [s]
    values: tuple[FloatArray, ...]  #: (n,) of each channel
    lines: Integers  #: (n,) line of each row in the file, from 1
    words: dict[tuple[int, str], Integers]  #: column, word for missing -> rows
    infinite: dict[int, Integers]  #: column -> rows
    encoding: str  #: of the file, as far as it was read

    def part(self, begin: int, end: int) -> RowBlock:
        """Return some of the rows."""
        return RowBlock(
            self.time[begin:end],
            tuple(values[begin:end] for values in self.values),
            self.lines[begin:end],
            {key: found for key, rows in self.words.items() if len(found := _within(rows, begin, end))},
            {key: found for key, rows in self.infinite.items() if len(found := _within(rows, begin, end))},
            self.encoding,
        )


def _within(rows: Integers, begin: int, end: int) -> Integers:
    return rows[(rows >= begin) & (rows < end)] - begin


def regrouped(blocks: Iterator[RowBlock], rows: int) -> Iterator[RowBlock]:
    """Yield the same rows, so many at a time; the last block may have fewer."""
    held: list[RowBlock] = []
    count = 0
    for block in blocks:
        begin = 0
        while count + len(block.time) - begin >= rows:
            end = begin + rows - count
            yield _joined([*held, block.part(begin, end)])
            held, count, begin = [], 0, end
        if begin < len(block.time):
            held.append(block.part(begin, len(block.time)))
            count += len(block.time) - begin
    if held:
        yield _joined(held)


def _joined(blocks: Sequence[RowBlock]) -> RowBlock:
    words: dict[tuple[int, str], list[Integers]] = {}
    infinite: dict[int, list[Integers]] = {}
    before = 0
    for block in blocks:
        for key, rows in block.words.items():
            words.setdefault(key, []).append(rows + before)
        for column, rows in block.infinite.items():
            infinite.setdefault(column, []).append(rows + before)
        before += len(block.time)
    return RowBlock(
        np.concatenate([block.time for block in blocks]),
        tuple(np.concatenate(parts) for parts in zip(*(block.values for block in blocks), strict=True)),
        np.concatenate([block.lines for block in blocks]),
        {key: np.concatenate(parts) for key, parts in words.items()},
        {column: np.concatenate(parts) for column, parts in infinite.items()},
        blocks[-1].encoding,
    )


class Tally:
    """Words for missing and infinite values of a log, counted as its rows go by."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names
        self._words: dict[tuple[int, str], tuple[int, int]] = {}  # count, first line
        self._infinite: dict[int, int] = {}

    def add(self, block: RowBlock) -> None:
        """Count those of further rows."""
        for key, rows in block.words.items():
            count, first = self._words.get(key, (0, int(block.lines[rows[0]])))
            self._words[key] = count + len(rows), first
        for column, rows in block.infinite.items():
            self._infinite[column] = self._infinite.get(column, 0) + len(rows)

    def remarks(self) -> tuple[str, ...]:
        """Return a remark on each, by column."""
        found = [
            (column, f"column {self._names[column]!r}: {count} cells {word!r} read as missing, "
            f"first in line {first}")
            for (column, word), (count, first) in self._words.items()
        ]  # fmt: skip
        found += [
            (column, f"column {self._names[column]!r}: {count} infinite values read as missing")
            for column, count in self._infinite.items()
        ]
        return tuple(text for _, text in sorted(found, key=lambda item: item[0]))


class Growing:
    """An array that is filled block by block and never held twice."""

    def __init__(self, expected: int) -> None:
        self._array = np.empty(max(expected, 1))
        self._size = 0

    def extend(self, values: FloatArray) -> None:
        """Add values behind the last."""
        size = self._size + len(values)
        if size > len(self._array):
            # the allocator moves pages of a large array, not its bytes
            self._array.resize(max(size, len(self._array) * 5 // 4), refcheck=False)
        self._array[self._size : size] = values
        self._size = size

    def array(self) -> FloatArray:
        """Return what was added."""
        self._array.resize(self._size, refcheck=False)
        return self._array
