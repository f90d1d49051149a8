"""Spectral lines and events, and what was to be expected."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, StrEnum
from typing import Annotated

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Window
from tethertest.records.described import Doc
from tethertest.records.events import Snap
from tethertest.records.response import NaturalFrequency


class LineVerdict(Enum):
    """What a line is; the value is the key in JSON."""

    NONE = "none"
    HARMONIC = "harmonic"
    CRANK_HARMONIC = "crank_harmonic"
    SUBHARMONIC = "subharmonic"
    NATURAL_TRANSIENT = "natural_transient"
    INPUT_BORNE = "input_borne"
    MAINS = "mains"
    ALIAS = "alias"
    LEAKAGE = "leakage"
    NOT_RESOLVABLE = "not_resolvable"
    UNDETERMINED = "undetermined"


@dataclass(frozen=True, slots=True, eq=False)
class OrderTrack:
    """Amplitude and phase of one line, window by window."""

    time: FloatArray  #: (n,) middles of the windows [s]
    amplitude: FloatArray  #: (n,) peak of a cosine
    amplitude_error: FloatArray  #: (n,) standard error
    phase: FloatArray  #: (n,) [rad] against the line's own frequency, unwrapped
    phase_error: FloatArray  #: (n,) standard error [rad]


@dataclass(frozen=True, slots=True)
class Line:
    """One order of the drive in one channel; amplitude is the peak of a cosine."""

    order: str  #: "1", "2", "1/2", "3/2"
    frequency: float  #: [Hz]
    amplitude: float  #: de-biased, in the channel's unit
    phase: float  #: [rad] of cos(2 pi p/q f0 t + phase), t = 0 at the window's start
    interval: tuple[float, float]  #: 95 % of the amplitude, noise and calibration together
    standard_error: float  #: of the amplitude, by noise alone
    p_value: float
    verdict: LineVerdict
    reason: str
    track: OrderTrack | None = None  #: of the lines that were followed over the record
    length_needed: float | None = None  #: [s] of a record that would resolve it, where this one does not
    significant_above: float | None = None  #: raw amplitude, not de-biased, from which it is significant
    calibration_error: float = 0.0  #: standard error of the amplitude by the channel's scale alone


@dataclass(frozen=True, slots=True)
class DriveFit:
    """The drive frequency as fitted."""

    frequency: Annotated[float, Doc("fitted [Hz]")]
    standard_error: Annotated[float, Doc("of the frequency [Hz]")]
    channels: Annotated[tuple[str, ...], Doc("those it was fitted to")]


@dataclass(frozen=True, slots=True)
class ChannelLines:
    """The lines of one channel in one window."""

    channel: str
    unit: str
    window: Window
    lines: tuple[Line, ...]
    samples: int  #: used
    left_out: int  #: flagged and not used
    speed_variation: float = 0.0  #: of the drive, relative, root mean square; orders are then of crank angle

    def line(self, order: str) -> Line | None:
        """Return the line of that order, if it was looked for."""
        return next((line for line in self.lines if line.order == order), None)


class EventKind(StrEnum):
    """What happened; the value is the word in JSON."""

    SLACK = "slack"
    SNAP = "snap"


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened at a time: slack interval, snap."""

    kind: EventKind
    channel: str
    start: float  #: [s]
    stop: float  #: [s]
    value: float  #: lowest tension of a slack interval, peak of a snap [N]
    snap: Snap | None = None  #: the numbers of a snap, where it was measured


@dataclass(frozen=True, slots=True)
class Expectation:
    """What the analysis is told beforehand; empty for a bare log."""

    natural_frequencies: tuple[NaturalFrequency, ...] = ()
    crank_orders: dict[str, float] = field(
        default_factory=dict
    )  #: order -> tension amplitude over order 1, from the kinematics
    input_lines: ChannelLines | None = None  #: lines of the measured bottom motion
    mains: float = 50.0  #: [Hz]
