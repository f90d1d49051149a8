"""The report for other programs: SI, snake_case, NaN as null, the same bytes for the same report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding
from tethertest.records.comparison import Metric, Verdict
from tethertest.records.described import Doc
from tethertest.records.lines import ChannelLines, DriveFit, Event
from tethertest.records.report import Report
from tethertest.records.response import Response
from tethertest.records.run import Drive
from tethertest.records.similarity import Similarity
from tethertest.render.published import EventFound, LineFound, Paths, Span, event_found, span_of, taken
from tethertest.units import Kind


@dataclass(frozen=True, slots=True)
class RunSaid:
    """What run.toml says."""

    id: Annotated[str, Doc("of the run")]
    title: Annotated[str, Doc("as run.toml has it")]
    date: Annotated[str, Doc("start, ISO 8601 with its zone")]
    operator: Annotated[str, Doc("as run.toml has it")]
    purpose: Annotated[str, Doc("validation or calibration")]
    rig: Annotated[str, Doc("name in the rig file")]
    mode: Annotated[str, Doc("of the platform")]
    drive: Drive


@dataclass(frozen=True, slots=True)
class DriveUsed:
    """The drive frequency that the lines are multiples of."""

    frequency: Annotated[float, Doc("fitted [Hz]")]
    standard_error: Annotated[float, Doc("of the frequency [Hz]")]


@dataclass(frozen=True, slots=True)
class ChannelFound:
    """Lines and events of one channel."""

    name: Annotated[str, Doc("sensor of the rig")]
    unit: Annotated[str, Doc("SI")]
    lines: Annotated[tuple[LineFound, ...], Doc("by order")]
    events: Annotated[tuple[EventFound, ...], Doc("in order of time")]


@dataclass(frozen=True, slots=True)
class LinesFound:
    """Lines and events, by channel."""

    drive: Annotated[DriveUsed | None, Doc("null: no drive was found")]
    window: Annotated[Span | None, Doc("in which lines were looked for, start and stop [s]")]
    channels: Annotated[tuple[ChannelFound, ...], Doc("those with lines")]


@dataclass(frozen=True, slots=True)
class ChannelUsed:
    """One measured channel as it was compared."""

    name: Annotated[str, Doc("sensor of the rig")]
    kind: Annotated[Kind, Doc("what it measures")]
    unit: Annotated[str, Doc("SI")]
    at: Annotated[float | None, Doc("fraction of the cable's length from the bottom")]
    rate: Annotated[float, Doc("usual sampling rate [Hz]")]
    n: Annotated[int, Doc("samples")]
    noise: Annotated[float, Doc("standard deviation of one sample, in the unit", null="not known")]
    uncertainty: Annotated[float, Doc("standard uncertainty of the scale, relative", null="not known")]
    flags: Annotated[dict[str, int], Doc("flag -> samples that carry it, without zeros")]


@dataclass(frozen=True, slots=True)
class WindowsFound:
    """Spans of the run's clock, start and stop [s]; null where there is none."""

    rest_before: Annotated[Span | None, Doc("at rest before the drive")]
    steady: Annotated[Span | None, Doc("driven, in which lines were looked for")]
    rest_after: Annotated[Span | None, Doc("at rest after the drive")]


@dataclass(frozen=True, slots=True)
class SolverError:
    """Relative errors of the gauges' tension, null where not known."""

    numerical: Annotated[float, Doc("from successive meshes", null="not known")]
    model: Annotated[float | None, Doc("against the next fidelity")]
    spread: Annotated[float | None, Doc("from unknown damping and straightness, where the cable goes slack")]


@dataclass(frozen=True, slots=True)
class SolverUsed:
    """How the replay was solved; its wall time is left out, for it is never the same twice."""

    status: Annotated[str, Doc("ok, or what is wrong with the answer")]
    advice: Annotated[str, Doc("the status in words")]
    fidelity: Annotated[str, Doc("catenary, linear or nonlinear")]
    scheme: Annotated[str, Doc("of the model")]
    cells: Annotated[int, Doc("of the mesh; 0 without one")]
    time_step: Annotated[float, Doc("[s]", null="no steps")]
    error: SolverError
    slack: Annotated[dict[str, tuple[Span, ...]], Doc("gauge -> spans of zero tension, start and stop [s]")]
    warnings: Annotated[tuple[str, ...], Doc("what the solver does not vouch for")]


@dataclass(frozen=True, slots=True)
class FileUsed:
    """A file that the report rests on."""

    name: Annotated[str, Doc("of the file")]
    sha256: Annotated[str, Doc("its hash")]


@dataclass(frozen=True, slots=True)
class ChannelMade:
    """Where a channel comes from and what was done to it."""

    channel: Annotated[str, Doc("sensor of the rig")]
    file: Annotated[str, Doc("the log")]
    sha256: Annotated[str, Doc("hash of the log")]
    reader: Annotated[str, Doc("that read it")]
    unit_as_written: Annotated[str, Doc("in the log")]
    clock: Annotated[str, Doc("instrument whose clock stamped it")]
    steps: Annotated[tuple[str, ...], Doc("each conditioning step with its constants")]


@dataclass(frozen=True, slots=True)
class ProvenanceSaid:
    """What the report was made from and with."""

    software: Annotated[dict[str, str], Doc("package -> version")]
    files: Annotated[tuple[FileUsed, ...], Doc("run file, rig, prototype and logs")]
    settings: Annotated[dict[str, str], Doc("of the replay")]
    conditioning: Annotated[tuple[ChannelMade, ...], Doc("by channel")]


@dataclass(frozen=True, slots=True)
class Summary:
    """What a report says: the content of summary.json."""

    run: RunSaid
    verdict: Annotated[Verdict, Doc("of the run: pass, fail or undecided")]
    reasons: Annotated[tuple[str, ...], Doc("the verdict in words, the weightiest first")]
    metrics: Annotated[tuple[Metric, ...], Doc("measured against replayed")]
    drive: Annotated[DriveFit | None, Doc("as fitted")]
    lines: Annotated[LinesFound, Doc("of the measured channels")]
    replayed_lines: Annotated[LinesFound, Doc("of the replayed channels")]
    events: Annotated[tuple[EventFound, ...], Doc("of the measured channels")]
    replayed_events: Annotated[tuple[EventFound, ...], Doc("of the replayed channels")]
    channels: Annotated[tuple[ChannelUsed, ...], Doc("measured")]
    clocks: Annotated[tuple[ClockFit, ...], Doc("t_clock = offset + (1 + drift) t_reference")]
    findings: Annotated[tuple[Finding, ...], Doc("what the audit of the logs saw")]
    windows: WindowsFound
    solver: Annotated[SolverUsed | None, Doc("null: nothing could be replayed")]
    similarity: Annotated[Similarity | None, Doc("of the rig and its prototype")]
    provenance: ProvenanceSaid


@dataclass(frozen=True, slots=True)
class PrintedSummary(Summary):
    """What ``report --json`` prints: the content of summary.json, and where the files are."""

    paths: Paths


def summary(report: Report) -> Summary:
    """Return what the report says as the record of its JSON."""
    measured, comparison = report.measured, report.comparison
    return Summary(
        run=_run(report),
        verdict=comparison.verdict,
        reasons=comparison.reasons,
        metrics=comparison.metrics,
        drive=report.drive,
        lines=_lines(report, report.measured_lines, report.events),
        replayed_lines=_lines(report, report.replayed_lines, report.replayed_events),
        events=tuple(event_found(event) for event in report.events),
        replayed_events=tuple(event_found(event) for event in report.replayed_events),
        channels=tuple(_channel(channel) for channel in measured.channels),
        clocks=measured.clocks,
        findings=measured.findings,
        windows=WindowsFound(
            span_of(measured.rest_before), span_of(measured.steady), span_of(measured.rest_after)
        ),
        solver=None if report.response is None else _solver(report.response),
        similarity=report.similarity,
        provenance=ProvenanceSaid(
            software=report.provenance.software,
            files=tuple(FileUsed(name, digest) for name, digest in report.provenance.files),
            settings=report.provenance.settings,
            conditioning=_conditioning(measured),
        ),
    )


def _run(report: Report) -> RunSaid:
    file = report.run.file
    return taken(RunSaid, file, date=file.date.isoformat(), rig=report.run.rig.name, mode=file.platform.mode)


def _lines(report: Report, found: Sequence[ChannelLines], events: Sequence[Event]) -> LinesFound:
    drive = report.drive
    window = report.measured.steady or (found[0].window if found else None)
    channels = (
        ChannelFound(
            lines.channel,
            lines.unit,
            tuple(taken(LineFound, line) for line in lines.lines),
            tuple(event_found(event) for event in events if event.channel == lines.channel),
        )
        for lines in found
    )
    return LinesFound(None if drive is None else taken(DriveUsed, drive), span_of(window), tuple(channels))


def _channel(channel: Channel) -> ChannelUsed:
    return taken(ChannelUsed, channel, n=channel.time.size, flags=channel.flag_counts())


def _solver(response: Response) -> SolverUsed:
    status = response.status
    return taken(
        SolverUsed,
        response,
        status=status.name.lower(),
        advice=status.value,
        error=taken(SolverError, response.error),
        slack={f"{gauge:g}": spans for gauge, spans in response.slack.items()},
    )


def _conditioning(measured: ConditionedRun) -> tuple[ChannelMade, ...]:
    return tuple(
        taken(ChannelMade, channel.source, channel=channel.name)
        for channel in measured.channels
        if channel.source is not None
    )
