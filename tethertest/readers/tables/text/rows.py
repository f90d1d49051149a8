"""Rows of a log as they come, and how they are cut into pieces and put together again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tethertest.readers.tables.text.blocks import Integers
from tethertest.records.arrays import FloatArray

#: comments among the rows that are remembered, and those that are remarked one by one
_COMMENTS, _SHOWN = 1000, 5
#: lines between rows that are remembered, a block
_ANCHORS = 1000


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment among the rows."""

    row: int  #: that it stands above, in its block
    line: int  #: in the file, from 1
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class RowBlock:
    """Consecutive rows of a log: their time and the values of every channel."""

    time: FloatArray  #: (n,) [s]
    values: tuple[FloatArray, ...]  #: (n,) of each channel
    lines: Integers  #: (n,) line of each row in the file, from 1
    words: dict[tuple[int, str], Integers]  #: column, word for missing -> rows
    infinite: dict[int, Integers]  #: column -> rows
    comments: tuple[Comment, ...]  #: those that stand above a row
    encoding: str  #: of the file, as far as it was read

    def part(self, begin: int, end: int) -> RowBlock:
        """Return some of the rows."""
        return RowBlock(
            self.time[begin:end],
            tuple(values[begin:end] for values in self.values),
            self.lines[begin:end],
            {key: found for key, rows in self.words.items() if len(found := _within(rows, begin, end))},
            {key: found for key, rows in self.infinite.items() if len(found := _within(rows, begin, end))},
            tuple(replace(item, row=item.row - begin) for item in self.comments if begin <= item.row < end),
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
    comments: list[Comment] = []
    before = 0
    for block in blocks:
        for key, rows in block.words.items():
            words.setdefault(key, []).append(rows + before)
        for column, rows in block.infinite.items():
            infinite.setdefault(column, []).append(rows + before)
        comments += [replace(item, row=item.row + before) for item in block.comments]
        before += len(block.time)
    return RowBlock(
        np.concatenate([block.time for block in blocks]),
        tuple(np.concatenate(parts) for parts in zip(*(block.values for block in blocks), strict=True)),
        np.concatenate([block.lines for block in blocks]),
        {key: np.concatenate(parts) for key, parts in words.items()},
        {column: np.concatenate(parts) for column, parts in infinite.items()},
        tuple(comments),
        blocks[-1].encoding,
    )


def followed_lines(lines: Integers, row: int = 0, after: int = 0) -> Iterator[tuple[int, int]]:
    """Yield the rows that do not stand in the line behind the row before, and their lines.

    Parameters
    ----------
    lines : (n,) int64
        Lines of consecutive rows.
    row : int
        Number of the first of them.
    after : int
        Line of the row before; 0 for the first row of a log.
    """
    apart = np.flatnonzero(np.diff(lines, prepend=after if after else lines[:1] - 2) != 1)
    yield from ((row + int(place), int(lines[place])) for place in apart[:_ANCHORS])


class Tally:
    """Words for missing, infinite values and comments of a log, counted as its rows go by."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names
        self._words: dict[tuple[int, str], tuple[int, int]] = {}  # count, first line
        self._infinite: dict[int, int] = {}
        self._comments: dict[str, tuple[int, int]] = {}  # count, first line

    def add(self, block: RowBlock) -> None:
        """Count those of further rows."""
        for key, rows in block.words.items():
            count, first = self._words.get(key, (0, int(block.lines[rows[0]])))
            self._words[key] = count + len(rows), first
        for column, rows in block.infinite.items():
            self._infinite[column] = self._infinite.get(column, 0) + len(rows)
        for item in block.comments:
            count, first = self._comments.get(item.text, (0, item.line))
            if count or len(self._comments) < _COMMENTS:
                self._comments[item.text] = count + 1, first

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
        among = [
            f"comment {text!r} among the rows, {count} times, first in line {first}"
            for text, (count, first) in self._comments.items()
        ]
        if len(among) > _SHOWN:
            among = [*among[:_SHOWN], f"{len(among) - _SHOWN} further comments among the rows"]
        return (*(text for _, text in sorted(found, key=lambda item: item[0])), *among)


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
