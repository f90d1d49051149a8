"""What an analysis found: lines, events, waves of one run or log, and the curves of many."""

from __future__ import annotations

from dataclasses import dataclass

from tethertest.records.channel import Channel, Window
from tethertest.records.events import CycleCount, Extremes, Front, Snap, WaveSpeed
from tethertest.records.lines import ChannelLines, DriveFit, Event
from tethertest.records.response import NaturalFrequency
from tethertest.records.waves import LargestTension, Waves

MEASURED, REPLAYED = "measured", "replayed"


@dataclass(frozen=True, slots=True)
class Peak:
    """A line that a blind search found; it has no verdict."""

    frequency: float  #: [Hz]
    amplitude: float  #: peak of a cosine, in the channel's unit
    p_value: float  #: of this frequency alone
    significant: bool  #: over all frequencies of the record


@dataclass(frozen=True, slots=True, eq=False)
class ChannelAnalysis:
    """One channel and all that was found in it."""

    channel: Channel
    side: str  #: `MEASURED` or `REPLAYED`
    lines: ChannelLines | None = None
    no_lines: str = ""  #: why there are none
    peaks: tuple[Peak, ...] = ()  #: of a blind search, where there is no drive to go by
    events: tuple[Event, ...] = ()
    no_events: str = ""  #: why slack was not looked for
    snaps: tuple[Snap, ...] = ()
    extremes: Extremes | None = None  #: in the window
    cycles: CycleCount | None = None  #: in the window; of tensions


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

    def find(self, name: str, side: str = MEASURED) -> ChannelAnalysis | None:
        """Return the channel of that name, if it was analysed."""
        return next((c for c in self.channels if c.channel.name == name and c.side == side), None)
