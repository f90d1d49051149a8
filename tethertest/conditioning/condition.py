"""The order of conditioning: as logged -> calibrated -> flagged -> one clock -> tared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.clocks import fitted_clock, identity
from tethertest.conditioning.cross_check import cross_findings, gains
from tethertest.conditioning.flags import flag_findings, sensor_of, with_excludes, with_range_flagged
from tethertest.conditioning.guide import Guide
from tethertest.conditioning.hum import with_hum_flagged
from tethertest.conditioning.inertia import cable_inertia
from tethertest.conditioning.load_cells import calibrated
from tethertest.conditioning.logged import LoggedChannels, as_logged
from tethertest.conditioning.plateaus import with_plateaus_flagged
from tethertest.conditioning.plausible import check_alive, check_ranges, check_rate, hole_findings
from tethertest.conditioning.pushing import pushing_findings
from tethertest.conditioning.rest import windows_of
from tethertest.conditioning.sensors import finished
from tethertest.conditioning.shared_clocks import shared_clock_findings
from tethertest.conditioning.spikes import with_spikes_flagged
from tethertest.conditioning.steps import with_steps_flagged
from tethertest.errors import DataError
from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding, RawLog, Severity
from tethertest.records.rig import sensor_noise
from tethertest.records.run import Log, Run

#: hum is judged against the tension noise that the rig states; a cell without a statement has this much [N]
DEFAULT_NOISE = 0.015
NOTHING: tuple[Finding, ...] = ()
#: kinds whose range means the tared value
RANGED = ("tension", "displacement")
#: logs must share at least this much time by their own stamps [s]
SHORTEST_OVERLAP = 1.0


def condition(run: Run, logs: Mapping[str, RawLog], guide: Guide) -> ConditionedRun:
    """Turn the logs of a run into calibrated, tared, flagged channels on one clock.

    Parameters
    ----------
    run : Run
        The run and its rig.
    logs : mapping of str to RawLog
        The logs as read, by their `Log.key` in run.toml.
    guide : Guide
        What the rig's mechanics says beforehand.

    Returns
    -------
    ConditionedRun
        Channels in SI on the reference clock, in the order of the rig's sensors, each at its own sampling
        times with every step on record; fits of all clocks; findings; windows.

    Raises
    ------
    DataError
        Names, units, stamps, calibration or windows are wrong in a way that only a person can mend.
    """
    opened = [_opened(run, entry, logs[entry.key]) for entry in run.file.log]
    for channel in (channel for item in opened for channel in item.channels):
        check_rate(channel, run.rig)
        check_alive(channel)
    _check_sensors_once(opened)
    clocks = list(dict.fromkeys(item.clock for item in opened))
    if guide.reference_clock not in clocks:
        guide = replace(guide, reference_clock=clocks[0])
    _check_overlap(opened)
    if guide.reference_clock in run.file.override.clock_offset:
        message = (
            f"[override.clock_offset] moves {guide.reference_clock!r}, to which the other clocks are fitted"
        )
        raise DataError(
            message, "give the offsets of the other clocks against it", path=run.folder / "run.toml"
        )
    by_clock = {name: [c for item in opened if item.clock == name for c in item.channels] for name in clocks}
    believed = {name: [_believed(run, channel, guide) for channel in by_clock[name]] for name in clocks}
    check_ranges([channel for name in clocks for channel in believed[name]], run.rig)
    reference = believed[guide.reference_clock]
    fits: list[ClockFit] = []
    findings: list[Finding] = []
    channels: list[Channel] = []
    for name in clocks:
        if name == guide.reference_clock:
            fit, problems = identity(name), NOTHING
        else:
            fit, problems = fitted_clock(name, believed[name], reference, run, guide)
        fits.append(fit)
        findings += [
            mapped_finding(item, fit) for log in opened if log.clock == name for item in log.findings
        ]
        findings += problems
        if not any(item.severity == Severity.FATAL for item in problems):
            findings += shared_clock_findings(fit, believed[name], reference, run, guide)
        channels += [mapped(channel, fit) for channel in by_clock[name]]
    windows = windows_of(run, channels, guide.drive_frequency)
    done, found = finished(with_steps_flagged(channels), run.rig, guide, windows)
    findings += (*windows.findings, *found, *pushing_findings(done, run.rig))
    at_rest = [item for item in (windows.rest_before, windows.rest_after) if item is not None]
    result: list[Channel] = []
    for channel in done:
        sensor = sensor_of(run.rig, channel)
        flagged = with_range_flagged(channel, sensor)
        if flagged.kind == "tension":
            noise = sensor_noise(sensor) or DEFAULT_NOISE
            flagged, found = with_hum_flagged(flagged, guide.mains, noise, at_rest)
            findings += found
        result.append(flagged)
    excluded, found = with_excludes(result, run)
    findings += found
    findings += hole_findings(excluded, windows.steady, guide.drive_frequency or run.file.drive.frequency)
    order = {sensor.name: number for number, sensor in enumerate(run.rig.sensor)}
    ordered = sorted(excluded, key=lambda channel: order[channel.name])
    findings += [finding for channel in ordered for finding in flag_findings(channel)]
    if windows.steady is not None:
        frequency = guide.drive_frequency or run.file.drive.frequency
        adrift = {item.subject for item in findings if item.kind == "clock_not_aligned"}
        inertia = cable_inertia(run, ordered, windows.steady, frequency)
        compared = gains(ordered, run.rig, windows.steady, guide.static_tension, inertia, adrift)
        findings += cross_findings(compared, run.rig, inertia.doubt)
    return ConditionedRun(
        tuple(ordered), tuple(fits), tuple(findings), windows.rest_before, windows.rest_after, windows.steady
    )


def _opened(run: Run, entry: Log, log: RawLog) -> LoggedChannels:
    """Return one log's channels, load cells calibrated and bad samples flagged."""
    logged = as_logged(log, entry, run)
    channels: list[Channel] = []
    findings = list(logged.findings)
    for channel in logged.channels:
        flagged = with_plateaus_flagged(channel)
        sensor = sensor_of(run.rig, channel)
        if sensor.kind == "tension":
            flagged, found = calibrated(flagged, sensor, run.rig, run.file.date.date())
            findings += found
        channels.append(flagged)
    return LoggedChannels(logged.clock, with_spikes_flagged(channels), tuple(findings))


def _believed(run: Run, channel: Channel, guide: Guide) -> Channel:
    """Return the channel with what is far beyond its range flagged, before its zero is known."""
    if channel.kind not in RANGED or not channel.usable.any():
        return channel
    middle = float(np.median(channel.values[channel.usable])) - guide.static_tension.get(channel.name, 0.0)
    return with_range_flagged(channel.with_values(channel.values - middle), sensor_of(run.rig, channel))


def _check_sensors_once(opened: Sequence[LoggedChannels]) -> None:
    files: dict[str, str] = {}
    for channel in (channel for item in opened for channel in item.channels):
        file = channel.source.file if channel.source else ""
        if channel.name in files:
            message = f"sensor {channel.name!r} is in {files[channel.name]} and in {file}"
            raise DataError(message, "map one of them to another sensor in run.toml", path=file)
        files[channel.name] = file


def _check_overlap(opened: Sequence[LoggedChannels]) -> None:
    channels = [channel for item in opened for channel in item.channels]
    last = max(channels, key=lambda channel: float(channel.time[0]))
    first = min(channels, key=lambda channel: float(channel.time[-1]))
    shortest = min(channels, key=lambda channel: float(channel.time[-1] - channel.time[0]))
    length = float(shortest.time[-1] - shortest.time[0])
    if length < SHORTEST_OVERLAP:
        message = f"the log is {length:.3g} s long, expected a run"
        remedy = "export the whole log again, with its time in seconds"
        raise DataError(message, remedy, path=shortest.source.file if shortest.source else None)
    if float(first.time[-1] - last.time[0]) < SHORTEST_OVERLAP:
        message = (
            f"channels never overlap in time: {first.name!r} ends at {first.time[-1]:.3f} s, {last.name!r} "
            f"starts at {last.time[0]:.3f} s after the run's date"
        )
        remedy = "use logs of the same run, or correct date_order or time_zone of the log"
        raise DataError(message, remedy, path=last.source.file if last.source else None)


def mapped(channel: Channel, fit: ClockFit) -> Channel:
    """Return the channel on the reference clock."""
    if fit.clock == fit.reference:
        return channel.with_step(f"clock {fit.clock}: the run's clock")
    step = (
        f"clock {fit.clock} -> {fit.reference}: offset {fit.offset:+.6f} s (+/- {fit.offset_error:.1g}), "
        f"drift {1e6 * fit.drift:+.2f} ppm (+/- {1e6 * fit.drift_error:.1g})"
    )
    return channel.with_time(fit.to_reference(channel.time), step)


def mapped_finding(finding: Finding, fit: ClockFit) -> Finding:
    """Return a finding with its spans on the reference clock."""
    spans = tuple(
        (float(start), float(stop))
        for start, stop in (fit.to_reference(np.asarray(span, dtype=np.float64)) for span in finding.spans)
    )
    return replace(finding, spans=spans)
