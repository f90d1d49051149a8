"""What ``inspect`` says of a log, a run folder or a run store."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from tethertest.records.described import Doc
from tethertest.units import Kind


@dataclass(frozen=True, slots=True)
class ChannelSeen:
    """One channel; numbers in SI."""

    name: Annotated[str, Doc("as the file has it; of a store, the sensor")]
    kind: Annotated[Kind, Doc("what it measures, by its unit")]
    unit_as_written: Annotated[str, Doc("empty where the file says nothing")]
    unit: Annotated[str, Doc("of the numbers here")]
    n: Annotated[int, Doc("samples")]
    rate: Annotated[float | None, Doc("one over the usual step between stamps [Hz]")]
    duration: Annotated[float, Doc("from the first stamp to the last [s]")]
    minimum: Annotated[float | None, Doc("null: no value")]
    mean: Annotated[float | None, Doc("null: no value")]
    maximum: Annotated[float | None, Doc("null: no value")]
    flags: Annotated[dict[str, int], Doc("flag -> samples that carry it; zero where it was looked for")]


@dataclass(frozen=True, slots=True)
class FewStamps:
    """The time of channels that have fewer than two stamps."""

    channels: Annotated[tuple[str, ...], Doc("those that share these stamps")]
    n: Annotated[int, Doc("rows")]
    first: Annotated[float | None, Doc("earliest stamp [s after the log's start]; null: none")]
    last: Annotated[float | None, Doc("latest stamp [s after the log's start]; null: none")]
    step: Annotated[float | None, Doc("usual step between stamps [s]; null: none")]
    quantum: Annotated[float | None, Doc("what the stamps are cut to [s]; null: they are not")]
    uneven: Annotated[int, Doc("steps that are not the usual one")]
    flags: Annotated[dict[str, int], Doc("flag of the time -> rows")]
    text: Annotated[str, Doc("all of it in a sentence")]


@dataclass(frozen=True, slots=True)
class TimeBase(FewStamps):
    """The stamps that some channels share."""

    shortest_step: Annotated[float, Doc("[s]; rows in the wrong place are put right first")]
    longest_step: Annotated[float, Doc("[s]; rows in the wrong place are put right first")]
    mean_rate: Annotated[float | None, Doc("[Hz]; null: all stamps are one")]
    jitter: Annotated[float, Doc("standard deviation of the stamps about even ones [s]", null="not known")]


@dataclass(frozen=True, slots=True)
class LogSeen:
    """A log that was read."""

    path: Annotated[str, Doc("as it was given")]
    refused: Annotated[Literal[False], Doc("it was read")]
    format: Annotated[str, Doc("name of the reader")]
    reason: Annotated[str, Doc("why this reader was chosen")]
    encoding: Annotated[str, Doc("of a text")]
    start: Annotated[str | None, Doc("first stamp, ISO 8601; no zone where the file has none")]
    decimal: Annotated[str, Doc("sign before decimals in a text")]
    separator: Annotated[str, Doc("between columns of a text")]
    date_order: Annotated[str, Doc("ymd, dmy or mdy where a text has dates")]
    header_line: Annotated[int | None, Doc("line of the column names, from 1")]
    rate: Annotated[float | None, Doc("as the file or its setting states it [Hz]")]
    sha256: Annotated[str, Doc("hash of the file as it lies on disk")]
    channels: Annotated[tuple[ChannelSeen, ...], Doc("in the order of the file")]
    time_bases: Annotated[tuple[TimeBase | FewStamps, ...], Doc("once for channels that share their stamps")]
    remarks: Annotated[tuple[str, ...], Doc("what a person should know")]
    entry: Annotated[str | None, Doc("its [[log]] table for run.toml; null: run.toml has it")]


@dataclass(frozen=True, slots=True)
class Refusal:
    """A file that was not read, and what to do about it."""

    path: Annotated[str, Doc("as it was given")]
    refused: Annotated[Literal[True], Doc("it was not read")]
    format: Annotated[str | None, Doc("name of the reader; null: none claims the file")]
    reason: Annotated[str | None, Doc("why this reader was chosen")]
    line: Annotated[int | None, Doc("of the file, from 1")]
    message: Annotated[str, Doc("what was found and expected")]
    remedy: Annotated[str, Doc("what to do")]


@dataclass(frozen=True, slots=True)
class RunSeen:
    """A run folder; refused if any of its logs is."""

    run: Annotated[str, Doc("its id")]
    rig: Annotated[str, Doc("name in the rig file")]
    refused: Annotated[bool, Doc("whether any of its logs is")]
    logs: Annotated[tuple[LogSeen | Refusal, ...], Doc("in the order of run.toml")]


@dataclass(frozen=True, slots=True)
class ClockSeen:
    """How a clock of a run store was fitted."""

    name: Annotated[str, Doc("instrument of the rig")]
    offset: Annotated[float, Doc("what the clock shows at reference time zero [s]")]
    drift: Annotated[float, Doc("by which it runs faster than the reference, relative")]
    method: Annotated[str, Doc("what the alignment rests on")]


@dataclass(frozen=True, slots=True)
class StoreSeen:
    """A run store."""

    path: Annotated[str, Doc("as it was given")]
    refused: Annotated[Literal[False], Doc("it was read")]
    format: Annotated[str, Doc("of the store")]
    reason: Annotated[str, Doc("which run, conditioned by what")]
    encoding: Annotated[str, Doc("empty: it is no text")]
    start: Annotated[str, Doc("of the run, ISO 8601")]
    run: Annotated[str, Doc("its id")]
    rig: Annotated[str, Doc("name in the rig file")]
    channels: Annotated[tuple[ChannelSeen, ...], Doc("conditioned; numbers of samples that an analysis uses")]
    clocks: Annotated[tuple[ClockSeen, ...], Doc("t_clock = offset + (1 + drift) t_reference")]
    windows: Annotated[dict[str, tuple[float, float] | None], Doc("name -> start and stop [s]")]
    remarks: Annotated[tuple[str, ...], Doc("findings, with their severity")]


Inspected = LogSeen | Refusal | RunSeen | StoreSeen
