"""What a run store is, as ``inspect`` tells it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from tethertest.jobs.stored import run_of
from tethertest.records.channel import Flag
from tethertest.records.inspected import ChannelSeen, ClockSeen, StoreSeen
from tethertest.render.published import span_of
from tethertest.store import StoredSeries, open_store
from tethertest.store.layout import FORMAT

#: samples read at once
_BLOCK = 1 << 20


def describe_store(path: Path) -> StoreSeen:
    """Describe a run store with the keys that ``inspect`` has for a log, and the run's own.

    Parameters
    ----------
    path : Path
        The store; it is read block by block.

    Raises
    ------
    FileFormatError
        As `tethertest.store.open_store`.
    """
    with open_store(path) as store:
        run = run_of(store.header, path)
        software = store.header.software.get("tethertest", "of unknown version")
        return StoreSeen(
            path=str(path),
            refused=False,
            format=FORMAT,
            reason=f"run store of {run.file.id}, conditioned by tethertest {software}",
            encoding="",
            start=run.file.date.isoformat(),
            run=run.file.id,
            rig=run.rig.name,
            channels=tuple(_channel(series) for series in store.series),
            clocks=tuple(ClockSeen(fit.clock, fit.offset, fit.drift, fit.method) for fit in store.clocks),
            windows={name: span_of(window) for name, window in store.windows.items()},
            remarks=tuple(f"({found.severity}) {found.subject}: {found.text}" for found in store.findings),
        )


def _channel(series: StoredSeries) -> ChannelSeen:
    """Return what a channel holds, over the samples that an analysis would use."""
    low, high, total, count = math.inf, -math.inf, 0.0, 0
    flags = dict.fromkeys((flag for flag in Flag if flag), 0)
    first = last = rate = None
    for start in range(0, series.size, _BLOCK):
        block = series.read(start, start + _BLOCK)
        used = block.values[block.usable]
        if used.size:
            low, high = min(low, float(used.min())), max(high, float(used.max()))
            total, count = total + float(used.sum()), count + used.size
        for flag in flags:
            flags[flag] += int(np.count_nonzero(block.flags & np.uint16(flag)))
        first = float(block.time[0]) if first is None else first
        last = float(block.time[-1])
        rate = rate or block.rate or None
    about, source = series.about, series.about.source
    return ChannelSeen(
        name=about.name,
        kind=about.kind,
        unit_as_written="" if source is None else source.unit_as_written,
        unit=about.unit,
        n=series.size,
        rate=rate,
        duration=0.0 if first is None or last is None else last - first,
        minimum=low if count else None,
        mean=total / count if count else None,
        maximum=high if count else None,
        flags={(flag.name or "").lower(): number for flag, number in flags.items() if number},
    )
