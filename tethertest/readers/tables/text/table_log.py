"""A text log as a table whose rows are parsed block by block, several blocks at once."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.errors import FileFormatError
from tethertest.readers.channels import unique_names
from tethertest.readers.tables.text.blocks import Integers, Parsed, RowPlan, parse_block
from tethertest.readers.tables.text.layout import Layout, find_layout
from tethertest.readers.tables.text.rows import Comment, RowBlock
from tethertest.readers.tables.text.stamps import stamp_kind
from tethertest.readers.tables.text.table import SPACES
from tethertest.readers.tables.text.textlog import Progress, TextBlock, TextLog, open_text
from tethertest.readers.tables.time_scale import (
    STATED_START,
    Midnights,
    Numbers,
    TimeCells,
    TimeScale,
    counting_of,
    settle_scale,
)
from tethertest.readers.tables.time_search import ColumnHead, TableHead, find_time, kind_of, no_channels
from tethertest.readers.tables.time_units import CALENDARS
from tethertest.records.run import Log

#: threads that parse; more wait for the one that reads
_MOST_WORKERS: Final = 4


@dataclass(frozen=True, slots=True, eq=False)
class TableLog:
    """An opened text log: all that its beginning shows, and its rows on request."""

    text: TextLog
    layout: Layout
    plan: RowPlan
    scale: TimeScale
    channels: tuple[int, ...]  #: their columns
    expected_rows: int  #: by the size of the file; a compressed one has more
    remarks_before: tuple[str, ...]  #: on the whole log, before those on single cells
    remarks_after: tuple[str, ...]

    def blocks(self, progress: Progress | None = None) -> Iterator[RowBlock]:
        """Yield all rows from the first.

        Raises
        ------
        FileFormatError
            A row is cut or ragged, has no time, or a cell is no number.
        """
        places = [self.plan.numbers.index(column) for column in self.channels]
        row, midnights = 0, Midnights()
        open_comments: list[tuple[int, str]] = []
        for parsed, lines, encoding in _parsed(self.text, self.layout, self.plan, progress):
            open_comments += parsed.comments
            if len(lines):
                time = self.scale.seconds(_time_cells(self.plan, self.scale, parsed, lines), row)
                if self.scale.dateless:
                    time = midnights.passed(time)
                row += len(lines)
                comments = tuple(
                    Comment(int(np.searchsorted(lines, line)), line, said)
                    for line, said in open_comments
                    if line < lines[-1]
                )
                open_comments = open_comments[len(comments) :]
                self._refuse_second_start(comments)
                yield RowBlock(
                    time,
                    tuple(parsed.numbers[place] for place in places),
                    lines,
                    {key: np.sort(rows) for key, rows in parsed.words.items()},
                    {column: np.sort(rows) for column, rows in parsed.infinite.items()},
                    comments,
                    encoding,
                )
            if parsed.problem is not None:
                raise parsed.problem

    def _refuse_second_start(self, comments: Sequence[Comment]) -> None:
        """Refuse a comment among the rows that states when a recording began."""
        for item in comments:
            match = STATED_START.fullmatch(item.text)
            if match and stamp_kind(match[1]) is not None:
                message = f"the comment {item.text!r} among the rows begins a second recording"
                remedy = "save each recording in a file of its own"
                raise FileFormatError(message, remedy, path=self.text.path, line=item.line)


def open_table(path: Path, settings: Log) -> TableLog:
    """Look at the beginning of a text log, and further only where that leaves something open.

    Raises
    ------
    FileFormatError
        The log is empty, has no columns or no time, or can be read in two ways.
    """
    text = open_text(path, settings.encoding)
    layout = find_layout(text, settings)
    names, renamed = unique_names(layout.names)
    head = _head(path, layout, names)
    layout = replace(layout, names=names)
    choice = find_time(head, settings)
    counting = counting_of(head, choice, settings)
    held = no_channels(head)
    unused = tuple(
        f"column {names[place]!r} holds {what} and is not a channel"
        for place, what in held.items()
        if place not in choice.used
    )
    channels = tuple(place for place in range(layout.width) if place not in held and place not in choice.used)
    if not channels:
        message = "the log has a time but no channels"
        remedy = "choose the file that holds the data"
        raise FileFormatError(message, remedy, path=path, line=layout.header_line)
    counter = choice.columns[0] if counting is not None else None
    parts = [place for place in (counter, choice.fraction) if place is not None]
    is_exact = counting is not None and counting.decimals is not None
    time_only = RowPlan(
        path, layout.separator, layout.decimal, names,
        numbers=tuple(parts),
        stamps=choice.columns if counting is None else (),
        counter=counter if is_exact else None,
        decimals=(counting.decimals or 0) if counting is not None else 0,
        spare=len(layout.first_cells) > layout.width,
    )  # fmt: skip
    beginning = _parsed(text, layout, time_only, None)
    with closing(beginning):
        first, lines = _first_rows(path, beginning)
        waiting = TimeScale(path, choice, counting)
        later = (
            _time_cells(time_only, waiting, parsed, its_lines)
            for parsed, its_lines, _ in beginning
            if len(its_lines)
        )
        cells = _time_cells(time_only, waiting, first, lines)
        settled = settle_scale(head, choice, counting, settings, cells, later)
    no_header = ("the log has no header; its columns are numbered",) if layout.numbered else ()
    return TableLog(
        text=text,
        layout=layout,
        plan=replace(time_only, numbers=tuple(sorted({*channels, *parts}))),
        scale=settled,
        channels=channels,
        expected_rows=_expected_rows(path, layout),
        remarks_before=(*no_header, *renamed, *settled.remarks),
        remarks_after=unused,
    )


def _head(path: Path, layout: Layout, names: tuple[str, ...]) -> TableHead:
    """Return what the search for the time is shown."""
    columns = []
    for place, (name, unit, kind, cells) in enumerate(
        zip(names, layout.units, layout.kinds, layout.heads, strict=True)
    ):
        column = ColumnHead(name, unit, cells, kind, layout.names[place])
        if kind == "number" and unit.strip().lower() in CALENDARS:
            numbers = column.numbers()
            column = replace(column, cells=numbers, kind=kind_of(numbers, unit))
        columns.append(column)
    return TableHead(
        path, tuple(columns), named=not layout.numbered, header_line=layout.header_line,
        first_line=layout.first_line, comments=layout.comments,
    )  # fmt: skip


def _time_cells(plan: RowPlan, scale: TimeScale, parsed: Parsed, lines: Integers) -> TimeCells:
    """Return the time of the rows of a block as it is written."""
    choice = scale.choice
    numbers: Numbers = np.empty(0)
    if scale.counting is not None:
        numbers = parsed.numbers[plan.numbers.index(choice.columns[0])]
    fraction = None
    if choice.fraction is not None:
        fraction = parsed.numbers[plan.numbers.index(choice.fraction)]
    return TimeCells(lines, numbers, parsed.ticks, 10.0**plan.decimals, list(parsed.stamps), fraction)


def _expected_rows(path: Path, layout: Layout) -> int:
    """Guess the number of rows from the first one; rows of a log are of much the same length."""
    length = sum(map(len, layout.first_cells)) + len(layout.first_cells)
    return path.stat().st_size // length + 1


def _first_rows(path: Path, blocks: Iterator[tuple[Parsed, Integers, str]]) -> tuple[Parsed, Integers]:
    for parsed, lines, _ in blocks:
        if len(lines):
            return parsed, lines
        if parsed.problem is not None:
            raise parsed.problem
    message = "the log has a header but no data rows"
    remedy = "the logger was stopped before its first sample; choose another file"
    raise FileFormatError(message, remedy, path=path)


def _parsed(
    text: TextLog, layout: Layout, plan: RowPlan, progress: Progress | None
) -> Generator[tuple[Parsed, Integers, str], None, None]:
    """Yield the blocks in order, with the lines of their rows in the file and the encoding so far."""
    workers = min(_MOST_WORKERS, os.cpu_count() or 1)
    blank = b" \t\r\n" if layout.separator == SPACES else b" \r\n" + layout.separator.encode()
    blocks = text.blocks(layout.first_line, blank, progress)
    waiting: deque[tuple[Future[Parsed], str]] = deque()
    line = layout.first_line
    pool = ThreadPoolExecutor(workers)
    try:
        block: TextBlock | None
        while (block := next(blocks, None)) is not None or waiting:
            if block is not None:
                waiting.append((pool.submit(parse_block, block, plan), block.encoding))
                if len(waiting) <= workers:
                    continue
            future, encoding = waiting.popleft()
            parsed = future.result()
            problem = parsed.problem
            if problem is not None:
                place = line - 1 + (problem.line or 1)
                error = FileFormatError(problem.problem, problem.remedy, path=problem.path, line=place)
                yield replace(parsed, problem=error), parsed.lines + line, encoding
                return
            at = tuple((line + place, said) for place, said in parsed.comments)
            yield replace(parsed, comments=at), parsed.lines + line, encoding
            line += parsed.line_count
    finally:
        # Without a wait: a log dropped half read is ended by the garbage collector, which may run within
        # the start of another thread; to join one from there would wait for a lock that the start holds.
        pool.shutdown(wait=False, cancel_futures=True)
