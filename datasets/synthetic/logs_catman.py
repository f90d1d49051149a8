"""catman ASCII exports of the load cells."""

from __future__ import annotations

import math
from datetime import datetime, timedelta

from .instruments import RATED, SENSITIVITY, Record
from .logs_labview import NAMES


def write_catman(record: Record, date: datetime, comma: bool, kilonewton: bool) -> bytes:
    """Return the file.

    Its start time has whole seconds only; the time column carries the rest.

    Parameters
    ----------
    record : Record
        Both cells in mV/V.
    date : datetime
        The run's date.
    comma : bool
        Whether decimals are written with a comma.
    kilonewton : bool
        Whether the amplifier's own scaling, by the certificate, was switched on.
    """
    whole = math.floor(record.reading[0])
    start = date + timedelta(seconds=whole)
    unit = "kN" if kilonewton else "mV/V"
    step = f"{1000.0 / record.rate:g}"
    count = len(NAMES) + 1
    saved = start + timedelta(minutes=2)

    def row(first: str, others: str) -> str:
        return "\t".join([first, *[others] * (count - 1)])

    def numbered(first: str, template: str) -> str:
        return "\t".join([first, *[template.format(n) for n in range(1, count)]])

    names = ["Time  1 - default sample rate CH=0"]
    names += [f"{label} CH={n}" for n, label in enumerate(NAMES.values(), start=1)]
    full = {
        True: [f"x1=0 y1=0;x2={SENSITIVITY[name]:g} y2={RATED / 1000:g}" for name in NAMES],
        False: ["x1=0 y1=0;x2=1 y2=1" for _ in NAMES],
    }[kilonewton]
    head = [
        "HBM_CATMAN_DATAFILE_40",
        "",
        f"{saved:%Y-%m-%d}",
        f"{saved:%H:%M}",
        f"CHANNELS: {count}",
        "SEPARATOR: 9",
        f"MAXLINES: {record.reading.size:<20d}",
        "",
        "\t".join(names),
        "\t".join(["s", *[unit] * (count - 1)]),
        row(f"{start:%Y-%m-%d-%H:%M}", f"{start:%Y-%m-%d-%H:%M}"),
        "\t" * (count - 1),
        row(f"T0 ={start:%d.%m.%Y %H:%M:%S}", f"T0 ={start:%d.%m.%Y %H:%M:%S}"),
        row(f"dt ={step} ms", f"dt ={step} ms"),
        numbered("CH 0", "CH 1 - {}"),
        row("Serial no. not available", "Serial no. synthetic"),
        row("Amplifier not available ID=0", "Bridge amplifier ID=1"),
        row("Connector not available ID=0", "Full bridge connector ID=1"),
        row("Sensor type not available ID=0", "SG full bridge 350 Ohm ID=350"),
        "\t".join(["x1=0 y1=0;x2=0 y2=0", *full]),
        row("         (Electr.)", "mV/V     (Electr.)"),
        row("         (Engin.)", f"{unit}     (Engin.)"),
        row("0  Nominal value", "4 mV/V Nominal value"),
        row("Signal not available ID=0", "Net signal ID=215"),
        row("Scaling = Engineering units ID=0",
            f"Scaling = {'Engineering' if kilonewton else 'Electrical'} units ID=1"),
        row("No excitation ID=0", "5 V excitation ID=5"),
        row("Filter = Not available ID=0", "Filter = Off ID=0"),
        row("fg = Not available ID=0", "fg = Not available ID=0"),
        row("0  Zero", f"0 {unit} Zero"),
        row("0  Tare", f"0 {unit} Tare"),
        row("0  Software zero", f"0 {unit} Software zero"),
        row("Gauge factor = 0", "Gauge factor = 0"),
        row("Bridge factor = 0", "Bridge factor = 1"),
        row("Software scaling: None", "Software scaling: None"),
        row("Sensor: None", "Sensor: None"),
        row("Sensor T-ID: None", "Sensor T-ID: None"),
        row("Cable length correction Not available", "Cable length correction Not available"),
        "",
    ]  # fmt: skip
    columns = []
    for name in NAMES:
        scale = RATED / 1000.0 / SENSITIVITY[name] if kilonewton else 1.0
        columns.append(record.channels[name] * scale)
    time = record.reading - whole
    style = "{:.5f}\t{:.5E}\t{:.5E}" if kilonewton else "{:.5f}\t{:.6f}\t{:.6f}"
    rows = [style.format(*values) for values in zip(time, *columns, strict=True)]
    text = "\r\n".join(rows) + "\r\n"
    if comma:
        text = text.replace(".", ",")
    return ("\r\n".join(head) + "\r\n" + text).encode("latin-1")
