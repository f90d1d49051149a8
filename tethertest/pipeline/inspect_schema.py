"""What ``inspect --json`` prints, as types that give its JSON schema."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, TypeAdapter


class _Closed(BaseModel):
    """An object with these keys and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Channel(_Closed):
    """One channel of a log; numbers in SI."""

    name: str
    kind: str
    unit_as_written: str
    unit: str
    n: int
    rate: float | None
    duration: float
    minimum: float | None
    mean: float | None
    maximum: float | None
    flags: dict[str, int]


class TimeBase(_Closed):
    """The stamps that some channels share [s]; without a step where there are fewer than two."""

    channels: list[str]
    n: int
    first: float | None
    last: float | None
    step: float | None
    quantum: float | None
    shortest_step: float | None = None
    longest_step: float | None = None
    mean_rate: float | None = None
    jitter: float | None = None
    uneven: int
    flags: dict[str, int]
    text: str


class Log(_Closed):
    """A log that was read."""

    path: str
    refused: Literal[False]
    format: str
    reason: str
    encoding: str
    start: str | None
    decimal: str
    separator: str
    date_order: str
    header_line: int | None
    rate: float | None
    sha256: str
    channels: list[Channel]
    time_bases: list[TimeBase]
    remarks: list[str]
    entry: str | None


class Refusal(_Closed):
    """A file that was not read, and what to do about it."""

    path: str
    refused: Literal[True]
    format: str | None
    reason: str | None
    line: int | None
    message: str
    remedy: str


class Run(_Closed):
    """A run folder; refused if any of its logs is."""

    run: str
    rig: str
    refused: bool
    logs: list[Log | Refusal]


class Clock(_Closed):
    """How a clock of a run store was fitted."""

    name: str
    offset: float
    drift: float
    method: str


class Store(_Closed):
    """A run store."""

    path: str
    refused: Literal[False]
    format: str
    reason: str
    encoding: str
    start: str
    run: str
    rig: str
    channels: list[Channel]
    clocks: list[Clock]
    windows: dict[str, list[float] | None]
    remarks: list[str]


def adapter() -> Any:
    """Return what checks an object of ``inspect --json``."""
    return TypeAdapter(Log | Refusal | Run | Store)


def inspect_schema() -> dict[str, Any]:
    """Return the JSON Schema 2020-12 of one object of ``inspect --json``."""
    dialect = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": dialect, **adapter().json_schema(), "title": "tethertest inspect --json"}
