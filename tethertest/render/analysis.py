"""An analysis as one JSON object: SI, snake case, no number made here."""

from __future__ import annotations

import math
from typing import Any

from tethertest.records.analysis import Analysis, ChannelAnalysis
from tethertest.records.events import CycleCount, Front, Snap, WaveSpeed
from tethertest.records.lines import Line
from tethertest.records.waves import OrderWaves, Waves

#: load cycles listed, the largest first; their number and equivalent range cover all
CYCLES_LISTED = 20


def analysis_summary(analysis: Analysis) -> dict[str, Any]:
    """Return the object of ``analyze --json``; what JSON has no number for is null."""
    drive, window, waves = analysis.drive, analysis.window, analysis.waves
    largest = waves.largest
    return {
        "path": analysis.path,
        "name": analysis.name,
        "drive": None
        if drive is None
        else {
            "frequency": drive.frequency,
            "standard_error": drive.standard_error,
            "channels": list(drive.channels),
        },
        "window": None if window is None else [window.start, window.stop],
        "window_reason": None if window is None else window.reason,
        "significance": analysis.significance,
        "mains": analysis.mains,
        "natural_frequencies": [
            {"name": natural.name, "frequency": natural.frequency} for natural in analysis.natural_frequencies
        ],
        "channels": [_channel(item) for item in analysis.channels],
        "waves": {
            "fronts": [_front(front) for front in waves.fronts],
            "speed": None if waves.speed is None else _speed(waves.speed),
            "parts": [_waves(part) for part in waves.parts],
            "largest_tension": None
            if largest is None
            else {
                "at": largest.at,
                "at_interval": list(largest.at_interval),
                "time": largest.time,
                "value": largest.value,
                "bottom": largest.bottom,
                "top": largest.top,
                "over_rest": {
                    "value": largest.over_rest,
                    "at": largest.over_rest_at,
                    "time": largest.over_rest_time,
                },
            },
            "remarks": list(waves.remarks),
        },
        "notes": list(analysis.notes),
    }


def _channel(item: ChannelAnalysis) -> dict[str, Any]:
    channel, ends = item.channel, item.extremes
    events: list[dict[str, Any]] = [
        {
            "kind": "slack",
            "start": event.start,
            "stop": event.stop,
            "lowest": event.value,
        }
        for event in item.events
        if event.kind == "slack"
    ]
    events += [_snap(snap) for snap in item.snaps]
    return {
        "name": channel.name,
        "side": item.side,
        "kind": channel.kind,
        "unit": channel.unit,
        "lines": [] if item.lines is None else [_line(line) for line in item.lines.lines],
        "no_lines": item.no_lines or None,
        "peaks": [
            {
                "frequency": peak.frequency,
                "amplitude": peak.amplitude,
                "p_value": peak.p_value,
                "significant": peak.significant,
            }
            for peak in item.peaks
        ],
        "events": sorted(events, key=lambda event: float(event["start"])),
        "no_events": item.no_events or None,
        "extremes": None
        if ends is None
        else {
            "maximum": ends.maximum,
            "maximum_time": ends.maximum_time,
            "minimum": ends.minimum,
            "minimum_time": ends.minimum_time,
        },
        "cycles": None if item.cycles is None else _cycles(item.cycles),
    }


def _line(line: Line) -> dict[str, Any]:
    return {
        "order": line.order,
        "frequency": line.frequency,
        "amplitude": line.amplitude,
        "phase": line.phase,
        "interval": list(line.interval),
        "standard_error": line.standard_error,
        "calibration_error": line.calibration_error,
        "p_value": line.p_value,
        "significant_above": line.significant_above,
        "verdict": line.verdict.value,
        "reason": line.reason,
    }


def _snap(snap: Snap) -> dict[str, Any]:
    return {
        "kind": "snap",
        "start": snap.start,
        "stop": snap.peak_time,
        "peak": snap.peak,
        "peak_interval": list(snap.peak_interval),
        "rise_time": snap.rise_time,
        "rise_resolved": snap.rise_resolved,
        "impulse": snap.impulse,
        "front": snap.front,
        "speed": snap.speed,
        "speed_interval": None if snap.speed_interval is None else list(snap.speed_interval),
        "arrived_speed": snap.arrived_speed,
    }


def _cycles(count: CycleCount) -> dict[str, Any]:
    return {
        "number": count.number,
        "smallest_range": count.smallest,
        "exponent": count.exponent,
        "equivalent_range": count.equivalent_range,
        "largest": [
            {"range": cycle.range, "mean": cycle.mean, "count": cycle.count}
            for cycle in count.cycles[:CYCLES_LISTED]
        ],
    }


def _front(front: Front) -> dict[str, Any]:
    return {
        "channel": front.channel,
        "at": front.at,
        "time": front.time,
        "interval": list(front.interval),
    }


def _speed(speed: WaveSpeed) -> dict[str, Any]:
    return {
        "kind": speed.kind,
        "speed": _finite(speed.speed),
        "interval": [_finite(end) for end in speed.interval],
        "implied": speed.implied,
        "value": _finite(speed.value),
        "value_interval": [_finite(end) for end in speed.value_interval],
    }


def _waves(waves: Waves) -> dict[str, Any]:
    return {
        "side": waves.source,
        "section": waves.section,
        "at": waves.at,
        "orders": [_order(order) for order in waves.orders],
    }


def _order(order: OrderWaves) -> dict[str, Any]:
    if order.refused:
        return {"order": order.order, "frequency": order.frequency, "refused": order.refused}
    return {
        "order": order.order,
        "frequency": order.frequency,
        "up": order.up,
        "up_interval": list(order.up_interval),
        "down": order.down,
        "down_interval": list(order.down_interval),
        "energy_ratio": order.energy_ratio,
        "energy_ratio_interval": list(order.energy_ratio_interval),
        "standing_wave_ratio": _finite(order.standing_wave_ratio),
        "standing": order.is_standing,
        "power": order.power,
        "power_interval": list(order.power_interval),
        "refused": None,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
