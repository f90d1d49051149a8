"""Logged and conditioned time series: what an instrument wrote, and what it means."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass, replace
from enum import IntFlag, StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Protocol

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FlagArray, FloatArray, frozen, increases
from tethertest.records.described import Doc
from tethertest.records.frames import drawn, series, table
from tethertest.signal.series import sampling_interval
from tethertest.units import Kind

if TYPE_CHECKING:
    import pandas as pd

    from tethertest.records.frames import Axes


class Flag(IntFlag):
    """Quality of one sample; flags are kept beside the data and nothing is deleted."""

    NONE = 0
    MISSING = 1
    DUPLICATE_TIME = 2
    BACKWARD_TIME = 4
    GAP = 8  #: first sample after dropped rows
    STUCK = 16
    OUT_OF_RANGE = 32
    SATURATED = 64
    SPIKE = 128
    STEP = 256
    HUM = 512
    DRIFT = 1024
    LOST = 2048  #: the grating's peak was not seen
    SLIPPED = 4096  #: found in another column and put back
    CLOCK_JUMP = 8192
    EXCLUDED = 16384


#: samples that no analysis uses
UNUSABLE = (
    Flag.MISSING | Flag.STUCK | Flag.OUT_OF_RANGE | Flag.SATURATED | Flag.SPIKE | Flag.LOST | Flag.EXCLUDED
)


@dataclass(frozen=True, slots=True, eq=False)
class RawChannel:
    """One channel as logged: any clock, backward and duplicate stamps included."""

    name: str  #: as the file has it
    unit: str  #: as written; "" where the file says nothing
    time: FloatArray  #: (n,) [s] since the log's start, by the logger's own stamps or rate
    values: FloatArray  #: (n,) as written, NaN where the logger left a hole
    flags: FlagArray | None = None  #: (n,) `Flag` bits that only the file itself could tell, if there are any
    as_written: FloatArray | None = None  #: (n,) where the reader put values of gratings into other columns

    def to_pandas(self) -> pd.Series[float]:
        """Return the values as written, over the logger's own time [s]."""
        return series(self.time, self.values, self.name, self.unit)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the values as written, and return the axes."""
        return drawn(axes, [(self.time, self.values, self.name)], f"as written [{self.unit or 'no unit'}]")


class Fingerprint(Protocol):
    """What tells the file of a log from any other."""

    @property
    def sha256(self) -> str:
        """Hash of the file."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class RawLog:
    """One log as read, with everything that was concluded from its content."""

    path: Path
    format: str  #: NAME of the reader
    start: dt.datetime | None  #: first stamp as written; naive where the file has no zone
    channels: tuple[RawChannel, ...]
    encoding: str = ""
    decimal: str = ""
    separator: str = ""
    date_order: str = ""  #: ymd, dmy or mdy where the file has dates
    header_line: int | None = None  #: line of the column names, from 1
    rate: float | None = None  #: [Hz], as the file states it
    remarks: tuple[str, ...] = ()  #: what a person should know: lost rows, text events, segments
    reason: str = ""  #: why this reader was chosen
    row_lines: tuple[tuple[int, int], ...] = ()  #: row and its line, from 1, where lines do not just follow
    fingerprint: Fingerprint | None = None  #: None where a reader was called by itself

    def to_pandas(self) -> pd.DataFrame:
        """Return all samples as logged, one a row: stamps may repeat, go back and differ between channels.

        The columns are ``channel``, ``time_s``, ``value`` and ``unit``.
        """
        import pandas as pd

        parts = [
            pd.DataFrame({"channel": c.name, "time_s": c.time, "value": c.values, "unit": c.unit})
            for c in self.channels
        ]
        return (
            pd.concat(parts, ignore_index=True)
            if parts
            else table([], ["channel", "time_s", "value", "unit"])
        )

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw all channels as written, and return the axes."""
        lines = [(channel.time, channel.values, channel.name) for channel in self.channels]
        return drawn(axes, lines, "as written")

    def line_of(self, row: int) -> int | None:
        """Return the line of the file in which a row (from 0) stands; None where the reader does not say."""
        begun = [(first, line) for first, line in self.row_lines if first <= row]
        return begun[-1][1] + row - begun[-1][0] if begun else None

    @property
    def sha256(self) -> str:
        """Hash of the file as it lies on disk, taken when it is first asked for; "" without a fingerprint.

        Raises
        ------
        FileFormatError
            The file has changed since it was read.
        """
        return "" if self.fingerprint is None else self.fingerprint.sha256


class Side(StrEnum):
    """Where a channel comes from; the value is the word in JSON."""

    MEASURED = "measured"
    REPLAYED = "replayed"


@dataclass(frozen=True, slots=True)
class Source:
    """Where a channel comes from and what was done to it."""

    file: str
    sha256: str
    reader: str
    unit_as_written: str
    clock: str
    steps: tuple[str, ...] = ()  #: each conditioning step with its constants


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """One time series in SI; measured and replayed channels share this type."""

    name: str  #: sensor of the rig, e.g. "tension_top"
    kind: Kind  #: made of its value too
    unit: str  #: SI unit
    time: FloatArray  #: (n,) [s], strictly increasing
    values: FloatArray  #: (n,), NaN where missing
    flags: FlagArray  #: (n,) `Flag` bits
    at: float | None = None  #: fraction of the cable's length from the bottom
    uncertainty: float = 0.0  #: standard uncertainty of scale, relative
    noise: float = 0.0  #: standard deviation of one sample, in `unit`
    source: Source | None = None
    offset_uncertainty: float = 0.0  #: standard uncertainty of a constant added to all values, in `unit`

    def __post_init__(self) -> None:
        object.__setattr__(self, "kind", Kind(self.kind))
        if not self.time.shape == self.values.shape == self.flags.shape or self.time.ndim != 1:
            message = (
                f"channel {self.name!r}: time {self.time.shape}, values {self.values.shape} and flags "
                f"{self.flags.shape} must be 1-D and equally long"
            )
            raise ValueError(message)
        if not increases(self.time):
            message = f"channel {self.name!r}: time does not increase"
            raise DataError(message, "rebuild the clock before making a channel")
        object.__setattr__(self, "time", frozen(self.time))
        object.__setattr__(self, "values", frozen(self.values))
        object.__setattr__(self, "flags", frozen(self.flags, np.uint16))

    @property
    def rate(self) -> float:
        """Usual sampling rate [Hz], gaps left out."""
        return 1.0 / sampling_interval(self.time) if self.time.size > 1 else 0.0

    @property
    def usable(self) -> BoolArray:
        """(n,) True where a sample may enter an analysis."""
        usable: BoolArray = np.isfinite(self.values) & ((self.flags & np.uint16(UNUSABLE)) == 0)
        return usable

    def to_pandas(self) -> pd.Series[float]:
        """Return the usable values over time [s]; what no analysis uses is NaN."""
        return series(self.time, np.where(self.usable, self.values, np.nan), self.name, self.unit)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the usable values over time, and return the axes."""
        values = np.where(self.usable, self.values, np.nan)
        return drawn(axes, [(self.time, values, self.name)], f"{self.kind} [{self.unit}]")

    def flag_counts(self) -> dict[str, int]:
        """Return the number of samples per flag, without zeros, by lower-case name."""
        counts = {
            flag.name.lower(): int(np.count_nonzero(self.flags & np.uint16(flag)))
            for flag in Flag
            if flag and flag.name
        }
        return {name: count for name, count in counts.items() if count}

    def between(self, start: float, stop: float) -> Channel:
        """Return the part with ``start <= time <= stop``."""
        first, last = np.searchsorted(self.time, start, "left"), np.searchsorted(self.time, stop, "right")
        return self.rows(int(first), int(last))

    def rows(self, start: int, stop: int) -> Channel:
        """Return the samples from number `start` up to and without number `stop`."""
        part = slice(start, stop)
        return replace(self, time=self.time[part], values=self.values[part], flags=self.flags[part])

    def with_values(self, values: FloatArray, step: str | None = None, *, unit: str | None = None) -> Channel:
        """Return a channel with other values at the same times, and the step on record."""
        changed = replace(self, values=values, unit=self.unit if unit is None else unit)
        return changed if step is None else changed.with_step(step)

    def with_flags(self, where: BoolArray, flag: Flag) -> Channel:
        """Return a channel with `flag` added where the mask is true."""
        if not np.any(where):
            return self
        flags = self.flags.copy()
        flags[where] |= np.uint16(flag)
        return replace(self, flags=flags)

    def with_step(self, step: str) -> Channel:
        """Return a channel with one more conditioning step on record."""
        if self.source is None:
            return self
        return replace(self, source=replace(self.source, steps=(*self.source.steps, step)))

    def with_time(self, time: FloatArray, step: str) -> Channel:
        """Return a channel on another clock, and the step on record."""
        return replace(self, time=time).with_step(step)


@dataclass(frozen=True, slots=True)
class ClockFit:
    """How one instrument's clock reads against the reference: ``t_clock = offset + (1 + drift) t_reference``.

    Both count seconds from the date of run.toml, each by its own stamps.
    """

    clock: Annotated[str, Doc("instrument of the rig")]
    reference: Annotated[str, Doc("the clock that it is held against")]
    offset: Annotated[float, Doc("what the clock shows at reference time zero [s]")]
    offset_error: Annotated[float, Doc("standard error [s]", null="not known")]
    drift: Annotated[float, Doc("by which the clock runs faster than the reference, relative")]
    drift_error: Annotated[float, Doc("standard error of the drift", null="not known")]
    method: Annotated[str, Doc("what the alignment rests on")]
    remarks: Annotated[tuple[str, ...], Doc("what a person should know of it")] = ()

    def to_reference(self, time: FloatArray) -> FloatArray:
        """Return reference times of stamps of this clock."""
        return (np.asarray(time) - self.offset) / (1.0 + self.drift)


@dataclass(frozen=True, slots=True)
class Window:
    """A span of the run's clock, with how it was found."""

    start: float  #: [s]
    stop: float  #: [s]
    reason: str = "found"

    @property
    def length(self) -> float:
        """Length [s]."""
        return self.stop - self.start


class Severity(StrEnum):
    """How much a finding weighs; the value is the word in JSON."""

    NOTE = "note"
    WARNING = "warning"  #: told beside the verdict
    FATAL = "fatal"  #: nothing can be decided


@dataclass(frozen=True, slots=True)
class Finding:
    """Something an audit saw that a person must know."""

    subject: Annotated[str, Doc("channel, clock or file")]
    kind: Annotated[str, Doc("name of a flag or of a fault, such as saturated or day_month_swapped")]
    text: Annotated[str, Doc("what was seen, in words")]
    severity: Annotated[Severity, Doc("fatal: nothing can be decided")] = Severity.WARNING
    spans: Annotated[
        tuple[tuple[float, float], ...], Doc("where, start and stop on the run's clock [s]")
    ] = ()
    samples: Annotated[int, Doc("how many samples it concerns")] = 0


@dataclass(frozen=True, slots=True, eq=False)
class ConditionedRun:
    """The measured side of a run: calibrated, tared, flagged, on one clock."""

    channels: tuple[Channel, ...]
    clocks: tuple[ClockFit, ...]
    findings: tuple[Finding, ...]
    rest_before: Window | None
    rest_after: Window | None
    steady: Window | None

    def channel(self, name: str) -> Channel | None:
        """Return the channel of that sensor, if the run has it."""
        return next((channel for channel in self.channels if channel.name == name), None)

    def to_pandas(self) -> pd.DataFrame:
        """Return the usable values, a column a channel, over the run's time [s].

        Channels keep their own times: where one has no sample at a time of another, there is NaN.
        """
        import pandas as pd

        return pd.concat([channel.to_pandas() for channel in self.channels], axis="columns").sort_index()

    def plot(self, axes: Axes | None = None, kind: str = "tension") -> Axes:
        """Draw all channels of one kind, and return the axes."""
        shown = [channel for channel in self.channels if channel.kind == kind]
        lines = [(c.time, np.where(c.usable, c.values, np.nan), c.name) for c in shown]
        return drawn(axes, lines, f"{kind} [{shown[0].unit}]" if shown else kind)
