"""Numbers of a table against Python's own ``float``, and fields against a split by hand."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tethertest.kernels import decimals, fields

Run = Callable[[Any], Any]


def scan(
    run,
    text,
    *,
    separator=",",
    decimal=".",
    kinds,
    least=None,
    counter=-1,
    decimals=9,
    odd=64,
    quotes=True,
    comments=True,
):
    data = np.frombuffer(text.encode(), np.uint8)
    kinds = np.array(kinds, np.uint8)
    places = np.zeros(len(kinds), np.int64)
    for kind in (fields.NUMBER, fields.STAMP):
        places[kinds == kind] = np.arange(np.count_nonzero(kinds == kind))
    capacity = text.count("\n")
    form = fields.RowForm(
        0 if separator == " " else ord(separator), ord(decimal), len(kinds) if least is None else least,
        kinds, places, counter, decimals, quotes, comments,
    )  # fmt: skip
    values = np.full((max(1, int(np.sum(kinds == fields.NUMBER))), capacity), -7.0)
    found = fields.RowArrays(
        values=values,
        words=values.view(np.uint64),
        ticks=np.zeros(capacity, np.int64),
        stamps=np.full((int(np.sum(kinds == fields.STAMP)), capacity, 24), 255, np.uint8),
        lines=np.zeros(capacity, np.int64),
        odd=np.zeros((odd, 4), np.int64),
    )
    end = run(fields.scan_rows)(data, form, found, fields.Reached(0, 0, 0))
    rows = end.rows
    return {
        "values": found.values[:, :rows].tolist(),
        "ticks": found.ticks[:rows].tolist(),
        "lines": found.lines[:rows].tolist(),
        "stamps": [[bytes(cell).rstrip(b"\0").decode() for cell in column[:rows]] for column in found.stamps],
        "odd": [(row, column, text.encode()[a:b].decode()) for row, column, a, b in found.odd[: end.odds]],
        "status": end.status,
        "count": end.fields,
        "position": end.position,
        "line": end.line,
    }


def bits(run, digits, exponent):
    return np.uint64(run(decimals.double_bits)(np.uint64(digits), exponent)).view(np.float64).item()


def test_doubles_are_the_nearest(run: Run) -> None:
    chance = random.Random(1)
    for _ in range(3000):
        digits = chance.randrange(10 ** chance.randrange(1, 20))
        exponent = chance.randrange(decimals.LOWEST, decimals.HIGHEST + 1)
        assert bits(run, digits, exponent) == float(f"{digits}e{exponent}")


def test_doubles_half_way_between_two_go_to_the_even_one(run: Run) -> None:
    chance = random.Random(2)
    for _ in range(1000):
        odd = 2 * chance.randrange(2**52, 2**53) + 1  # needs one bit more than a double has
        for shift in (0, 1, 3):
            exact = Fraction(odd, 2**shift)
            digits, exponent = exact, 0
            while digits.denominator > 1:
                digits, exponent = digits * 10, exponent - 1
            if digits < 2**64:
                assert bits(run, int(digits), exponent) == float(exact)


def test_the_ends_of_the_table_of_powers(run: Run) -> None:
    for exponent in (decimals.LOWEST, -28, -27, -5, -4, 0, 22, 23, 24, decimals.HIGHEST):
        for digits in (1, 9, 2**53 - 1, 2**53 + 1, 2**64 - 1):
            assert bits(run, digits, exponent) == float(f"{digits}e{exponent}")
    assert bits(run, 0, 5) == 0.0


CELLS = [
    "0", "-0.0", "+1.5", "1.", ".5", "-1e5", "1E+05", "1.25e-3", "123456789.123456789", "0.1",
    "9007199254740993", "1234567890123456789", "0.30000000000000004", "1e22", "1e23", "5e-324",
]  # fmt: skip


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("blank", ["", " "])
@pytest.mark.parametrize("quote", ["", '"'])
def test_cells_are_what_float_makes_of_them(run: Run, decimal: str, blank: str, quote: str) -> None:
    rows = "".join(f"{quote}{blank}{cell}{blank}{quote};1\r\n" for cell in CELLS).replace(".", decimal)
    found = scan(run, rows, separator=";", decimal=decimal, kinds=[0, 0])
    assert found["odd"] == [(15, 0, f"{quote}{blank}5e-324{blank}{quote}".strip())]
    assert found["values"][0][:-1] == [float(cell) for cell in CELLS[:-1]]
    assert str(found["values"][0][1]) == "-0.0"


@pytest.mark.parametrize(
    "cell",
    ["1e", "e5", "--5", "1..5", "1_0", "0x10", "1 5", "-", ".", "1,5", "nan", "5.1N", "12345678901234567890"],
)
def test_what_is_no_plain_number_is_left_to_the_caller(run: Run, cell: str) -> None:
    found = scan(run, f"0;{cell}\n1;2\n", separator=";", kinds=[0, 0])
    assert found["odd"] == [(0, 1, cell)]
    np.testing.assert_array_equal(found["values"], [[0, 1], [np.nan, 2]])


def test_blank_cells_rows_and_comments(run: Run) -> None:
    found = scan(run, "1,,3\n\n  \n#x,y\n,5, \r\n", kinds=[0, 0, 0])
    np.testing.assert_array_equal(found["values"], [[1, np.nan], [np.nan, 5], [3, np.nan]])
    assert (found["lines"], found["line"], found["odd"]) == ([0, 4], 5, [])


def test_runs_of_blanks_separate(run: Run) -> None:
    found = scan(run, "  1   2\n3\t4  \n5 6 7\n", separator=" ", kinds=[0, 0])
    assert found["values"] == [[1.0, 3.0], [2.0, 4.0]]
    assert (found["status"], found["count"], found["line"]) == (fields.WIDTH, 3, 2)


@pytest.mark.parametrize(("row", "count"), [("1", 1), ("1,2,3", 3), ("", 0)])
def test_the_scan_stops_before_a_row_of_another_width(run: Run, row: str, count: int) -> None:
    found = scan(run, f"1,x\n{row}\n3,4\n", kinds=[0, 0])
    if not row:
        assert found["status"] == fields.DONE
        return
    assert (found["status"], found["count"], found["line"], found["position"]) == (fields.WIDTH, count, 1, 4)
    assert found["odd"] == [(0, 1, "x")]


def test_an_open_quote_stops_the_scan(run: Run) -> None:
    found = scan(run, '"1,2\n3,4\n', kinds=[0, 0])
    assert (found["status"], found["position"]) == (fields.QUOTE, 0)


def test_without_quotes_a_quote_is_a_character(run: Run) -> None:
    found = scan(run, '"1,"\n2,3\n', kinds=[0, 0], quotes=False)
    assert (found["status"], found["odd"]) == (fields.DONE, [(0, 0, '"1'), (0, 1, '"')])


def test_without_comments_every_line_is_a_row(run: Run) -> None:
    found = scan(run, "1,2\n#x,y\n , \n", kinds=[0, 0], comments=False)
    assert (found["lines"], found["odd"]) == ([0, 1, 2], [(1, 0, "#x"), (1, 1, "y")])
    np.testing.assert_array_equal(found["values"], [[1, np.nan, np.nan], [2, np.nan, np.nan]])


def test_a_quoted_separator_does_not_separate(run: Run) -> None:
    found = scan(run, '"1,5","a,""b"",c"\n"2,5",d\n', decimal=",", kinds=[0, 2])
    assert found["values"] == [[1.5, 2.5]]
    assert found["status"] == fields.DONE


def test_behind_the_last_column_nothing_may_stand(run: Run) -> None:
    found = scan(run, "1,\n2, \n3\n4,x\n", kinds=[0, 3], least=1)
    assert found["values"] == [[1.0, 2.0, 3.0, 4.0]]
    assert found["odd"] == [(3, 1, "x")]


def test_stamps_are_copied_without_blanks_and_quotes(run: Run) -> None:
    text = '1, 2026-09-05 14:20 \n2," 14:20:00  "\n3,\n4,' + "9" * 25 + "\n"
    found = scan(run, text, kinds=[0, 1])
    assert found["stamps"] == [["2026-09-05 14:20", "14:20:00", "", ""]]
    assert found["odd"] == [(3, 1, "9" * 25)]


def test_ticks_are_exact_where_doubles_are_not(run: Run) -> None:
    text = "1788588000.123456789,1\n-1.5,1\n1.5e3,1\n99999999999,1\n1788588000.1234567894,1\n"
    found = scan(run, text, kinds=[0, 0], counter=0)
    assert found["ticks"][:3] == [1788588000123456789, -1500000000, 1500 * 10**9]
    assert found["odd"] == [(3, 0, "99999999999"), (4, 0, "1788588000.1234567894")]


def test_ticks_are_rounded_to_their_last_decimal(run: Run) -> None:
    found = scan(run, "0.1234564,1\n0.1234565,1\n-0.12345659,1\n", kinds=[0, 0], counter=0, decimals=6)
    assert found["ticks"] == [123456, 123457, -123457]


def test_a_full_list_of_odd_cells_stops_the_scan_before_a_row(run: Run) -> None:
    found = scan(run, "a,b\nc,1\nd,2\n", kinds=[0, 0], odd=4)
    assert (found["status"], found["position"], found["line"]) == (fields.FULL, 8, 2)
    assert [cell for _, _, cell in found["odd"]] == ["a", "b", "c"]
