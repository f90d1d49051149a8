"""The report for other programs: SI, snake_case, NaN as null, the same bytes for the same report."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any, TypeAlias

from tethertest.records.channel import Channel, ClockFit, Finding, Window
from tethertest.records.comparison import Metric
from tethertest.records.lines import ChannelLines, DriveFit, Event, Line
from tethertest.records.report import Report
from tethertest.records.response import Response
from tethertest.records.similarity import PiGroup, Similarity

Json: TypeAlias = dict[str, Any]


def summary(report: Report) -> Json:
    """Return what the report says as JSON values."""
    measured, comparison = report.measured, report.comparison
    said: Json = {
        "run": _run(report),
        "verdict": comparison.verdict.value,
        "reasons": list(comparison.reasons),
        "metrics": [_metric(metric) for metric in comparison.metrics],
        "drive": _drive(report.drive),
        "lines": _lines(report, report.measured_lines, report.events),
        "replayed_lines": _lines(report, report.replayed_lines, report.replayed_events),
        "events": [_event(event) for event in report.events],
        "replayed_events": [_event(event) for event in report.replayed_events],
        "channels": [_channel(channel) for channel in measured.channels],
        "clocks": [_clock(clock) for clock in measured.clocks],
        "findings": [_finding(finding) for finding in measured.findings],
        "windows": {
            "rest_before": _window(measured.rest_before),
            "steady": _window(measured.steady),
            "rest_after": _window(measured.rest_after),
        },
        "solver": _solver(report.response),
        "similarity": similarity_summary(report.similarity) if report.similarity else None,
        "provenance": _provenance(report),
    }
    return {key: _finite(value) for key, value in said.items()}


def summary_text(report: Report) -> str:
    """Return the summary as JSON text with sorted keys."""
    return json.dumps(summary(report), sort_keys=True, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _run(report: Report) -> Json:
    file = report.run.file
    return {
        "id": file.id,
        "title": file.title,
        "date": file.date.isoformat(),
        "operator": file.operator,
        "purpose": file.purpose,
        "rig": report.run.rig.name,
        "mode": file.platform.mode,
        "drive": {
            "kind": file.drive.kind,
            "frequency": file.drive.frequency,
            "radius": file.drive.radius,
            "amplitude": file.drive.amplitude,
        },
    }


def _metric(metric: Metric) -> Json:
    return {
        "name": metric.name,
        "channel": metric.channel,
        "unit": metric.unit,
        "measured": metric.measured,
        "replayed": metric.replayed,
        "error": metric.error,
        "uncertainty": metric.uncertainty,
        "limit": metric.limit,
        "verdict": metric.verdict.value,
        "reason": metric.reason,
    }


def _drive(drive: DriveFit | None) -> Json | None:
    if drive is None:
        return None
    return {
        "frequency": drive.frequency,
        "standard_error": drive.standard_error,
        "channels": list(drive.channels),
    }


def _lines(report: Report, found: Sequence[ChannelLines], events: Sequence[Event]) -> Json:
    """Return lines in the shape that `analyze` prints."""
    drive = report.drive
    window = report.measured.steady or (found[0].window if found else None)
    return {
        "drive": None
        if drive is None
        else {"frequency": drive.frequency, "standard_error": drive.standard_error},
        "window": _window(window),
        "channels": [
            {
                "name": lines.channel,
                "unit": lines.unit,
                "lines": [_line(line) for line in lines.lines],
                "events": [_event(event) for event in events if event.channel == lines.channel],
            }
            for lines in found
        ],
    }


def _line(line: Line) -> Json:
    return {
        "order": line.order,
        "frequency": line.frequency,
        "amplitude": line.amplitude,
        "phase": line.phase,
        "interval": list(line.interval),
        "standard_error": line.standard_error,
        "calibration_error": line.calibration_error,
        "p_value": line.p_value,
        "verdict": line.verdict.value,
        "reason": line.reason,
    }


def _event(event: Event) -> Json:
    return {
        "kind": event.kind,
        "channel": event.channel,
        "start": event.start,
        "stop": event.stop,
        "value": event.value,
    }


def _channel(channel: Channel) -> Json:
    return {
        "name": channel.name,
        "kind": channel.kind,
        "unit": channel.unit,
        "at": channel.at,
        "rate": channel.rate,
        "n": int(channel.time.size),
        "noise": channel.noise,
        "uncertainty": channel.uncertainty,
        "flags": channel.flag_counts(),
    }


def _clock(clock: ClockFit) -> Json:
    return {
        "clock": clock.clock,
        "reference": clock.reference,
        "offset": clock.offset,
        "offset_error": clock.offset_error,
        "drift": clock.drift,
        "drift_error": clock.drift_error,
        "method": clock.method,
        "remarks": list(clock.remarks),
    }


def _finding(finding: Finding) -> Json:
    return {
        "subject": finding.subject,
        "kind": finding.kind,
        "text": finding.text,
        "severity": finding.severity,
        "spans": [list(span) for span in finding.spans],
        "samples": finding.samples,
    }


def _window(window: Window | None) -> list[float] | None:
    return None if window is None else [window.start, window.stop]


def _solver(response: Response | None) -> Json | None:
    """Return how the replay was solved; its wall time is left out, for it is never the same twice."""
    if response is None:
        return None
    return {
        "status": response.status.name.lower(),
        "advice": response.status.value,
        "fidelity": response.fidelity,
        "scheme": response.scheme,
        "cells": response.cells,
        "time_step": response.time_step,
        "error": {
            "numerical": response.error.numerical,
            "model": response.error.model,
            "spread": response.error.spread,
        },
        "slack": {f"{gauge:g}": [list(span) for span in spans] for gauge, spans in response.slack.items()},
        "warnings": list(response.warnings),
    }


def similarity_summary(similarity: Similarity) -> Json:
    """Return groups, ratios and conflicts as plain values, the shape that ``scale --json`` prints."""
    return {
        "groups": [_group(group) for group in similarity.groups],
        "ratios": dict(similarity.ratios),
        "conflicts": [list(names) for names in similarity.conflicts],
        "rank": similarity.rank,
        "remarks": list(similarity.remarks),
    }


def _group(group: PiGroup) -> Json:
    return {
        "name": group.name,
        "exponents": {name: str(power) for name, power in group.exponents.items()},
        "model": group.model,
        "prototype": group.prototype,
        "ratio": group.ratio,
        "level": group.level,
        "meaning": group.meaning,
    }


def _provenance(report: Report) -> Json:
    provenance = report.provenance
    return {
        "software": dict(provenance.software),
        "files": [{"name": name, "sha256": digest} for name, digest in provenance.files],
        "settings": dict(provenance.settings),
        "conditioning": [
            {
                "channel": channel.name,
                "file": channel.source.file,
                "sha256": channel.source.sha256,
                "reader": channel.source.reader,
                "unit_as_written": channel.source.unit_as_written,
                "clock": channel.source.clock,
                "steps": list(channel.source.steps),
            }
            for channel in report.measured.channels
            if channel.source is not None
        ],
    }


def _finite(value: Any) -> Any:
    """Return the same value with every number that JSON cannot hold as None."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
