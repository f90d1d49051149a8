"""Everything a report shows; render turns it into pages and makes no numbers."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

from tethertest.errors import DataError
from tethertest.records.channel import Channel, ConditionedRun
from tethertest.records.comparison import Comparison, Metric
from tethertest.records.frames import drawn, table
from tethertest.records.lines import ChannelLines, DriveFit, Event
from tethertest.records.response import Response
from tethertest.records.run import Run
from tethertest.records.similarity import Similarity

if TYPE_CHECKING:
    import pandas as pd

    from tethertest.records.frames import Axes


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

    def to_pandas(self) -> pd.DataFrame:
        """Return the metrics, one a row, with measured and replayed value, limit and verdict."""
        rows = [{**asdict(metric), "verdict": metric.verdict.value} for metric in self.comparison.metrics]
        return table(rows, [field.name for field in fields(Metric)])

    def plot(self, axes: Axes | None = None, channel: str | None = None) -> Axes:
        """Draw a channel measured and replayed, the first tension if none is named; return the axes.

        Raises
        ------
        DataError
            There is no such channel.
        """
        known = [one for one in self.measured.channels if one.kind in {"tension", "strain"}]
        names = [one.name for one in known]
        name = channel or next((one.name for one in known if one.kind == "tension"), "")
        if name not in names:
            message = f"there is no channel {name!r}"
            raise DataError(message, f"name one of {', '.join(names)}")
        measured = known[names.index(name)]
        lines = [(measured.time, measured.to_pandas().to_numpy(), f"{name} measured")]
        lines += [(one.time, one.values, f"{name} replayed") for one in self.replayed if one.name == name]
        return drawn(axes, lines, f"{measured.kind} [{measured.unit}]")
