"""Last pass: final samples of long logs into the store, with what is found in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.flags.limits import (
    FlagTally,
    exclude_finding,
    excluded,
    sensor_of,
    with_range_flagged,
)
from tethertest.conditioning.flags.plausible import hole_findings
from tethertest.conditioning.rest import RunWindows
from tethertest.jobs.long_runs.columns import Sizes
from tethertest.jobs.long_runs.rest import Zeroed
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Finding, Flag
from tethertest.records.run import Run
from tethertest.signal.noise import white_noise_of
from tethertest.signal.passes import blocks_of
from tethertest.store.write import StoreWriter


class Final:
    """One sensor of a long log, with its final flags; what it finds grows as its blocks are read once."""

    def __init__(self, sensor: Zeroed, run: Run, windows: RunWindows, sizes: Sizes) -> None:
        self._sensor = sensor
        self._run = run
        self._windows = windows
        self._sizes = sizes
        self._tally = FlagTally(sensor.about.name)
        self._excludes = [item for item in run.file.exclude if item.channel == sensor.about.name]
        self._excluded = [0 for _ in self._excludes]
        self._latest: float | None = None  #: time of the latest usable sample [s]
        self._holes: list[Finding] = []

    @property
    def rows(self) -> int:
        """Samples."""
        return self._sensor.log.record.rows

    @property
    def block(self) -> int:
        """Samples at once."""
        return self._sizes.block

    def channel(self, start: int, stop: int) -> Channel:
        """Return some samples as they go into the store."""
        tared = self._sensor.channel(start, stop)
        flagged = with_range_flagged(tared, sensor_of(self._run.rig, tared))
        for item in self._excludes:
            flagged = flagged.with_flags(excluded(flagged, item), Flag.EXCLUDED)
        return flagged

    def about(self) -> Channel:
        """Return everything but the samples, the noise of one of them included."""

        def values(start: int, stop: int) -> FloatArray:
            part = self.channel(start, stop)
            usable = part.usable
            if not usable.any():
                return np.zeros(part.values.size)
            return np.interp(part.time, part.time[usable], part.values[usable])

        return replace(self._sensor.about, noise=white_noise_of(values, self.rows))

    def note(self, channel: Channel) -> None:
        """Note what a block holds; blocks come in their order, each once."""
        self._tally.note(channel)
        for number, item in enumerate(self._excludes):
            self._excluded[number] += int(np.count_nonzero(excluded(channel, item)))
        usable = channel.time[channel.usable]
        if channel.kind == "displacement" and usable.size:
            bare = usable if self._latest is None else np.concatenate(([self._latest], usable))
            zeros = np.zeros(bare.size)
            seen = replace(channel, time=bare, values=zeros, flags=zeros.astype(np.uint16))
            self._holes += hole_findings([seen], self._windows.steady, self._run.file.drive.frequency)
            self._latest = float(usable[-1])

    @property
    def findings(self) -> list[Finding]:
        """What all blocks held."""
        ends = [float(self._sensor.channel(row, row + 1).time[0]) for row in (0, self.rows - 1)]
        by_hand = [
            exclude_finding(item, count, (ends[0], ends[1]), self._run)
            for item, count in zip(self._excludes, self._excluded, strict=True)
        ]
        return [*by_hand, *self._holes, *self._tally.findings]


def final_channels(
    store: StoreWriter,
    run: Run,
    finals: Mapping[str, Final],
    others: Sequence[Channel],
    progress: Callable[[str, float | None], None],
) -> dict[str, int]:
    """Write all channels in the order of the rig's sensors, and return how many samples each has.

    Parameters
    ----------
    store : StoreWriter
        The new store.
    run : Run
        The run and its rig.
    finals : mapping of str to Final
        Sensors of long logs, by name.
    others : sequence of Channel
        Channels that are in memory.
    progress : callable
        Is told what is being done.
    """
    whole = {channel.name: channel for channel in others}
    result: dict[str, int] = {}
    for sensor in run.rig.sensor:
        if sensor.name in whole:
            channel = whole[sensor.name]
            series = store.channel(sensor.name)
            series.append(channel.time, channel.values, channel.flags)
            series.describe(channel)
            result[sensor.name] = channel.time.size
        elif sensor.name in finals:
            final = finals[sensor.name]
            about = final.about()
            series = store.channel(sensor.name)
            for start, stop in blocks_of(final.rows, final.block):
                channel = final.channel(start, stop)
                final.note(channel)
                series.append(channel.time, channel.values, channel.flags)
                progress(f"writing {sensor.name}", stop / final.rows)
            series.describe(about)
            result[sensor.name] = final.rows
    return result
