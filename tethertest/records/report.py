"""Everything a report shows; render turns it into pages and makes no numbers."""

from __future__ import annotations

from dataclasses import dataclass

from tethertest.records.channel import Channel, ConditionedRun
from tethertest.records.comparison import Comparison
from tethertest.records.lines import ChannelLines, DriveFit, Event
from tethertest.records.response import Response
from tethertest.records.run import Run
from tethertest.records.similarity import Similarity


@dataclass(frozen=True, slots=True)
class Provenance:
    """What the report was made from and with."""

    software: dict[str, str]  #: package -> version
    files: tuple[tuple[str, str], ...]  #: (name, SHA-256) of run file, rig, prototype and logs
    settings: dict[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """The main job's result."""

    run: Run
    measured: ConditionedRun
    response: Response | None  #: None where nothing could be replayed
    replayed: tuple[Channel, ...]  #: at the sensors' places and times
    drive: DriveFit | None
    measured_lines: tuple[ChannelLines, ...]
    replayed_lines: tuple[ChannelLines, ...]
    events: tuple[Event, ...]  #: measured
    replayed_events: tuple[Event, ...]
    comparison: Comparison
    similarity: Similarity | None
    provenance: Provenance
