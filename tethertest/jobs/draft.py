"""What is concluded from the logs of a folder that has no run.toml yet."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tethertest.jobs.sensor_names import Matched
from tethertest.records.described import Doc


@dataclass(frozen=True, slots=True)
class DraftLog:
    """One log as the draft has it."""

    file: str
    format: str
    clock: str  #: name of an instrument, or `TODO`
    why: str  #: what the clock rests on
    matched: Matched
    problem: str = ""  #: the reader's own words where it cannot read the log as it is
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Draft:
    """Everything that was concluded from the folder."""

    folder: Path
    rig: str  #: name of the rig file, or `TODO`
    rigs: tuple[str, ...]  #: rig files that were found
    mode: str
    modes: tuple[str, ...]
    date: str
    date_why: str
    drive_hint: str
    logs: tuple[DraftLog, ...]
    left_out: tuple[tuple[str, str], ...]  #: files that are no logs, and why


@dataclass(frozen=True, slots=True)
class WrittenLog:
    """One log of a draft that was written."""

    file: Annotated[str, Doc("name in the folder")]
    format: Annotated[str, Doc("name of the reader")]
    clock: Annotated[str | None, Doc("instrument of the rig; null: a person must say")]
    channels: Annotated[dict[str, str], Doc("name in the file -> sensor, guessed from a similar name")]
    problem: Annotated[str, Doc("why the log cannot be read as it is", null="it can")]


@dataclass(frozen=True, slots=True)
class WrittenDraft:
    """What ``new`` wrote, and what is left to a person."""

    path: Annotated[Path, Doc("the run file")]
    rig: Annotated[str | None, Doc("name of the rig file; null: a person must say")]
    logs: Annotated[tuple[WrittenLog, ...], Doc("in the order of the file")]
    left_out: Annotated[tuple[str, ...], Doc("files that are no logs")]
    todo: Annotated[tuple[str, ...], Doc("lines to complete, with their number")]
