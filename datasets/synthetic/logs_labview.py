"""LabVIEW measurement files of the load cells."""

from __future__ import annotations

from datetime import datetime

from .instruments import Record
from .stamps import moment

NAMES = {"tension_top": "F_top", "tension_bottom": "F_bottom"}


def write_lvm(record: Record, date: datetime, comma: bool, operator: str) -> bytes:
    """Return the file: with decimal commas it also carries a time column."""
    start = moment(date, float(record.reading[0]))
    sign = "," if comma else "."
    time = f"{start:%H:%M:%S}{sign}{start.microsecond:06d}0000000000000"
    names = list(NAMES)
    count = len(names)
    samples = record.reading.size
    step = f"{1.0 / record.rate:.6f}".replace(".", sign)

    def row(key: str, value: str) -> str:
        return "\t".join([key, *[value] * count]) + "\t"

    head = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Reader_Version\t2",
        "Separator\tTab",
        f"Decimal_Separator\t{sign}",
        "Multi_Headings\tYes",
        f"X_Columns\t{'One' if comma else 'No'}",
        "Time_Pref\tAbsolute",
        f"Operator\t{operator}",
        f"Date\t{start:%Y/%m/%d}",
        f"Time\t{time}",
        "***End_of_Header***\t",
        "\t",
        "\t".join(["Channels", str(count)]) + "\t" * count,
        row("Samples", str(samples)),
        row("Date", f"{start:%Y/%m/%d}"),
        row("Time", time),
        row("Y_Unit_Label", "mV/V"),
        row("X_Dimension", "Time"),
        row("X0", f"0{sign}0000000000000000E+0"),
        row("Delta_X", step),
        "***End_of_Header***" + "\t" * (count + 1),
        "\t".join(["X_Value", *[NAMES[name] for name in names], "Comment"]),
    ]
    decimals = len(f"{1.0 / record.rate:g}") - 2
    columns = [record.channels[name] for name in names]
    body = []
    for index, values in enumerate(zip(*columns, strict=True)):
        time_cell = f"{index / record.rate:.{decimals}f}" if comma else ""
        body.append("\t".join([time_cell, *[f"{value:.6f}" for value in values]]))
    text = "\r\n".join(body) + "\r\n"
    if comma:
        text = text.replace(".", ",")
    return ("\r\n".join(head) + "\r\n" + text).encode("latin-1")
