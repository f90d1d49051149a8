"""Cells of an instrument's rows: numbers, words, text, and the first mistake by line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers.tables.text.columns import read_columns
from tethertest.readers.tables.text.table import find_rows


def columns(text, width, *, quotes=False, **options):
    rows = find_rows(Path("log"), text.encode(), 7, "\t", ".", quotes=quotes)
    return read_columns(rows, width, ["a", "b", "c"][:width], **options)


@pytest.mark.parametrize("beside", ["2", "n/a"])
def test_infinite_values_are_missing_whatever_stands_beside_them(beside):
    found = columns(f"1\tInfinity\n2\t-inf\n3\t1e400\n4\t{beside}\n", 2)
    np.testing.assert_array_equal(found.numbers[1][:3], [np.nan] * 3)
    assert found.remarks[-1] == "column 'b': 3 infinite values read as missing"


def test_words_for_missing_are_told_by_column_with_their_first_line():
    found = columns("1\tNaN\n--\tlost\n--\tNaN\n", 2)
    assert found.remarks == (
        "column 'a': 2 cells '--' read as missing, first in line 8",
        "column 'b': 2 cells 'NaN' read as missing, first in line 7",
        "column 'b': 1 cells 'lost' read as missing, first in line 8",
    )


def test_the_first_mistake_is_that_of_the_first_line():
    with pytest.raises(FileFormatError, match=r"found '0x10' in column 'b'") as caught:
        columns("1\t2\n3\t0x10\n1_0\t4\n", 2)
    assert caught.value.line == 8


def test_every_line_is_a_row_and_a_quote_is_a_character():
    found = columns('#1\t1\n \t2\n"x\t3\n', 2, texts={0})
    assert found.texts == {0: ["#1", "", '"x']}
    assert found.numbers[1].tolist() == [1.0, 2.0, 3.0]


def test_quoted_text_is_read_without_its_quotes():
    found = columns('"a ""b"""\t"1"\n"µm"\t2\n', 2, quotes=True, texts={0})
    assert found.texts == {0: ['a "b"', "µm"]}
    assert found.numbers[1].tolist() == [1.0, 2.0]


def test_short_rows_end_blank_and_unused_columns_are_left_out():
    found = columns("1\t2\tx\n3\n", 3, unused={2})
    assert sorted(found.numbers) == [0, 1]
    np.testing.assert_array_equal(found.numbers[1], [2.0, np.nan])
