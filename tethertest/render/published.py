"""What several commands print alike: lines, events, windows, and how a record is filled from another."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any, Literal, TypeVar

from tethertest.records.channel import Window
from tethertest.records.described import Doc
from tethertest.records.events import Interval
from tethertest.records.lines import Event, EventKind, LineVerdict

Record = TypeVar("Record")
Span = tuple[float, float]
Paths = Annotated[tuple[str, ...], Doc("files that were written")]


def taken(kind: type[Record], source: object, /, **others: Any) -> Record:
    """Return a record with the fields that another has by the same names, and with the others given."""
    names = [field.name for field in fields(kind) if field.name not in others]  # type: ignore[arg-type]
    return kind(**{name: getattr(source, name) for name in names}, **others)


def span_of(window: Window | None) -> Span | None:
    """Return start and stop of a window [s]."""
    return None if window is None else (window.start, window.stop)


@dataclass(frozen=True, slots=True)
class LineFound:
    """One order of the drive in one channel."""

    order: Annotated[str, Doc("multiple of the drive frequency, such as 2 or 1/2")]
    frequency: Annotated[float, Doc("[Hz]")]
    amplitude: Annotated[float, Doc("peak of a cosine, de-biased, in the channel's unit")]
    phase: Annotated[float, Doc("of cos(2 pi p/q f0 t + phase), t = 0 at the window's start [rad]")]
    interval: Annotated[Span, Doc("95 % of the amplitude, noise and calibration together")]
    standard_error: Annotated[float, Doc("of the amplitude, by noise alone")]
    calibration_error: Annotated[float, Doc("standard error of the amplitude by the channel's scale alone")]
    p_value: Annotated[float, Doc("chance of so large an amplitude by noise alone", null="not tested")]
    significant_above: Annotated[float | None, Doc("amplitude as fitted from which a line is significant")]
    verdict: Annotated[LineVerdict, Doc("what the line is")]
    reason: Annotated[str, Doc("the verdict in words")]


@dataclass(frozen=True, slots=True)
class SlackFound:
    """A time without tension."""

    kind: Annotated[Literal[EventKind.SLACK], Doc("no tension")]
    channel: Annotated[str, Doc("sensor of the rig")]
    start: Annotated[float, Doc("[s]")]
    stop: Annotated[float, Doc("[s]")]
    value: Annotated[float, Doc("the same as lowest [N]")]
    lowest: Annotated[float, Doc("lowest tension, low-passed [N]")]


@dataclass(frozen=True, slots=True)
class SnapFound:
    """A re-tightening after slack; but for its peak, null where the record does not show it."""

    kind: Annotated[Literal[EventKind.SNAP], Doc("a re-tightening")]
    channel: Annotated[str, Doc("sensor of the rig")]
    start: Annotated[float, Doc("when tension leaves zero [s]")]
    stop: Annotated[float, Doc("when tension is at its peak [s]")]
    value: Annotated[float, Doc("the same as peak [N]")]
    peak: Annotated[float, Doc("largest tension [N]")]
    peak_interval: Annotated[Interval | None, Doc("95 % of the peak [N]")] = None
    rise_time: Annotated[float | None, Doc("from 10 to 90 % of the peak [s]")] = None
    rise_resolved: Annotated[bool | None, Doc("false: fewer than two sampling intervals")] = None
    impulse: Annotated[float | None, Doc("until tension first falls below half the peak [N s]")] = None
    front: Annotated[float | None, Doc("largest increase within one round trip of a wave [N]")] = None
    speed: Annotated[float | None, Doc("of the two sides if the front starts at the sensor [m/s]")] = None
    speed_interval: Annotated[Interval | None, Doc("95 % of the speed [m/s]")] = None
    arrived_speed: Annotated[float | None, Doc("if the front comes from elsewhere to a rigid end")] = None


EventFound = Annotated[SlackFound | SnapFound, Doc("in order of time")]


def event_found(event: Event) -> SlackFound | SnapFound:
    """Return an event as every command prints it."""
    if event.kind == EventKind.SLACK:
        return taken(SlackFound, event, lowest=event.value)
    if event.snap is None:
        return SnapFound(EventKind.SNAP, event.channel, event.start, event.stop, event.value, event.value)
    return taken(SnapFound, event.snap, kind=EventKind.SNAP, stop=event.stop, value=event.value)
