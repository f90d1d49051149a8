"""Excel workbooks, written by openpyxl and damaged part by part."""

from __future__ import annotations

import datetime as dt
import io
import sys
import zipfile

import numpy as np
import openpyxl
import pytest

from tethertest.errors import FileFormatError
from tethertest.readers import identify, read_log
from tethertest.readers.guards import limits
from tethertest.readers.tables.containers import sheet, workbook
from tethertest.records.run import DEFAULT

T = np.arange(20) / 50.0
F = 5.0 + np.sin(T)
G = -F


def filled(sheet, head=(("time [s]", "F_top [N]", "F_low (kN)"),), rows=None, corner=(1, 1)):
    data = [*head, *(rows if rows is not None else zip(T.tolist(), F.tolist(), G.tolist(), strict=True))]
    for row, cells in enumerate(data, start=corner[0]):
        for column, cell in enumerate(cells, start=corner[1]):
            sheet.cell(row, column, cell)


@pytest.fixture
def made(tmp_path):
    """Write a workbook; `change` turns the text of a part into another."""

    def maker(fill=filled, *, change=None, name="log.bin"):
        book = openpyxl.Workbook()
        book.active.title = "log"
        fill(book.active)
        buffer = io.BytesIO()
        book.save(buffer)
        with (
            zipfile.ZipFile(buffer) as source,
            zipfile.ZipFile(tmp_path / name, "w", zipfile.ZIP_DEFLATED) as target,
        ):
            for info in source.infolist():
                text = source.read(info)
                target.writestr(info.filename, change(info.filename, text) if change else text)
        return tmp_path / name

    return maker


def in_sheet(old, new):
    def change(name, text):
        if name != "xl/worksheets/sheet1.xml":
            return text
        assert old in text, text[:2000]
        return text.replace(old, new)

    return change


def refused(path, words, settings=DEFAULT):
    with pytest.raises(FileFormatError, match=words):
        read_log(path, settings)


def test_names_units_and_values(made):
    path = made()
    assert identify(path).NAME == "excel"
    log = read_log(path)
    assert [(channel.name, channel.unit) for channel in log.channels] == [("F_top", "N"), ("F_low", "kN")]
    np.testing.assert_array_equal(log.channels[0].time, T)
    np.testing.assert_array_equal(log.channels[1].values, G)


def test_a_row_of_units_remarks_above_and_a_table_that_begins_elsewhere(made):
    def fill(sheet):
        sheet["A1"], sheet["A2"], sheet["B2"] = "Messung am Seil", "Rate", 50
        filled(sheet, (("Zeit", "Kraft oben", "Kraft unten"), ("ms", "N", "kN")), corner=(5, 3))

    log = read_log(made(fill))
    assert [(c.name, c.unit) for c in log.channels] == [("Kraft oben", "N"), ("Kraft unten", "kN")]
    np.testing.assert_allclose(log.channels[0].time, T / 1000.0, rtol=1e-15)
    np.testing.assert_array_equal(log.channels[0].values, F)


def test_dates_are_not_rounded_to_milliseconds(made):
    """openpyxl makes dates of whole milliseconds: 10 kHz would have 10 equal stamps."""
    days = 46270.5 + np.arange(20) / 86400.0 / 10_000.0

    def fill(sheet):
        filled(sheet, (("when", "F"),), zip(days.tolist(), F.tolist(), strict=True))
        for row in range(2, 22):
            sheet.cell(row, 1).number_format = "yyyy-mm-dd hh:mm:ss.000"

    log = read_log(made(fill))
    assert log.start == dt.datetime(2026, 9, 5, 12)
    np.testing.assert_allclose(log.channels[0].time, np.arange(20) / 10_000.0, atol=1e-6)


@pytest.mark.parametrize("epoch", ["1900", "1904"])
def test_both_calendars(made, epoch):
    start = dt.datetime(2026, 9, 5, 14, 20)

    def fill(sheet):
        if epoch == "1904":
            sheet.parent.epoch = openpyxl.utils.datetime.CALENDAR_MAC_1904
        rows = [(start + dt.timedelta(seconds=k), float(k % 3)) for k in range(20)]
        filled(sheet, (("Time", "F"),), rows)

    log = read_log(made(fill))
    assert log.start is not None
    assert abs(log.start - start) < dt.timedelta(microseconds=1)
    np.testing.assert_allclose(log.channels[0].time, np.arange(20.0), atol=1e-5)


def test_days_and_times_of_day_in_two_columns(made):
    def fill(sheet):
        rows = [(dt.date(2026, 9, 5), dt.time(14, 20, k), float(k % 3)) for k in range(20)]
        filled(sheet, (("Date", "Time", "F"),), rows)

    log = read_log(made(fill))
    assert log.start is not None
    assert abs(log.start - dt.datetime(2026, 9, 5, 14, 20)) < dt.timedelta(microseconds=1)
    np.testing.assert_allclose(log.channels[0].time, np.arange(20.0), atol=1e-5)


def test_stamps_as_text_stay_text_and_so_do_texts_like_formulas(made):
    def fill(sheet):
        rows = [(f"2026-09-05 14:20:{k / 50:09.6f}", float(k), "=HYPERLINK(1)") for k in range(20)]
        filled(sheet, (("Time", "F", "note"),), rows)
        for row in range(2, 22):
            sheet.cell(row, 3).data_type = "s"

    log = read_log(made(fill))
    np.testing.assert_allclose(log.channels[0].time, T, atol=1e-9)
    assert [channel.name for channel in log.channels] == ["F"]
    assert "column 'note' holds text and is not a channel" in log.remarks


@pytest.mark.parametrize(
    ("form", "unit"),
    [
        ("General", ""), ("0.00E+00", ""), ("#,##0.00", ""), ("[Red]0.0;[Blue]-0.0", ""), ('0.0 "days"', ""),
        ("0.0\\ \\d", ""), ("dd/mm/yyyy", "excel"), ("m/d/yy h:mm", "excel"), ("[h]:mm:ss", "day"),
        ("mm:ss.0", "time of day"), ("hh:mm:ss AM/PM", "time of day"),
        ("[$-409]d-mmm;@", "excel"), ("mmm", "excel"),
    ],
)  # fmt: skip
def test_what_a_format_says_that_a_number_counts(form, unit):
    assert sheet.date_unit(form, "excel") == unit


def test_missing_values_are_counted_and_excel_s_own_errors_with_them(made):
    def fill(sheet):
        filled(sheet)
        sheet["B4"], sheet["B5"], sheet["B6"] = "#DIV/0!", None, "LOST"

    log = read_log(made(fill))
    assert np.isnan(log.channels[0].values[[2, 3, 4]]).all()
    assert np.isfinite(log.channels[0].values).sum() == 17
    assert "column 'F_top': 1 values '#DIV/0!', 1 values 'LOST' read as missing" in log.remarks


def test_formulas_are_read_as_they_were_calculated(made):
    calculated = in_sheet(b"<v>-5</v>", b"<f>-B2</f><v>-5</v>")
    log = read_log(made(change=lambda n, t: calculated(n, t).replace(b'fullCalcOnLoad="1"', b"")))
    assert log.channels[1].values[0] == -5.0


def test_formulas_that_were_never_calculated_are_refused(made):
    def fill(sheet):
        filled(sheet)
        sheet["C2"] = "=-B2"

    refused(made(fill), r"the formula in C2 was never calculated\n.*let it calculate, and save it")
    # XlsxWriter leaves a zero for each, and asks Excel to calculate
    refused(made(change=in_sheet(b"<v>-5</v>", b"<f>-B2</f><v>0</v>")), "its formulas were never calculated")


def test_sheets(made, settings):
    def two(sheet):
        filled(sheet)
        filled(sheet.parent.create_sheet("second"), rows=[(k, 2.0, 3.0) for k in range(5)])
        sheet.parent.create_sheet("notes")["A1"] = "calibrated in May"

    path = made(two)
    refused(path, r"2 sheets with tables: 'log', 'second'\n.*table = \"log\" or table = \"second\"")
    assert read_log(path, settings(table="second")).channels[0].values.tolist() == [2.0] * 5
    refused(path, "table = \"third\", the workbook has 'log', 'second', 'notes'", settings(table="third"))
    refused(path, "sheet 'notes' holds no table", settings(table="notes"))


def test_hidden_sheets_are_named_and_read_only_when_asked_for(made, settings):
    def fill(sheet):
        filled(sheet)
        other = sheet.parent.create_sheet("raw")
        filled(other, rows=[(k, 2.0, 3.0) for k in range(5)])
        other.sheet_state = "hidden"

    path = made(fill)
    log = read_log(path)
    assert len(log.channels[0].values) == 20
    assert "hidden sheets are not read: 'raw'" in log.remarks
    assert len(read_log(path, settings(table="raw")).channels[0].values) == 5


def test_a_table_without_names_has_those_of_run_toml(made, settings):
    rows = [(time, k % 3, -(k % 2)) for k, time in enumerate(T.tolist())]
    path = made(lambda sheet: filled(sheet, (), rows))
    assert [channel.name for channel in read_log(path).channels] == ["column 2", "column 3"]
    log = read_log(path, settings(columns=("t", "a", "b"), time="t"))
    assert [channel.name for channel in log.channels] == ["a", "b"]


def put(**cells):
    def fill(sheet):
        filled(sheet)
        for place, value in cells.items():
            sheet[place] = value

    return fill


def merged(block):
    def fill(sheet):
        filled(sheet, corner=(2, 1))
        sheet.merge_cells(block)

    return fill


SECOND = [(k, 2.0) for k in range(9)]
ODD = {
    "text among numbers": (put(B5="broken"), r"'log' cell B5: found 'broken' in 'F_top', expected a number"),
    "number as text": (put(B5="5.25"), r"cell B5: found '5.25'.*\n.*stored as text are no numbers"),
    "all numbers as text": (
        lambda sheet: filled(sheet, (("t", "F"),), [(k / 9, str(k / 7)) for k in range(20)]),
        "'F' holds numbers stored as text",
    ),
    "tables beside each other": (
        lambda sheet: (filled(sheet), filled(sheet, (("t2 [s]", "G"),), SECOND, (1, 5))),
        "found tables beside each other, each with a time: 'time', 't2'",
    ),
    "tables side by side": (
        lambda sheet: (filled(sheet), filled(sheet, (("t2 [s]", "G"),), SECOND, (1, 4))),
        "more than one column may be the time: 'time', 't2'",
    ),
    "the time twice": (
        lambda sheet: filled(sheet, (("t", "F", "t", "G"),), [(k, 1.0, 2 * k, 2.0) for k in range(9)]),
        "the name 't' of the time in column 1 also stands over column 3",
    ),
    "true": (put(B5=True), r"cell B5: found True in 'F_top', expected a number"),
    "a date": (put(B5=dt.datetime(2026, 9, 5)), "cell B5: found a date in 'F_top', expected a number"),
    "a blank row": (put(A25=0.5, B25=1.0, C25=1.0), "sheet 'log' row 22: a blank row within the table"),
    "no name": (put(D5=1.0), "cell D1: column D has values but no name"),
    "two rows of names": (
        lambda sheet: filled(sheet, (("a", "b", "c"), ("time", "F", "G"))), "more than one row of names",
    ),
    "number above": (lambda sheet: filled(sheet, ((1, "F", "G"),)), "no row of names above it"),
    "blank time": (put(A5=None), r"sheet 'log' row 5: the row has no time"),
    "merged": (merged("B5:B9"), "the cells B5:B9 are merged within the table"),
    "empty": (lambda sheet: None, "no visible sheet holds a table"),
}  # fmt: skip


@pytest.mark.parametrize(("fill", "words"), ODD.values(), ids=ODD)
def test_what_is_not_clear_is_refused_with_its_place(made, fill, words):
    refused(made(fill), words)


def test_the_first_row_may_lack_values(made):
    rows = [(0.0, None, "LOST"), *((k / 50, 1.0, 2.0) for k in range(1, 9))]
    log = read_log(made(lambda sheet: filled(sheet, (("time [s]", "F", "G"),), rows)))
    assert [channel.values.size for channel in log.channels] == [9, 9]


def test_a_column_of_true_and_false_is_1_and_0_and_says_so(made):
    rows = [(time, float(k % 3), k % 2 == 0) for k, time in enumerate(T.tolist())]
    log = read_log(made(lambda sheet: filled(sheet, (("time [s]", "F", "trigger"),), rows)))
    assert log.channels[1].values[:3].tolist() == [1.0, 0.0, 1.0]
    assert log.channels[1].unit == ""
    assert "column 'trigger' holds true and false, read as 1 and 0" in log.remarks


def test_a_line_of_means_below_the_table_is_refused(made):
    refused(made(put(A22="Mean", B22=5.2, C22=-5.2)), "cell A22: found 'Mean' in 'time', expected a number")


def test_merged_titles_above_the_table_do_no_harm(made):
    def fill(sheet):
        filled(sheet, corner=(3, 1))
        sheet["A1"] = "rig"
        sheet.merge_cells("A1:C1")

    assert len(read_log(made(fill)).channels) == 2


ENTITY = b'<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>'
HOSTILE = {
    "entities": (in_sheet(b"<worksheet", ENTITY + b"<worksheet"), "declares entities"),
    "UTF-16": (lambda _, text: text.decode().encode("utf-16"), "not in UTF-8"),
    "another code": (
        lambda _, text: b'<?xml version="1.0" encoding="cp037"?>' + text, "not in UTF-8",
    ),
    "a row far away": (in_sheet(b'r="A5"', b'r="A9999999"'), "cell B5 stands after a later one"),
    "cells backwards": (in_sheet(b'<c r="B5"', b'<c r="D5"'), "cell C5 stands after a later one"),
    "rows backwards": (in_sheet(b'<row r="7"', b'<row r="3"'), "row 3 stands after a later one"),
    "a cell without a place": (in_sheet(b'<c r="B5"', b"<c"), "do not say where they stand"),
    "the strict form": (
        lambda _, text: text.replace(
            b"http://schemas.openxmlformats.org/spreadsheetml/2006/main",
            b"http://purl.oclc.org/ooxml/spreadsheetml/main",
        ),
        "'Strict Open XML'",
    ),
    "a column too far": (in_sheet(b'r="C5"', b'r="ZZZ5"'), "damaged|no name"),
    "no numbers": (in_sheet(b"<v>-5</v>", b"<v>1e</v>"), "the workbook is damaged"),
    "no XML": (in_sheet(b"<sheetData>", b"<sheetDat"), "the workbook is damaged"),
    "no sheet": (lambda name, text: b"" if "sheet1" in name else text, "the workbook is damaged"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "words"), HOSTILE.values(), ids=HOSTILE)
def test_hostile_parts_are_refused(made, change, words):
    refused(made(change=change), words)


def test_a_sheet_that_declares_rows_far_away_stops_at_the_limit(made, monkeypatch):
    monkeypatch.setattr(sheet, "SHEET_CELLS", 100_000)
    refused(made(put(A1048576=1.0, B1048576=1.0, C1048576=1.0)), "holds more than 100000 cells")
    assert limits.SHEET_CELLS > 1_048_576


def test_a_bomb_stops_at_the_ratio(made, monkeypatch):
    monkeypatch.setattr(workbook, "RATIO_FROM", 2**16)
    bomb = in_sheet(b"<sheetData>", b"<sheetData>" + b" " * 5 * 10**6)
    refused(made(change=bomb), "unpacks to more than a log of its size holds")


def test_a_cut_workbook_is_refused(made):
    path = made()
    data = path.read_bytes()
    for length in range(4, len(data), 97):
        path.write_bytes(data[:length])
        refused(path, "damaged or cut")


def test_a_binary_workbook_is_told(tmp_path):
    with zipfile.ZipFile(tmp_path / "log.xlsb", "w") as archive:
        archive.writestr("xl/workbook.bin", b"x")
    refused(tmp_path / "log.xlsb", r"found a binary Excel workbook \(.xlsb\)")


def test_without_openpyxl_the_error_says_what_to_install(made, monkeypatch):
    path = made()
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    refused(path, r"openpyxl that reads it is not installed\n.*pip install 'tethertest\[excel\]'")


@pytest.mark.parametrize(
    ("head", "form", "factor"),
    [
        ("strain [%]", "0.00%", 100.0),
        ("F [kN]", "0.000,", 1e-3),
        ("F [N]", "#,##0.00", 1.0),
        ("F [N]", "0.0\\%", 1.0),
        ("share", "0.00%", 1.0),
    ],
)
def test_a_column_with_a_unit_is_read_as_it_is_shown(made, head, form, factor):
    def fill(page):
        filled(page, head=(("time [s]", head),), rows=zip(T.tolist(), F.tolist(), strict=True))
        for (cell,) in page.iter_rows(min_row=2, min_col=2, max_col=2):
            cell.number_format = form

    log = read_log(made(fill))
    np.testing.assert_allclose(log.channels[0].values, factor * F)
    assert any("as it is shown" in remark for remark in log.remarks) == (factor != 1.0)


def test_a_column_shown_in_two_scales_is_refused(made):
    def fill(page):
        filled(page, head=(("time [s]", "strain [%]"),), rows=zip(T.tolist(), F.tolist(), strict=True))
        page.cell(5, 2).number_format = "0.00%"

    with pytest.raises(FileFormatError, match="shown in per cent or thousands in some rows"):
        read_log(made(fill))
