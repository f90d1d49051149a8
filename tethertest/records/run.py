"""The run file: which logs, which drive, which settings, and what a person decided by hand."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Final, Literal

from tethertest.records.described import Doc
from tethertest.records.quantity import SI
from tethertest.records.rig import Rig

Instant = Annotated[float, SI("s")]
Span = tuple[Instant, Instant]


@dataclass(frozen=True, slots=True)
class Drive:
    """The drive as it was set."""

    kind: Annotated[Literal["crank-slider", "harmonic", "measured", "none"], Doc("what moved the bottom end")]
    frequency: Annotated[float, SI("Hz", "nominal; the fit starts here", above=0.0)] | None = None
    radius: Annotated[float, SI("m", "of the crank", above=0.0)] | None = None
    amplitude: Annotated[float, SI("m", "of a harmonic motion, peak", above=0.0)] | None = None


@dataclass(frozen=True, slots=True)
class RunPlatform:
    """Which of the rig's platform modes the run used."""

    mode: Annotated[str, Doc("one of the rig's platform.modes")]


@dataclass(frozen=True, slots=True)
class Log:
    """One table of a file of the run folder; the settings are only for what the file itself leaves open."""

    file: Annotated[str, Doc("name of a file in the run folder")]
    clock: Annotated[str, Doc("name of the rig's instrument whose clock stamped it")]
    channels: Annotated[dict[str, str], Doc("name in the file -> sensor of the rig, where they differ")] = (
        field(default_factory=dict)
    )
    format: Annotated[str, Doc("name of the reader")] | None = None
    encoding: Annotated[str, Doc("of the text, such as utf-8")] | None = None
    decimal: Annotated[Literal[".", ","], Doc("sign before the decimals")] | None = None
    separator: Annotated[str, Doc("between columns")] | None = None
    date_order: Annotated[Literal["ymd", "dmy", "mdy"], Doc("of year, month and day in dates")] | None = None
    time_zone: Annotated[str, Doc("of the stamps, such as +08:00; else the run's")] | None = None
    skip_rows: Annotated[int, Doc("rows before the header")] = 0
    units: Annotated[dict[str, str], Doc("name in the file -> unit, where the file has none")] = field(
        default_factory=dict
    )
    table: Annotated[str, Doc("in a container: member, sheet, path of keys, group or variable")] | None = None
    columns: Annotated[tuple[str, ...], Doc("names of the columns in order, where the file has none")] = ()
    time: Annotated[str, Doc("name of the column or data set that is the time")] | None = None
    rate: Annotated[float, SI("Hz", "of the samples, where there is no time", above=0.0)] | None = None

    @property
    def key(self) -> str:
        """The file, and the table where one is named: no other log of the run has the same."""
        return self.file if self.table is None else f"{self.file}:{self.table}"


#: the settings of a log that needs none
DEFAULT: Final = Log(file="", clock="")


@dataclass(frozen=True, slots=True)
class Windows:
    """Windows chosen by hand [s on the run's clock]; what is absent is found."""

    rest_before: Annotated[Span, Doc("at rest before the drive starts, start and stop")] | None = None
    rest_after: Annotated[Span, Doc("at rest after the drive has stopped, start and stop")] | None = None
    steady: Annotated[Span, Doc("driven, after what the start left has died away, start and stop")] | None = (
        None
    )
    reason: Annotated[str, Doc("which the report prints")] | None = None


@dataclass(frozen=True, slots=True)
class Exclude:
    """A span of one channel that an analysis must leave out."""

    channel: Annotated[str, Doc("sensor of the rig")]
    span: Annotated[Span, Doc("start and stop on the run's clock")]
    reason: Annotated[str, Doc("which the report prints")]


@dataclass(frozen=True, slots=True)
class ClockOffset:
    """A clock offset set by hand."""

    value: Annotated[float, SI("s", "what the clock shows at the reference's time zero")]
    reason: Annotated[str, Doc("which the report prints")]
    error: Annotated[float, SI("s", "standard error of the value; unknown if absent", above=0.0)] | None = (
        None
    )


@dataclass(frozen=True, slots=True)
class Override:
    """What a person decided against the program's own finding."""

    clock_offset: Annotated[dict[str, ClockOffset], Doc("clock -> its offset")] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RunFile:
    """The keys of run.toml."""

    id: Annotated[str, Doc("by which reports and stores know the run")]
    rig: Annotated[str, Doc("name of a rig file, found upwards from the run folder in rigs/")]
    date: Annotated[dt.datetime, Doc("start, with its zone; reports take dates from here")]
    drive: Drive
    log: Annotated[tuple[Log, ...], Doc("[[log]] tables")]
    platform: RunPlatform = RunPlatform("free")
    title: Annotated[str, Doc("printed, never required")] = ""
    operator: Annotated[str, Doc("printed, never required")] = ""
    purpose: Annotated[Literal["validation", "calibration"], Doc("a calibration is not judged")] = (
        "validation"
    )
    windows: Windows = Windows()
    exclude: Annotated[tuple[Exclude, ...], Doc("[[exclude]] tables")] = ()
    override: Override = Override()


@dataclass(frozen=True, slots=True)
class Run:
    """A run folder with its rig: everything known before a log is opened."""

    folder: Path
    file: RunFile
    rig: Rig
    rig_path: Path
