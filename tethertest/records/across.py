"""What many runs show together: amplitude against the drive, jumps, branches, hysteresis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Annotated

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Side
from tethertest.records.described import Doc
from tethertest.records.lines import ChannelLines, Line, LineVerdict
from tethertest.units import Kind

#: verdicts of what is no line of the response
NOT_FOUND = frozenset({LineVerdict.NONE, LineVerdict.LEAKAGE, LineVerdict.MAINS, LineVerdict.ALIAS})
#: verdicts of what stands out and may be no line of the response
WITHHELD = frozenset({LineVerdict.NOT_RESOLVABLE, LineVerdict.UNDETERMINED})


def is_found(line: Line) -> bool:
    """Return whether a line is there; one that a short record does not resolve at all has no amplitude."""
    return line.verdict not in NOT_FOUND and bool(line.amplitude > 0.0)


class StepVerdict(Enum):
    """What a step between two neighbouring settings is; the value is the key in JSON."""

    JUMP = "jump"
    UNDECIDED = "undecided"


class Direction(Enum):
    """How the setting moved from run to run; the value is the key in JSON."""

    UP = "up"
    DOWN = "down"
    UNORDERED = "unordered"


@dataclass(frozen=True, slots=True)
class Step:
    """A step between two neighbouring settings that the trend on both sides does not carry."""

    interval: Annotated[tuple[float, float], Doc("the two settings, the lower one first")]
    amplitudes: Annotated[tuple[float, float], Doc("at the two settings, in the order of the interval")]
    verdict: Annotated[StepVerdict, Doc("whether it is a jump")]
    excess: Annotated[float, Doc("the step over the largest of its neighbours", null="it has no neighbours")]
    reason: Annotated[str, Doc("the verdict in words")]


@dataclass(frozen=True, slots=True)
class Judgement:
    """The steps of one curve, and what they were judged by."""

    steps: tuple[Step, ...]
    significance: float  #: chance of one false jump in the curve
    scatter: float  #: from run to run, relative standard deviation, beside the lines' own errors
    refused: str = ""  #: why jumps were not looked for


@dataclass(frozen=True, slots=True)
class Branch:
    """Runs in the order of time between two turns of the setting."""

    direction: Direction
    members: tuple[int, ...]  #: places in the order of time


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """How far an up-sweep and a down-sweep lie apart."""

    area: float  #: integral of up less down over the setting both have
    interval: tuple[float, float]  #: 95 % of the area, and where in their gaps the jumps may be
    differs: tuple[float, float] | None  #: settings between which the branches differ, None where nowhere
    largest: float  #: up less down where they differ most
    largest_at: float  #: that setting
    significance: float  #: chance to call two equal branches different

    @property
    def found(self) -> bool:
        """Whether the branches differ anywhere."""
        return self.differs is not None


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """One run on a curve."""

    run: Annotated[str, Doc("its id")]
    setting: Annotated[float, Doc("drive frequency [Hz] or amplitude [m]")]
    amplitude: Annotated[float, Doc("of the line, peak of a cosine, in the channel's unit")]
    standard_error: Annotated[float, Doc("of the amplitude")]
    interval: Annotated[tuple[float, float], Doc("95 % of the amplitude")]
    verdict: Annotated[str, Doc("of the line")]
    found: Annotated[bool, Doc("whether the line is there")]
    damage: Annotated[str, Doc("why the point is shown and not judged", null="it is judged")] = ""


@dataclass(frozen=True, slots=True)
class Curve:
    """Amplitude of one order of one channel against one setting, along one branch."""

    group: int  #: place of its group
    channel: str
    kind: Kind
    unit: str
    side: Side
    order: str
    direction: Direction
    points: tuple[CurvePoint, ...]  #: in the order of time
    judgement: Judgement

    @property
    def largest(self) -> CurvePoint | None:
        """The point of the largest amplitude, of those that are sure to be lines and are judged."""
        sure = [
            point
            for point in self.points
            if point.found and not point.damage and LineVerdict(point.verdict) not in WITHHELD
        ]
        return max(sure, key=lambda point: point.amplitude, default=None)


@dataclass(frozen=True, slots=True)
class Group:
    """Runs that differ in one setting of the drive only."""

    against: str  #: "frequency" or "amplitude"
    rig: str
    mode: str  #: of the platform
    fixed: float | None  #: the other setting: amplitude [m] or frequency [Hz]
    runs: tuple[str, ...]  #: in the order of time
    branches: tuple[Branch, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Loop:
    """An up-sweep and a down-sweep of one order of one channel."""

    group: int
    channel: str
    unit: str
    side: Side
    order: str
    hysteresis: Hysteresis


@dataclass(frozen=True, slots=True, eq=False)
class RunChannel:
    """What a run contributes of one channel."""

    name: str
    kind: Kind
    unit: str
    side: Side
    at: float | None  #: fraction of the cable's length from the bottom
    lines: ChannelLines | None
    no_lines: str  #: why there are none
    damage: str  #: why its points are shown and not judged
    largest: float | None  #: largest usable value in the window less the value at rest
    noise: float  #: by how much its samples' noise may have raised `largest`
    spectrum: tuple[FloatArray, FloatArray] | None  #: frequency [Hz], amplitude as the peak of a cosine

    @property
    def found(self) -> tuple[Line, ...]:
        """The lines that are there."""
        lines = () if self.lines is None else self.lines.lines
        return tuple(line for line in lines if is_found(line))


@dataclass(frozen=True, slots=True, eq=False)
class RunPart:
    """One run of a folder, as far as curves need it."""

    run: str  #: its id
    path: str
    date: str = ""  #: ISO 8601
    time: float = math.inf  #: [s], by which runs are put in order
    rig: str = ""
    mode: str = ""  #: of the platform
    frequency: float | None = None  #: fitted [Hz]
    nominal_frequency: float | None = None  #: [Hz]
    amplitude: float | None = None  #: of the bottom motion at the drive, measured where it can be [m]
    nominal_amplitude: float | None = None  #: [m]
    amplitude_measured: bool = False  #: else it is the nominal one
    from_rest: bool = False  #: a rest was found before the drive
    axial_stiffness: float | None = None  #: [N]
    length: float | None = None  #: of the cable [m]
    channels: tuple[RunChannel, ...] = ()
    refused: str = ""  #: why the run is on no curve
    remarks: tuple[str, ...] = ()  #: what a person should know: faults found, a replay that was refused


@dataclass(frozen=True, slots=True, eq=False)
class Across:
    """A folder of runs, analysed together."""

    path: str
    runs: tuple[RunPart, ...]  #: all of them, in the order of time
    groups: tuple[Group, ...]
    curves: tuple[Curve, ...]
    loops: tuple[Loop, ...]
    significance: float  #: chance of one false jump in the folder
    notes: tuple[str, ...]
