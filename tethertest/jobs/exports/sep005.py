"""SEP005: the list of channel dictionaries that structural-dynamics programs exchange, as JSON.

References
----------
SDyPy Enhancement Proposal 005 as https://github.com/OWI-Lab/sdypy-sep005-compliance checks it: keys data,
name, unit_str, and time or fs; quantity, start_timestamp and group are optional, others but ``timestamp``
are allowed.
"""

from __future__ import annotations

import datetime as dt
import json
import math
from typing import Any

from tethertest.jobs.exports.source import BLOCK, Exported, Series
from tethertest.records.channel import Flag
from tethertest.store.layout import SOURCE_TEXTS
from tethertest.store.whole import WholeFile

#: kind of a channel -> letter of its quantity
_QUANTITIES = {"tension": "f", "acceleration": "a", "velocity": "v", "displacement": "d", "strain": "e"}


def write_sep005(file: WholeFile, run: Exported) -> None:
    """Write all channels as one JSON file.

    Parameters
    ----------
    file : WholeFile
        An open file.
    run : Exported
        Each channel's ``time`` counts from its ``start_timestamp``, that of its first sample, which is
        rounded to a microsecond; the exact time of that sample after the run's date is ``time_of_start``.
        A missing value is null.
    """
    file.write(b"[")
    for number, series in enumerate(run.series):
        file.write(b",\n" if number else b"\n")
        _write_channel(file, run, series)
    file.write(b"\n]\n")
    file.check()


def _write_channel(file: WholeFile, run: Exported, series: Series) -> None:
    about = _about(run, series)
    start = about["time_of_start"]
    file.write(json.dumps(about, ensure_ascii=False, allow_nan=False)[:-1].encode())
    for key in ("time", "data", "flags"):
        file.write(f',\n"{key}": ['.encode())
        for first in range(0, series.size, BLOCK):
            block = series.read(first, first + BLOCK)
            if key == "time":
                cells = [repr(time - start) for time in block.time.tolist()]
            elif key == "data":
                cells = ["null" if math.isnan(value) else repr(value) for value in block.values.tolist()]
            else:
                cells = [str(flag) for flag in block.flags.tolist()]
            file.write(((", " if first else "") + ", ".join(cells)).encode())
            file.check()
        file.write(b"]")
    file.write(b"}")


def _about(run: Exported, series: Series) -> dict[str, Any]:
    first = series.read(0, 1)
    start = float(first.time[0]) if first.time.size else 0.0
    said: dict[str, Any] = {
        "name": first.name,
        "unit_str": first.unit,
        "start_timestamp": (run.date + dt.timedelta(seconds=start)).isoformat(),
        "group": run.run,
        "time_of_start": start,
        "kind": first.kind,
        "uncertainty": first.uncertainty,
        "noise": first.noise,
        "flag_meanings": {(flag.name or "").lower(): int(flag) for flag in Flag if flag},
    }
    if first.kind in _QUANTITIES:
        said["quantity"] = _QUANTITIES[first.kind]
    if first.at is not None:
        said["at"] = first.at
    source = first.source
    if source is not None:
        said["source"] = {**{key: getattr(source, key) for key in SOURCE_TEXTS}, "steps": list(source.steps)}
    return said
