"""An analysis for other programs: SI, snake case, no number made here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from tethertest.records.analysis import Analysis, ChannelAnalysis, Peak, WaveFindings
from tethertest.records.channel import Side
from tethertest.records.described import Doc, MaybeNumber
from tethertest.records.events import Cycle, CycleCount, Extremes, Front, Interval
from tethertest.records.lines import DriveFit
from tethertest.records.response import NaturalFrequency
from tethertest.records.waves import LargestTension, OrderWaves, Waves
from tethertest.render.published import EventFound, LineFound, Paths, Span, event_found, span_of, taken
from tethertest.units import Kind

#: load cycles listed, the largest first; their number and equivalent range cover all
CYCLES_LISTED = 20
MaybeInterval = tuple[MaybeNumber, MaybeNumber]


@dataclass(frozen=True, slots=True)
class CyclesFound:
    """A rainflow count and what it amounts to."""

    number: Annotated[float, Doc("cycles, halves counted as such")]
    smallest_range: Annotated[float, Doc("ranges below this are noise and left out")]
    exponent: Annotated[float, Doc("slope of the S-N curve")]
    equivalent_range: Annotated[float, Doc("of equally many cycles of one range that do the same damage")]
    largest: Annotated[tuple[Cycle, ...], Doc(f"the {CYCLES_LISTED} of the largest range")]


@dataclass(frozen=True, slots=True)
class ChannelAnalysed:
    """One channel and all that was found in it."""

    name: Annotated[str, Doc("sensor of the rig, or channel of the log")]
    side: Side
    kind: Annotated[Kind, Doc("what it measures")]
    unit: Annotated[str, Doc("SI, where the log's unit is known")]
    lines: Annotated[tuple[LineFound, ...], Doc("by order")]
    no_lines: Annotated[str, Doc("why there are none", null="they were looked for")]
    peaks: Annotated[tuple[Peak, ...], Doc("of a blind search, where there is no drive to go by")]
    events: Annotated[tuple[EventFound, ...], Doc("in order of time")]
    no_events: Annotated[str, Doc("why slack was not looked for", null="it was, if this is a tension")]
    extremes: Annotated[Extremes | None, Doc("in the window")]
    cycles: Annotated[CyclesFound | None, Doc("load cycles of a tension in the window")]


@dataclass(frozen=True, slots=True)
class SpeedFound:
    """A wave speed from fronts at several sensors."""

    kind: Annotated[str, Doc("axial or transverse")]
    speed: Annotated[float, Doc("[m/s]", null="the fronts may have come at once")]
    interval: Annotated[MaybeInterval, Doc("95 % of the speed [m/s]; null: no bound")]
    implied: Annotated[str, Doc("what the value is: axial_stiffness or tension")]
    value: Annotated[float, Doc("that goes with the speed [N]", null="no bound")]
    value_interval: Annotated[MaybeInterval, Doc("95 % of the value [N]; null: no bound")]


@dataclass(frozen=True, slots=True)
class OrderSeparated:
    """The up- and the down-going wave of one order of the drive; amplitudes are peaks of cosines."""

    order: Annotated[str, Doc("multiple of the drive frequency")]
    frequency: Annotated[float, Doc("[Hz]")]
    up: Annotated[float, Doc("amplitude of the wave going up [N]")]
    up_interval: Annotated[Interval, Doc("95 % of up [N]")]
    down: Annotated[float, Doc("amplitude of the wave going down [N]")]
    down_interval: Annotated[Interval, Doc("95 % of down [N]")]
    energy_ratio: Annotated[float, Doc("weaker over stronger wave, 0 travelling to 1 standing")]
    energy_ratio_interval: Annotated[Interval, Doc("95 % of energy_ratio")]
    standing_wave_ratio: Annotated[float, Doc("largest over smallest amplitude", null="infinite")]
    standing: Annotated[bool | None, Doc("false: travelling; null: the interval does not settle it")]
    power: Annotated[float, Doc("mean power carried upwards [W]")]
    power_interval: Annotated[Interval, Doc("95 % of the power [W]")]
    refused: Annotated[None, Doc("the waves were separated")] = None


@dataclass(frozen=True, slots=True)
class OrderRefused:
    """An order whose waves could not be separated."""

    order: Annotated[str, Doc("multiple of the drive frequency")]
    frequency: Annotated[float, Doc("[Hz]")]
    refused: Annotated[str, Doc("why")]


@dataclass(frozen=True, slots=True)
class WavesFound:
    """Waves of one cable, seen at one section or by several sensors."""

    side: Side
    section: Annotated[str, Doc("what they rest on")]
    at: Annotated[float, Doc("fraction of the length from the bottom that the phases refer to")]
    orders: Annotated[tuple[OrderSeparated | OrderRefused, ...], Doc("by order")]


@dataclass(frozen=True, slots=True)
class OverRest:
    """The largest tension less that of the same place at rest."""

    value: Annotated[float, Doc("[N]")]
    at: Annotated[float, Doc("fraction of the length from the bottom")]
    time: Annotated[float, Doc("[s]")]


@dataclass(frozen=True, slots=True)
class LargestFound:
    """Where along the cable and when the replayed tension is largest."""

    at: Annotated[float, Doc("fraction of the length from the bottom")]
    at_interval: Annotated[Interval, Doc("where the tension comes within the stated error of it")]
    time: Annotated[float, Doc("[s]")]
    value: Annotated[float, Doc("[N]")]
    bottom: Annotated[float, Doc("largest tension at the bottom [N]")]
    top: Annotated[float, Doc("largest tension at the top [N]")]
    over_rest: OverRest


@dataclass(frozen=True, slots=True)
class AllWaves:
    """Waves of a run."""

    fronts: Annotated[tuple[Front, ...], Doc("onsets of one wave at several sensors")]
    speed: Annotated[SpeedFound | None, Doc("from the fronts")]
    parts: Annotated[tuple[WavesFound, ...], Doc("waves up and down, by what they rest on")]
    largest_tension: Annotated[LargestFound | None, Doc("null: nothing was replayed")]
    remarks: Annotated[tuple[str, ...], Doc("why something is not there")]


@dataclass(frozen=True, slots=True)
class AnalysisFound:
    """What an analysis found: the content of analysis.json."""

    path: Annotated[str, Doc("what was analysed")]
    name: Annotated[str, Doc("id of the run, or name of the log")]
    drive: Annotated[DriveFit | None, Doc("as fitted; null: no drive")]
    window: Annotated[Span | None, Doc("start and stop [s]")]
    window_reason: Annotated[str | None, Doc("how the window was found")]
    significance: Annotated[float, Doc("chance of one false line in a channel")]
    mains: Annotated[float, Doc("frequency of the mains [Hz]")]
    natural_frequencies: Annotated[tuple[NaturalFrequency, ...], Doc("of the rig, and those given")]
    channels: Annotated[tuple[ChannelAnalysed, ...], Doc("measured, then replayed")]
    waves: AllWaves
    notes: Annotated[tuple[str, ...], Doc("what a person should know")]


@dataclass(frozen=True, slots=True)
class WrittenAnalysis(AnalysisFound):
    """What ``analyze --json`` prints where it writes a folder too."""

    paths: Paths


def analysis_summary(analysis: Analysis, more_notes: tuple[str, ...] = ()) -> AnalysisFound:
    """Return an analysis as the record of its JSON.

    Parameters
    ----------
    analysis : Analysis
    more_notes : tuple of str
        Beside those of the analysis, such as figures that could not be drawn.
    """
    window = analysis.window
    return taken(
        AnalysisFound,
        analysis,
        window=span_of(window),
        window_reason=None if window is None else window.reason,
        channels=tuple(_channel(item) for item in analysis.channels),
        waves=_waves(analysis.waves),
        notes=analysis.notes + more_notes,
    )


def _channel(item: ChannelAnalysis) -> ChannelAnalysed:
    events = [event_found(event) for event in item.events]
    return taken(
        ChannelAnalysed,
        item,
        name=item.channel.name,
        kind=item.channel.kind,
        unit=item.channel.unit,
        lines=() if item.lines is None else tuple(taken(LineFound, line) for line in item.lines.lines),
        events=tuple(sorted(events, key=lambda event: event.start)),
        cycles=None if item.cycles is None else _cycles(item.cycles),
    )


def _cycles(count: CycleCount) -> CyclesFound:
    return taken(CyclesFound, count, smallest_range=count.smallest, largest=count.cycles[:CYCLES_LISTED])


def _waves(waves: WaveFindings) -> AllWaves:
    return taken(
        AllWaves,
        waves,
        speed=None if waves.speed is None else taken(SpeedFound, waves.speed),
        parts=tuple(_part(part) for part in waves.parts),
        largest_tension=None if waves.largest is None else _largest(waves.largest),
    )


def _part(waves: Waves) -> WavesFound:
    return taken(WavesFound, waves, side=waves.source, orders=tuple(_order(order) for order in waves.orders))


def _order(order: OrderWaves) -> OrderSeparated | OrderRefused:
    if order.refused:
        return taken(OrderRefused, order)
    return taken(OrderSeparated, order, standing=order.is_standing, refused=None)


def _largest(largest: LargestTension) -> LargestFound:
    over_rest = OverRest(largest.over_rest, largest.over_rest_at, largest.over_rest_time)
    return taken(LargestFound, largest, over_rest=over_rest)
