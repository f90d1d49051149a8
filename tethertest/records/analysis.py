"""What an analysis found: lines, events, waves of one run or log, and the curves of many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Final

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Side, Window
from tethertest.records.described import Doc
from tethertest.records.events import CycleCount, Extremes, Front, Snap, WaveSpeed
from tethertest.records.frames import axes_or_new, table
from tethertest.records.lines import ChannelLines, DriveFit, Event
from tethertest.records.response import NaturalFrequency
from tethertest.records.waves import LargestTension, Waves

if TYPE_CHECKING:
    import pandas as pd

    from tethertest.records.frames import Axes

MEASURED, REPLAYED = Side.MEASURED, Side.REPLAYED
#: columns of `Analysis.to_pandas`
LINE_COLUMNS: Final = (
    "channel", "side", "order", "frequency_Hz", "amplitude", "lowest", "highest", "unit", "phase_rad",
    "p_value", "verdict", "reason",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Peak:
    """A line that a blind search found; it has no verdict."""

    frequency: Annotated[float, Doc("[Hz]")]
    amplitude: Annotated[float, Doc("peak of a cosine, in the channel's unit")]
    p_value: Annotated[float, Doc("of this frequency alone")]
    significant: Annotated[bool, Doc("over all frequencies of the record")]


@dataclass(frozen=True, slots=True, eq=False)
class ChannelAnalysis:
    """One channel and all that was found in it."""

    channel: Channel
    side: Side
    lines: ChannelLines | None = None
    no_lines: str = ""  #: why there are none
    peaks: tuple[Peak, ...] = ()  #: of a blind search, where there is no drive to go by
    events: tuple[Event, ...] = ()
    no_events: str = ""  #: why slack was not looked for
    extremes: Extremes | None = None  #: in the window
    cycles: CycleCount | None = None  #: in the window; of tensions

    @property
    def snaps(self) -> tuple[Snap, ...]:
        """The snaps that were measured."""
        return tuple(event.snap for event in self.events if event.snap is not None)


@dataclass(frozen=True, slots=True)
class WaveFindings:
    """Waves of a run: fronts and what they imply, parts going up and down, largest tension."""

    fronts: tuple[Front, ...] = ()
    speed: WaveSpeed | None = None
    parts: tuple[Waves, ...] = ()
    largest: LargestTension | None = None
    remarks: tuple[str, ...] = ()  #: why something is not there


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """A run, a store or a bare log, analysed."""

    path: str
    name: str
    drive: DriveFit | None
    window: Window | None
    channels: tuple[ChannelAnalysis, ...]
    natural_frequencies: tuple[NaturalFrequency, ...]
    mains: float  #: [Hz]
    significance: float  #: chance of one false line in a channel
    waves: WaveFindings
    notes: tuple[str, ...]

    def to_pandas(self) -> pd.DataFrame:
        """Return the lines, one a row; amplitudes in the channel's unit, with their 95 % interval."""
        rows = [
            {
                "channel": item.channel.name,
                "side": item.side,
                "order": line.order,
                "frequency_Hz": line.frequency,
                "amplitude": line.amplitude,
                "lowest": line.interval[0],
                "highest": line.interval[1],
                "unit": item.channel.unit,
                "phase_rad": line.phase,
                "p_value": line.p_value,
                "verdict": line.verdict.value,
                "reason": line.reason,
            }
            for item in self.channels
            if item.lines is not None
            for line in item.lines.lines
        ]
        return table(rows, LINE_COLUMNS)

    def plot(self, axes: Axes | None = None, channel: str | None = None) -> Axes:
        """Draw the amplitudes of one channel's lines, the first one's if none is named; return the axes.

        Raises
        ------
        DataError
            There is no such channel, or no lines were looked for in it.
        """
        lines = {i.channel.name: i for i in reversed(self.channels) if i.lines is not None}
        name = channel or next((i.channel.name for i in self.channels if i.lines is not None), "")
        if name not in lines:
            message = (
                f"channel {name!r} has no lines" if name else "no lines were looked for: there is no drive"
            )
            raise DataError(message, f"name one of {', '.join(lines)}" if lines else "give a drive frequency")
        found = lines[name].lines
        assert found is not None
        used = axes_or_new(axes)
        heights = [line.amplitude for line in found.lines]
        reach = [[max(0.0, line.amplitude - line.interval[0]) for line in found.lines]]
        reach.append([max(0.0, line.interval[1] - line.amplitude) for line in found.lines])
        used.errorbar(
            [line.frequency for line in found.lines], heights, reach, fmt="o", capsize=3, label=name
        )
        used.set_yscale("log")
        used.set_xlabel("frequency [Hz]")
        used.set_ylabel(f"amplitude [{found.unit}]")
        used.legend()
        return used

    def find(self, name: str, side: Side = MEASURED) -> ChannelAnalysis | None:
        """Return the channel of that name, if it was analysed."""
        return next((c for c in self.channels if c.channel.name == name and c.side == side), None)
