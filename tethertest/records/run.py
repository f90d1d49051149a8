"""The run file: which logs, which drive, which settings, and what a person decided by hand."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from tethertest.records.quantity import SI
from tethertest.records.rig import Rig

Instant = Annotated[float, SI("s")]
Span = tuple[Instant, Instant]


@dataclass(frozen=True, slots=True)
class Drive:
    """The drive as it was set."""

    kind: Literal["crank-slider", "harmonic", "measured", "none"]
    frequency: Annotated[float, SI("Hz", above=0.0)] | None = None  #: nominal; the fit starts here
    radius: Annotated[float, SI("m", above=0.0)] | None = None
    amplitude: Annotated[float, SI("m", above=0.0)] | None = None


@dataclass(frozen=True, slots=True)
class RunPlatform:
    """Which of the rig's platform modes the run used."""

    mode: str


@dataclass(frozen=True, slots=True)
class Log:
    """One table of a file of the run folder; the settings are only for what the file itself leaves open."""

    file: str
    clock: str  #: name of the rig's instrument
    channels: dict[str, str] = field(default_factory=dict)  #: name in the file -> sensor of the rig
    format: str | None = None
    encoding: str | None = None
    decimal: Literal[".", ","] | None = None
    separator: str | None = None
    date_order: Literal["ymd", "dmy", "mdy"] | None = None
    time_zone: str | None = None
    skip_rows: int = 0
    units: dict[str, str] = field(default_factory=dict)  #: name in the file -> unit, where the file has none
    table: str | None = None  #: what to read in a container: member, sheet, path of keys, group or variable
    columns: tuple[str, ...] = ()  #: names of the columns in order, where the file has none
    time: str | None = None  #: name of the column or data set that is the time
    rate: Annotated[float, SI("Hz", above=0.0)] | None = None  #: rate of the samples, where there is no time

    @property
    def key(self) -> str:
        """The file, and the table where one is named: no other log of the run has the same."""
        return self.file if self.table is None else f"{self.file}:{self.table}"


@dataclass(frozen=True, slots=True)
class Windows:
    """Windows chosen by hand [s on the run's clock]; what is absent is found."""

    rest_before: Span | None = None
    rest_after: Span | None = None
    steady: Span | None = None
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class Exclude:
    """A span of one channel that an analysis must leave out."""

    channel: str
    span: Span
    reason: str


@dataclass(frozen=True, slots=True)
class ClockOffset:
    """A clock offset set by hand."""

    value: Instant
    reason: str
    error: Annotated[float, SI("s", above=0.0)] | None = None  #: its standard error; unknown if absent


@dataclass(frozen=True, slots=True)
class Override:
    """What a person decided against the program's own finding."""

    clock_offset: dict[str, ClockOffset] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RunFile:
    """The keys of run.toml."""

    id: str
    rig: str
    date: dt.datetime
    drive: Drive
    log: tuple[Log, ...]
    platform: RunPlatform = RunPlatform("free")
    title: str = ""
    operator: str = ""
    purpose: Literal["validation", "calibration"] = "validation"
    windows: Windows = Windows()
    exclude: tuple[Exclude, ...] = ()
    override: Override = Override()


@dataclass(frozen=True, slots=True)
class Run:
    """A run folder with its rig: everything known before a log is opened."""

    folder: Path
    file: RunFile
    rig: Rig
    rig_path: Path
