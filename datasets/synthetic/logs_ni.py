"""NI TDMS files of the load cells, in amplifier counts."""

from __future__ import annotations

import io
from datetime import datetime

import numpy as np
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

from .instruments import Record
from .logs_labview import NAMES
from .stamps import moment

COUNT = 2e-6
"""Size of one count in mV/V."""


def write_tdms(record: Record, date: datetime, title: str) -> bytes:
    """Return the file; its times are UTC, as TDMS wants them."""
    start = moment(date, float(record.reading[0]))
    utc = np.datetime64(round(start.timestamp() * 1e6), "us")
    channels = []
    for name, label in NAMES.items():
        counts = np.round(record.channels[name] / COUNT).astype(np.int32)
        properties = {
            "wf_start_time": utc,
            "wf_increment": 1.0 / record.rate,
            "wf_start_offset": 0.0,
            "wf_samples": counts.size,
            "unit_string": "count",
            "NI_ChannelName": label,
        }
        channels.append(ChannelObject("Bridges", label, counts, properties=properties))
    buffer = io.BytesIO()
    with TdmsWriter(buffer) as writer:
        root = RootObject(properties={"name": title})
        writer.write_segment([root, GroupObject("Bridges"), *channels])
    return buffer.getvalue()
