"""What a run store looks like inside; readers and writers share it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from tethertest.records.channel import ConditionedRun, Flag

#: root attribute ``format`` of every run store
FORMAT: Final = "tethertest-run"
#: root attribute ``format_version``; raised when a reader of the old one would misread the new one
VERSION: Final = 1
#: samples per chunk: 256 KiB of float64, small beside a read, large beside HDF5's own overhead
CHUNK: Final = 32768
#: byte shuffle and gzip at level 1: a rig run shrinks to 44 % of its 18 bytes per sample; level 4 saves 3 %
#: more and takes a quarter longer
COMPRESSION: Final = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
#: datasets of a channel, with their types in the file
SERIES: Final = {"time": "<f8", "value": "<f8", "flag": "<u2"}
#: figures of a channel beside its samples
CHANNEL_FIGURES: Final = ("uncertainty", "noise", "offset_uncertainty")
#: texts of a channel's source, beside its steps
SOURCE_TEXTS: Final = ("file", "sha256", "reader", "unit_as_written", "clock")
#: figures of a clock's fit
CLOCK_FIGURES: Final = ("offset", "offset_error", "drift", "drift_error")
#: windows of a run, each a group where the run has it
WINDOWS: Final = ("rest_before", "rest_after", "steady")
#: text columns of /findings
FINDING_TEXTS: Final = ("subject", "kind", "text", "severity")
#: bits that have a meaning
KNOWN_FLAGS: Final = int(sum(Flag))


@dataclass(frozen=True, slots=True)
class StoreHeader:
    """What a store says about its run beside the measured side."""

    folder: str  #: name of the run folder, without its place
    run_file: str  #: run.toml, whole
    rig: str  #: name of the rig file
    rig_file: str  #: the rig file, whole
    prototype_file: str | None = None  #: the prototype file that the rig names, whole
    software: dict[str, str] = field(default_factory=dict)  #: package -> version
    inputs: tuple[tuple[str, str], ...] = ()  #: (name, SHA-256) of every file that was read
    #: what people look for first, such as the motion: name -> text or number in SI; read from the run file,
    #: not from here
    described: dict[str, str | float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class StoredRun:
    """A run as a store holds it."""

    header: StoreHeader
    measured: ConditionedRun
