"""Load cells: the logged ratio or count -> newton."""

from __future__ import annotations

import datetime as dt
from dataclasses import replace

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Finding
from tethertest.records.rig import Rig, Sensor


def calibrated(
    channel: Channel, sensor: Sensor, rig: Rig, date: dt.date
) -> tuple[Channel, tuple[Finding, ...]]:
    """Return a load cell's tension, not tared yet.

    Parameters
    ----------
    channel : Channel
        Kind ``ratio``, ``count`` or ``tension``.
    sensor : Sensor
        The load cell: rated load and its output there.
    rig : Rig
        For one count of the instrument and the uncertainty of the sensitivity.
    date : date
        Day of the run; a calibration that was due before it is noted.

    Raises
    ------
    DataError
        A ratio without sensitivity and rated load, or counts of an instrument whose count is not known.
    """
    findings: tuple[Finding, ...] = ()
    if sensor.due is not None and sensor.due < date:
        text = f"calibration was due on {sensor.due.isoformat()}"
        findings = (Finding(sensor.name, "calibration_due", text, "note"),)
    key = f"sensor.{sensor.name}.sensitivity"
    relative = rig.uncertainty.get(key, 0.0) / sensor.sensitivity if sensor.sensitivity else 0.0
    channel = replace(channel, uncertainty=relative)
    if channel.kind == "tension":
        return channel, findings
    where = channel.source.file if channel.source else None
    if sensor.sensitivity is None or sensor.rated is None:
        message = (
            f"channel of {sensor.name!r} is logged as a {channel.kind}, and its calibration is not known"
        )
        raise DataError(
            message, f"give {sensor.name!r} its sensitivity and rated load in the rig", path=where
        )
    factor = sensor.rated / sensor.sensitivity
    words = f"{sensor.rated:g} N at {1e3 * sensor.sensitivity:.7g} mV/V (relative uncertainty {relative:.2g})"
    if channel.kind == "count":
        clock = channel.source.clock if channel.source else ""
        count = next((item.count for item in rig.instrument if item.name == clock), None)
        if count is None:
            message = (
                f"channel of {sensor.name!r} is logged in counts, and one count of {clock!r} is not known"
            )
            raise DataError(message, f"give instrument {clock!r} its count in the rig", path=where)
        factor *= count
        words = f"one count {1e3 * count:.7g} mV/V, {words}"
    changed = channel.with_values(factor * channel.values, f"load cell: {words}", unit="N")
    return replace(changed, kind="tension"), findings
