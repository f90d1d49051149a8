"""Sound logs, one or more for each reader, whose values say which column and row they belong to.

Column k, from 1, holds ``1000 k + row + 0.25``; a grating holds ``1500 + 10 k + row / 64`` [nm]. A value that
is read under another name is seen at once.
"""

from __future__ import annotations

import datetime as dt
import io
import json
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import h5py
import numpy as np
import openpyxl
import scipy.io
from nptdms import ChannelObject, TdmsWriter

from tethertest.records.run import DEFAULT, Log

ROWS: Final = 24
STEP: Final = 0.25  #: [s]
NAMES: Final = ("F_top", "F_mid", "F_low")


@dataclass(frozen=True)
class Seed:
    """A sound log."""

    reader: str
    kind: str  #: which layout of the reader
    data: bytes
    names: tuple[str, ...]
    values: np.ndarray  #: (rows, columns)
    row_lines: tuple[str, ...] = ()  #: of a text log: the line of each row
    names_line: str = ""  #: line that holds the names, "" where each row has its own
    settings: Log = DEFAULT
    lines_between: int = 0  #: header lines between the names and the first row

    @property
    def is_text(self) -> bool:
        """Whether it is lines of text."""
        return self.reader not in {"tdms", "hdf5", "matlab", "mdf", "excel", "archive"}


def forces() -> np.ndarray:
    return 1000.0 * np.arange(1, 4) + np.arange(ROWS)[:, None] + 0.25


def gratings(rows: int = ROWS) -> np.ndarray:
    return 1500.0 + 10.0 * np.arange(1, 4) + np.arange(rows)[:, None] / 64.0


def _text(
    reader: str, kind: str, head: list[str], rows: list[str], values: np.ndarray, names: Sequence[str] = NAMES
) -> Seed:
    data = ("\n".join([*head, *rows]) + "\n").encode()
    return Seed(reader, kind, data, tuple(names), values, tuple(rows), head[-1])


def _rows(before: Callable[[int], str], values: np.ndarray, separator: str, decimal: str = ".") -> list[str]:
    return [
        separator.join([before(row), *(f"{value:.6f}" for value in line)]).replace(".", decimal)
        for row, line in enumerate(values)
    ]


def lvm(x_columns: str, decimal: str = ".") -> Seed:
    each = 2 if x_columns == "Multi" else 1
    gap = "\t" * each

    def line(key: str, cell: str) -> str:
        return key + "\t" + gap.join([cell] * 3) + "\t"

    head = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab",
        f"Decimal_Separator\t{decimal}", "Multi_Headings\tYes", f"X_Columns\t{x_columns}",
        "Time_Pref\tAbsolute", "Date\t2026/09/05", "Time\t14:20:00.5", "***End_of_Header***\t", "\t",
        "Channels\t3\t",
        line("Samples", str(ROWS)), line("Date", "2026/09/05"), line("Time", "14:20:00.5"),
        line("Y_Unit_Label", "N"), line("X_Dimension", "Time"), line("X0", "0.0E+0".replace(".", decimal)),
        line("Delta_X", f"{STEP}".replace(".", decimal)), "***End_of_Header***\t\t\t",
        "\t".join(f"X_Value\t{name}" if each == 2 or not k else name for k, name in enumerate(NAMES))
        + "\tComment",
    ]  # fmt: skip
    rows = []
    for row, values in enumerate(forces()):
        x = "" if x_columns == "No" else f"{row * STEP:.6f}"
        cells = [f"{value:.6f}" for value in values]
        line_cells = [cell for value in cells for cell in (x, value)] if each == 2 else [x, *cells]
        rows.append("\t".join(line_cells).replace(".", decimal))
    return _text("lvm", f"{x_columns} {decimal}", head, rows, forces())


def catman(decimal: str) -> Seed:
    count = 4
    names = ("Time DEVICE_1", *NAMES)

    def row(cell: str) -> str:
        return "\t".join([cell] * count)

    head = [
        "HBM_CATMAN_DATAFILE_40", "", "2017-11-13", "11:24", f"CHANNELS: {count}", "SEPARATOR: 9",
        f"MAXLINES: {ROWS}              ", "",
        "\t".join(f"{name} CH={n}" for n, name in enumerate(names, start=1)), "\t".join(["s", *["N"] * 3]),
        row("2017-11-10-17:06"), row(""), row("T0 =10.11.17 16:53:58"), row(f"dt ={STEP * 1e3:g} ms"),
        *(row(f"CH {n}") for n in range(14)), row("Cable length correction Not available"), "",
    ]  # fmt: skip
    rows = _rows(lambda k: f"{k * STEP:.3f}", forces(), "\t", decimal)
    seed = _text("catman", decimal, head, rows, forces())
    return Seed(
        seed.reader, seed.kind, seed.data, NAMES, seed.values, seed.row_lines, head[8], lines_between=21
    )


def _stamp(row: int) -> str:
    return f"2026/5/19 09:38:{row * STEP:08.5f}"


def enlight_sensors() -> Seed:
    names = ("fbg1", "fbg2", "fbg3")
    head = ["ENLIGHT Version: 3.0", "Module Type: Hyperion", "Timestamp Format: Full", "Culture: en-US ",
            "\t".join(["Timestamp", *names])]  # fmt: skip
    rows = _rows(_stamp, gratings(), "\t")
    return _text("enlight-sensors", "en-US", head, rows, gratings(), names)


def enlight_peaks() -> Seed:
    head = ["ENLIGHT Version: 3.0", "Module Type: Hyperion", "Timestamp Format: Full", "Culture: en-US ", "",
            "Timestamp\t# CH 1\t# CH 2"]  # fmt: skip
    rows = _rows(lambda k: f"{_stamp(k)}\t2\t1", gratings(), "\t")
    return _text("enlight-peaks", "2 and 1", head, rows, gratings(), ("CH1 peak1", "CH1 peak2", "CH2 peak1"))


def enlight_spectrum() -> Seed:
    head = ["7", "Culture: en-US ", "Wavelength Start (nm): 1460.00000", "Number of Points: 24", ""]
    rows = _rows(lambda k: f"{k}", forces(), "\t")
    return _text("enlight-spectrum", "spectrum", head, rows, forces())


def fbgs() -> Seed:
    values = gratings(60)
    names = ("A1", "A2", "A3")
    head = ["\t".join(["Date", "Time", "Linenumber", "Error status", *names])]
    rows = _rows(lambda k: f"19.05.2026\t09:38:{int(k * 0.25 + 0.13):02d}\t{k + 1}\t0;0", values, "\t")
    return _text("fbgs", "4 Hz", head, rows, values, names)


def toa5() -> Seed:
    head = [
        '"TOA5","rig","CR1000X","12342","CR1000X.Std.03.02","CPU:rig.CR1X","2438","Fast"',
        '"TIMESTAMP","RECORD","F_top","F_mid","F_low"', '"TS","RN","N","N","N"', '"","","Smp","Smp","Smp"',
    ]  # fmt: skip
    rows = _rows(lambda k: f'"2026-09-05 14:20:{k * STEP:05.2f}",{k}', forces(), ",")
    seed = _text("toa5", "4 Hz", head, rows, forces())
    return Seed(
        seed.reader, seed.kind, seed.data, NAMES, seed.values, seed.row_lines, head[1], lines_between=2
    )


def delimited(separator: str, decimal: str) -> Seed:
    head = [separator.join(["time [s]", *(f"{name} [N]" for name in NAMES)])]
    rows = _rows(lambda k: f"{k * STEP:.2f}", forces(), separator, decimal)
    return _text("delimited", f"{separator!r} {decimal}", head, rows, forces())


def json_rows() -> Seed:
    rows = [
        json.dumps(
            {"time [s]": k * STEP, **{f"{name} [N]": value for name, value in zip(NAMES, line, strict=True)}}
        )
        for k, line in enumerate(forces().tolist())
    ]
    data = ("[\n" + ",\n".join(rows) + "\n]\n").encode()
    return Seed("json", "objects", data, NAMES, forces(), tuple(rows))


def tdms() -> Seed:
    buffer = io.BytesIO()
    start = np.datetime64("2026-09-05T06:20:00.250000")
    waveform = {"wf_start_time": start, "wf_increment": STEP, "wf_start_offset": 0.0, "unit_string": "N"}
    with TdmsWriter(buffer) as writer:
        columns = zip(NAMES, forces().T, strict=True)
        writer.write_segment(
            [ChannelObject("rig", name, column, properties=waveform) for name, column in columns]
        )
    return Seed("tdms", "waveforms", buffer.getvalue(), NAMES, forces())


def hdf5() -> Seed:
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        file["daq/time"] = np.arange(ROWS) * STEP
        for name, column in zip(NAMES, forces().T, strict=True):
            file[f"daq/{name}"] = column
            file[f"daq/{name}"].attrs["unit"] = "N"
    return Seed("hdf5", "vectors", buffer.getvalue(), NAMES, forces())


def matlab(*, do_compression: bool) -> Seed:
    buffer = io.BytesIO()
    columns = dict(zip(NAMES, forces().T, strict=True))
    units = dict.fromkeys(NAMES, "N")
    daq = {"time": np.arange(ROWS) * STEP, **columns, "units": units}
    scipy.io.savemat(buffer, {"daq": daq}, do_compression=do_compression)  # type: ignore[arg-type]
    kind = "7, compressed" if do_compression else "5"
    return Seed("matlab", f"version {kind}", buffer.getvalue(), NAMES, forces())


def matlab_73() -> Seed:
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", userblock_size=512) as file:
        for name, column in zip(("time", *NAMES), (np.arange(ROWS) * STEP, *forces().T), strict=True):
            file[f"daq/{name}"] = column[None]
            file[f"daq/{name}"].attrs["MATLAB_class"] = np.bytes_("double")
        file["daq"].attrs["MATLAB_class"] = np.bytes_("struct")
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    return Seed("matlab", "version 7.3", head + buffer.getvalue()[128:], NAMES, forces())


def mdf(version: str, compression: Literal[0, 1, 2] = 0) -> Seed:
    from asammdf import MDF, Signal

    time = np.arange(ROWS) * STEP
    columns = zip(NAMES, forces().T, strict=True)
    with MDF(version=version) as file:
        file.start_time = dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.UTC)
        file.append([Signal(column, time, name=name, unit="N") for name, column in columns])
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / ("log.mf4" if version >= "4" else "log.mdf")
            file.save(path, compression=compression)
            data = path.read_bytes()
    return Seed("mdf", f"version {version}, compression {compression}", data, NAMES, forces())


def excel(compression: int) -> Seed:
    book = openpyxl.Workbook()
    book.active.append(["time [s]", *(f"{name} [N]" for name in NAMES)])
    for row, values in enumerate(forces().tolist()):
        book.active.append([row * STEP, *values])
    written, buffer = io.BytesIO(), io.BytesIO()
    book.save(written)
    with zipfile.ZipFile(written) as source, zipfile.ZipFile(buffer, "w", compression) as target:
        for name in source.namelist():  # openpyxl stamps each with the time of day
            if not name.startswith("docProps"):
                target.writestr(zipfile.ZipInfo(name), source.read(name), compression)
    kind = "stored" if compression == zipfile.ZIP_STORED else "deflated"
    return Seed("excel", kind, buffer.getvalue(), NAMES, forces())


def archive() -> Seed:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in (("log.csv", delimited(",", ".").data), ("notes.txt", b"none\n")):
            file.writestr(zipfile.ZipInfo(name), data)
    settings = Log(file="log.zip", clock="daq", table="log.csv")
    return Seed("archive", "two members", buffer.getvalue(), NAMES, forces(), settings=settings)


def seeds() -> dict[str, tuple[Seed, ...]]:
    """Return the seeds of each reader."""
    return {
        "lvm": (lvm("No"), lvm("One"), lvm("Multi"), lvm("One", ",")),
        "tdms": (tdms(),),
        "catman": (catman("."), catman(",")),
        "enlight-sensors": (enlight_sensors(),),
        "enlight-peaks": (enlight_peaks(),),
        "enlight-spectrum": (enlight_spectrum(),),
        "fbgs": (fbgs(),),
        "toa5": (toa5(),),
        "hdf5": (hdf5(),),
        "matlab": (matlab(do_compression=False), matlab(do_compression=True), matlab_73()),
        "mdf": (mdf("4.10"), mdf("4.11", 2), mdf("3.30")),
        "excel": (excel(zipfile.ZIP_DEFLATED), excel(zipfile.ZIP_STORED)),
        "json": (json_rows(),),
        "archive": (archive(),),
        "delimited": (delimited(",", "."), delimited(";", ","), delimited("\t", ".")),
    }
