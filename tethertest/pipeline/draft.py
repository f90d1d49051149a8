"""What is concluded from the logs of a folder that has no run.toml yet."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tethertest.pipeline.sensor_names import Matched


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
