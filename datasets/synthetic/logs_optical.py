"""ENLIGHT text files of the gratings: the sensors' layout and the peaks' layout."""

from __future__ import annotations

import math
from datetime import datetime

import numpy as np

from .instruments import Record
from .stamps import clock_texts, moment

DECIMALS = 4
OUTPUTS = 4
"""Fibre outputs of the interrogator; the strain gratings are on the first."""


def write_sensors(record: Record, date: datetime, metadata: bool) -> bytes:
    """Return the layout with one named column per grating."""
    names = list(record.channels)
    start = moment(date, float(record.reading[0]))
    head = []
    if metadata:
        head = [
            "ENLIGHT synthetic export",
            "Module Address: 10.0.0.55",
            f"File Start: {start.year}/{start.month}/{start.day} {start:%H:%M:%S}",
            "Timestamp Format: Full",
            f"Data Rate (Hz): {record.rate:g}",
            "",
        ]
    head.append("\t".join(["Timestamp", *names]))
    day = f"{start.year}/{start.month}/{start.day} "
    table = np.column_stack([record.channels[name] for name in names])
    rows = [
        day + stamp + "".join(f"\t{value:.{DECIMALS}f}" for value in values)
        for stamp, values in zip(clock_texts(date, record.reading), table.tolist(), strict=True)
    ]
    return "﻿".encode() + ("\r\n".join(head + rows) + "\r\n").encode()


def write_peaks(record: Record, date: datetime) -> bytes:
    """Return the layout with the number of peaks per output before the wavelengths.

    A wavelength that is not a number was not found: it is not counted and the later ones
    move up.
    """
    start = moment(date, float(record.reading[0]))
    names = list(record.channels)
    strain = np.column_stack([record.channels[name] for name in names if name != "temp1"])
    free = record.channels["temp1"]
    day = f"{start.month}/{start.day}/{start.year} "
    rows = []
    for stamp, values, last in zip(
        clock_texts(date, record.reading), strain.tolist(), free.tolist(), strict=True
    ):
        found = [f"{value:.{DECIMALS}f}" for value in values if math.isfinite(value)]
        counts = [str(len(found)), "1", *["0"] * (OUTPUTS - 2)]
        rows.append("\t".join([day + stamp, *counts, *found, f"{last:.{DECIMALS}f}"]))
    head = [*_peaks_head(start, record.rate)]
    head.append("\t".join(["Timestamp", *[f"# CH {n}" for n in range(1, OUTPUTS + 1)]]))
    return "﻿".encode() + ("\r\n".join(head + rows) + "\r\n").encode()


def _peaks_head(start: datetime, rate: float) -> list[str]:
    """Return the peaks layout's block of settings."""
    rows = [
        "ENLIGHT synthetic export",
        "Culture: en-US",
        "Module Address: 10.0.0.55",
        f"File Start: {start.month}/{start.day}/{start.year} {start:%H:%M:%S}",
        "Timestamp Format: Full",
        f"Data Rate (Hz): {rate:g}",
        "Number of Channels: " + str(OUTPUTS),
        "Laser Scan Speed (Hz): " + f"{rate:g}",
        "Wavelength Minimum (nm): 1500",
        "Wavelength Maximum (nm): 1600",
        "",
    ]
    settings = (
        "Peak Threshold (dBm): -48",
        "Relative Threshold (dB): 6",
        "Peak Width (nm): 0.2",
        "Peak Width Level (dB): 3",
        "Peak Distance (nm): 0.5",
        "Noise Threshold (dB): 3",
        "Gain (dB): 0",
        "Distance Compensation (m): 0",
        "Averages: 1",
        "Polarization Mitigation: Off",
        "Invert: No",
        "Enabled: {}",
    )
    for output in range(1, OUTPUTS + 1):
        rows.append(f"Channel {output}")
        rows += [setting.format("Yes" if output <= 2 else "No") for setting in settings]
        rows.append("")
    return rows
