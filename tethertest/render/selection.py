"""Which channels and which spans the page shows."""

from __future__ import annotations

from dataclasses import dataclass

from tethertest.records.channel import Channel, Window
from tethertest.records.report import Report
from tethertest.records.rig import Sensor

CYCLES_SHOWN = 5
SECONDS_SHOWN = 10.0  #: [s], where no drive frequency is known


@dataclass(frozen=True, slots=True)
class Pair:
    """One sensor's channel as measured and as replayed; either may be missing."""

    name: str
    kind: str
    at: float | None
    measured: Channel | None
    replayed: Channel | None


def tension_pairs(report: Report) -> tuple[Pair, ...]:
    """Return the rig's load cells, the top one first."""
    return _pairs(report, [sensor for sensor in report.run.rig.sensor if sensor.kind == "tension"])


def strain_pairs(report: Report) -> tuple[Pair, ...]:
    """Return the rig's strain gratings, the top one first."""
    return _pairs(report, [sensor for sensor in report.run.rig.sensor if sensor.kind == "wavelength"])


def _pairs(report: Report, sensors: list[Sensor]) -> tuple[Pair, ...]:
    sensors = sorted(sensors, key=lambda sensor: -1.0 if sensor.at is None else sensor.at, reverse=True)
    replayed = {channel.name: channel for channel in report.replayed}
    return tuple(
        Pair(
            sensor.name,
            sensor.kind,
            sensor.at,
            report.measured.channel(sensor.name),
            replayed.get(sensor.name),
        )
        for sensor in sensors
    )


def whole_window(report: Report) -> Window:
    """Return the span that any measured or replayed channel covers."""
    times = [channel.time for channel in (*report.measured.channels, *report.replayed) if channel.time.size]
    if not times:
        return Window(0.0, SECONDS_SHOWN, "nothing was recorded")
    return Window(
        float(min(time[0] for time in times)), float(max(time[-1] for time in times)), "the whole record"
    )


def analysed_window(report: Report) -> Window:
    """Return the steady window, or the whole record where none was found."""
    return report.measured.steady or whole_window(report)


def cycles_window(report: Report) -> Window:
    """Return a few cycles in the middle of the steady window."""
    window = analysed_window(report)
    frequency = drive_frequency(report)
    length = min(CYCLES_SHOWN / frequency if frequency else SECONDS_SHOWN, window.length)
    middle = 0.5 * (window.start + window.stop)
    return Window(middle - 0.5 * length, middle + 0.5 * length, f"{CYCLES_SHOWN} cycles")


def drive_frequency(report: Report) -> float | None:
    """Return the fitted drive frequency, or else the nominal one [Hz]."""
    return report.drive.frequency if report.drive else report.run.file.drive.frequency
