"""Load cells: the logged ratio, voltage or count -> newton."""

from __future__ import annotations

import datetime as dt
from dataclasses import replace
from math import hypot

import numpy as np

from tethertest.conditioning.load_cells.calibration_curves import Curve, curve_of
from tethertest.errors import DataError
from tethertest.records.channel import Channel, Finding, Flag, Severity
from tethertest.records.rig import Rig, Sensor
from tethertest.units import Kind

#: units in which people know a load cell's output
_SHOWN = {"ratio": (1e3, "mV/V"), "voltage": (1e3, "mV"), "count": (1.0, "counts")}


def calibrated(
    channel: Channel, sensor: Sensor, rig: Rig, date: dt.date
) -> tuple[Channel, tuple[Finding, ...]]:
    """Return a load cell's tension, not tared yet.

    Parameters
    ----------
    channel : Channel
        Kind ``ratio``, ``voltage``, ``count`` or ``tension``.
    sensor : Sensor
        The load cell: rated load and its output there, or its calibration.
    rig : Rig
        For one count of the instrument, the pairs of the calibration and uncertainties.
    date : date
        Day of the run; a calibration that was due before it is noted.

    Returns
    -------
    tuple
        The channel in newton with the step on record; `Channel.uncertainty` is that of its scale,
        `Channel.offset_uncertainty` the scatter and hysteresis of its calibration. Outputs beyond the
        calibrated span carry `Flag.OUT_OF_RANGE`.

    Raises
    ------
    DataError
        A log in volts, ratios or counts whose way to newton is not known, or a calibration that is none.
    """
    findings: tuple[Finding, ...] = ()
    if sensor.due is not None and sensor.due < date:
        text = f"calibration was due on {sensor.due.isoformat()}"
        findings = (Finding(sensor.name, "calibration_due", text, Severity.NOTE),)
    if sensor.calibration is not None and sensor.name in rig.calibrations:
        changed, found = _by_curve(channel, sensor, rig)
    else:
        changed, found = _by_sensitivity(channel, sensor, rig), ()
    return changed, (*findings, *found)


def _by_sensitivity(channel: Channel, sensor: Sensor, rig: Rig) -> Channel:
    relative = _relative(rig, sensor, "sensitivity", sensor.sensitivity)
    if channel.kind == "tension":
        return replace(channel, uncertainty=relative)
    if sensor.sensitivity is None or sensor.rated is None:
        raise _unknown(channel, sensor)
    to_ratio, converted, words = _conversion(channel, "ratio", sensor, rig)
    relative = hypot(relative, converted)
    factor = to_ratio * sensor.rated / sensor.sensitivity
    words += f"{sensor.rated:g} N at {1e3 * sensor.sensitivity:.7g} mV/V"
    step = f"load cell: {words} (relative uncertainty {relative:.2g})"
    changed = channel.with_values(factor * channel.values, step, unit="N")
    return replace(changed, kind=Kind.TENSION, uncertainty=relative)


def _by_curve(channel: Channel, sensor: Sensor, rig: Rig) -> tuple[Channel, tuple[Finding, ...]]:
    where = channel.source.file if channel.source else None
    data = rig.calibrations[sensor.name]
    try:
        curve = curve_of(data, sensor.calibration) if sensor.calibration else None
    except DataError as error:
        message = f"{sensor.name!r}: {error.problem}"
        raise DataError(message, error.remedy, path=where) from None
    if curve is None:
        raise _unknown(channel, sensor)
    findings = tuple(Finding(sensor.name, *problem) for problem in curve.problems)
    if channel.kind == "tension":
        text = f"the log has {channel.unit}: the logger's own calibration is kept, not {data.source}"
        finding = Finding(sensor.name, "calibration_by_logger", text, Severity.NOTE)
        changed = channel.with_step(f"load cell: {text}; its uncertainty is taken over")
        return _with_uncertainty(changed, curve, curve.relative), (*findings, finding)
    factor, converted, words = _conversion(channel, curve.kind, sensor, rig)
    output = factor * channel.values
    relative = hypot(curve.relative, converted)
    scale, unit = _SHOWN[curve.kind]
    low, high = scale * (curve.middle - curve.half), scale * (curve.middle + curve.half)
    step = (
        f"load cell: {words}{data.source}: {curve.words}; calibrated from {low:.6g} to {high:.6g} {unit}, "
        f"relative uncertainty of the scale {relative:.2g}, of a reading {curve.offset_uncertainty:.2g} N"
    )
    changed = replace(channel.with_values(curve.force(output), step, unit="N"), kind=Kind.TENSION)
    beyond = np.isfinite(output) & curve.beyond(output)
    if beyond.any():
        text = (
            f"{np.count_nonzero(beyond)} samples lie outside the calibrated {low:.6g} to {high:.6g} {unit} "
            "and are left out"
        )
        findings = (*findings, Finding(sensor.name, "not_calibrated", text))
    changed = changed.with_flags(beyond, Flag.OUT_OF_RANGE)
    return _with_uncertainty(changed, curve, relative), findings


def _with_uncertainty(channel: Channel, curve: Curve, relative: float) -> Channel:
    return replace(channel, uncertainty=relative, offset_uncertainty=curve.offset_uncertainty)


def _conversion(channel: Channel, wanted: str, sensor: Sensor, rig: Rig) -> tuple[float, float, str]:
    """Return factor, relative uncertainty and words of logged output -> output of the calibration."""
    kind = channel.kind
    if kind == wanted:
        return 1.0, 0.0, ""
    where = channel.source.file if channel.source else None
    excited = _relative(rig, sensor, "excitation", sensor.excitation)
    if {kind, wanted} == {"voltage", "ratio"}:
        if sensor.excitation is None:
            message = f"channel of {sensor.name!r} is logged as a {kind}, its calibration as a {wanted}"
            raise DataError(message, f"give {sensor.name!r} its excitation in the rig", path=where)
        volts = sensor.excitation
        words = f"excitation {volts:g} V (relative uncertainty {excited:.2g}), "
        return (1.0 / volts if kind == "voltage" else volts), excited, words
    if kind == "count" and wanted == "ratio":
        clock = channel.source.clock if channel.source else ""
        count = next((item.count for item in rig.instrument if item.name == clock), None)
        if count is None:
            message = (
                f"channel of {sensor.name!r} is logged in counts, and one count of {clock!r} is not known"
            )
            raise DataError(message, f"give instrument {clock!r} its count in the rig", path=where)
        relative = rig.uncertainty.get(f"instrument.{clock}.count", 0.0) / count
        return count, relative, f"one count {1e3 * count:.7g} mV/V, "
    message = f"channel of {sensor.name!r} is logged as a {kind}, and its calibration is for a {wanted}"
    raise DataError(message, "log what was calibrated, or correct the unit under its [[log]]", path=where)


def _relative(rig: Rig, sensor: Sensor, key: str, value: float | None) -> float:
    return rig.uncertainty.get(f"sensor.{sensor.name}.{key}", 0.0) / value if value else 0.0


def _unknown(channel: Channel, sensor: Sensor) -> DataError:
    message = f"channel of {sensor.name!r} is logged as a {channel.kind}, and its calibration is not known"
    where = channel.source.file if channel.source else None
    return DataError(message, f"give {sensor.name!r} its sensitivity and rated load in the rig", path=where)
