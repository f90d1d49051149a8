"""The order of conditioning: as logged -> calibrated -> flagged -> one clock -> tared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.clocks.fitted import fitted_clock, identity
from tethertest.conditioning.clocks.shared_clocks import shared_clock_findings
from tethertest.conditioning.cross_check import cross_findings, gains
from tethertest.conditioning.flags.hum import with_hum_flagged
from tethertest.conditioning.flags.limits import flag_findings, sensor_of, with_excludes, with_range_flagged
from tethertest.conditioning.flags.negative_tension import negative_tension_findings
from tethertest.conditioning.flags.plausible import check_alive, check_range, check_rate, hole_findings
from tethertest.conditioning.flags.spikes import with_spikes_flagged
from tethertest.conditioning.flags.steps import with_steps_flagged
from tethertest.conditioning.flags.stuck_saturated import with_plateaus_flagged
from tethertest.conditioning.inertia import cable_inertia
from tethertest.conditioning.load_cells.calibration import calibrated
from tethertest.conditioning.rest import RunWindows, windows_of
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.conditioning.sensors import finished
from tethertest.conditioning.timestamps.logged import LoggedChannels, as_logged
from tethertest.errors import DataError
from tethertest.records.channel import Channel, ClockFit, ConditionedRun, Finding, RawLog, Severity
from tethertest.records.rig import Rig, sensor_noise
from tethertest.records.run import Log, Run
from tethertest.signal.passes import BLOCK

#: hum is judged against the tension noise that the rig states; a cell without a statement has this much [N]
DEFAULT_NOISE = 0.015
NOTHING: tuple[Finding, ...] = ()
#: kinds whose range means the tared value
RANGED = ("tension", "displacement")
#: logs must share at least this much time by their own stamps [s]
SHORTEST_OVERLAP = 1.0


def condition(run: Run, logs: Mapping[str, RawLog], priors: RigPriors) -> ConditionedRun:
    """Turn the logs of a run into calibrated, tared, flagged channels on one clock.

    Parameters
    ----------
    run : Run
        The run and its rig.
    logs : mapping of str to RawLog
        The logs as read, by their `Log.key` in run.toml.
    priors : RigPriors
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
    channels, clocks, findings = _on_one_clock(run, logs, priors)
    windows = windows_of(run, channels, priors.drive_frequency, priors.motion_reach)
    findings += windows.findings
    channels, found = finished(with_steps_flagged(channels), run.rig, priors, windows)
    findings += (*found, *negative_tension_findings(channels, run.rig))
    channels, found = _within_limits(channels, run.rig, priors, windows)
    findings += found
    channels, found = with_excludes(channels, run)
    findings += found
    frequency = priors.drive_frequency or run.file.drive.frequency
    findings += hole_findings(channels, windows.steady, frequency)
    order = {sensor.name: number for number, sensor in enumerate(run.rig.sensor)}
    channels = tuple(sorted(channels, key=lambda channel: order[channel.name]))
    findings += [finding for channel in channels for finding in flag_findings(channel)]
    findings += _cross_checked(run, channels, priors, windows, findings)
    return ConditionedRun(
        channels, clocks, tuple(findings), windows.rest_before, windows.rest_after, windows.steady
    )


def _on_one_clock(
    run: Run, logs: Mapping[str, RawLog], priors: RigPriors
) -> tuple[tuple[Channel, ...], tuple[ClockFit, ...], list[Finding]]:
    """Return the channels of all logs on the reference clock, the fits of the clocks, and findings."""
    opened = [_opened(run, entry, logs[entry.key]) for entry in run.file.log]
    _check_logged(run, opened)
    priors = _with_reference(run, priors, opened)
    by_clock: dict[str, list[Channel]] = {item.clock: [] for item in opened}
    for item in opened:
        by_clock[item.clock] += item.channels
    for channel in (channel for channels in by_clock.values() for channel in channels):
        check_range(_believed(run, channel, priors), run.rig)
    fits: list[ClockFit] = []
    findings: list[Finding] = []
    for clock in by_clock:
        fit, problems = _fitted(run, clock, by_clock, priors)
        fits.append(fit)
        logged = [item for log in opened if log.clock == clock for item in log.findings]
        findings += [*(mapped_finding(item, fit) for item in logged), *problems]
    on_reference = tuple(mapped(channel, fit) for fit in fits for channel in by_clock[fit.clock])
    return on_reference, tuple(fits), findings


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


def _check_logged(run: Run, opened: Sequence[LoggedChannels]) -> None:
    """Refuse logs that no run can have written."""
    for channel in (channel for item in opened for channel in item.channels):
        check_rate(channel, run.rig)
        check_alive(channel)
    _check_sensors_once(opened)
    _check_overlap(opened)


def _with_reference(run: Run, priors: RigPriors, opened: Sequence[LoggedChannels]) -> RigPriors:
    """Return the priors with a reference clock that the run has."""
    clocks = [item.clock for item in opened]
    if priors.reference_clock not in clocks:
        priors = replace(priors, reference_clock=clocks[0])
    if priors.reference_clock in run.file.override.clock_offset:
        message = (
            f"[override.clock_offset] moves {priors.reference_clock!r}, to which the other clocks are fitted"
        )
        remedy = "give the offsets of the other clocks against it"
        raise DataError(message, remedy, path=run.folder / "run.toml")
    return priors


def _fitted(
    run: Run, clock: str, by_clock: Mapping[str, Sequence[Channel]], priors: RigPriors
) -> tuple[ClockFit, tuple[Finding, ...]]:
    """Return the fit of one clock, and what is wrong with it or with the files that share it."""
    is_reference = clock == priors.reference_clock
    if is_reference and len({channel.source.file for channel in by_clock[clock] if channel.source}) < 2:
        return identity(clock), NOTHING
    reference = [_believed(run, channel, priors) for channel in by_clock[priors.reference_clock]]
    if is_reference:
        channels, fit, problems = reference, identity(clock), NOTHING
    else:
        channels = [_believed(run, channel, priors) for channel in by_clock[clock]]
        fit, problems = fitted_clock(clock, channels, reference, run, priors)
    if any(item.severity == Severity.FATAL for item in problems):
        return fit, problems
    return fit, (*problems, *shared_clock_findings(fit, channels, reference, run, priors))


def _within_limits(
    channels: Sequence[Channel], rig: Rig, priors: RigPriors, windows: RunWindows
) -> tuple[tuple[Channel, ...], tuple[Finding, ...]]:
    """Return the channels with their ranges and hum flagged."""
    at_rest = [item for item in (windows.rest_before, windows.rest_after) if item is not None]
    result: list[Channel] = []
    findings: list[Finding] = []
    for channel in channels:
        sensor = sensor_of(rig, channel)
        flagged = with_range_flagged(channel, sensor)
        if flagged.kind == "tension":
            noise = sensor_noise(sensor) or DEFAULT_NOISE
            flagged, found = with_hum_flagged(flagged, priors.mains, noise, at_rest)
            findings += found
        result.append(flagged)
    return tuple(result), tuple(findings)


def _cross_checked(
    run: Run,
    channels: Sequence[Channel],
    priors: RigPriors,
    windows: RunWindows,
    findings: Sequence[Finding],
) -> tuple[Finding, ...]:
    """Return what gratings and load cells say of each other in the steady window."""
    if windows.steady is None:
        return ()
    adrift = {item.subject for item in findings if item.kind == "clock_not_aligned"}
    inertia = cable_inertia(run, channels, windows.steady, priors)
    compared = gains(channels, run.rig, windows.steady, priors.static_tension, inertia, adrift)
    return cross_findings(compared, run.rig, inertia.doubt)


def _believed(run: Run, channel: Channel, priors: RigPriors) -> Channel:
    """Return the channel with what is far beyond its range flagged, before its zero is known."""
    if channel.kind not in RANGED or not channel.usable[:: channel.time.size // BLOCK + 1].any():
        return channel
    every = slice(None, None, channel.time.size // BLOCK + 1)
    middle = float(np.median(channel.values[every][channel.usable[every]]))
    middle -= priors.static_tension.get(channel.name, 0.0)
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
