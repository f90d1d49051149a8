"""Names in a log -> sensors of the rig, and units as written -> SI."""

from __future__ import annotations

from dataclasses import dataclass

from tethertest.errors import DataError, QuantityError
from tethertest.records.channel import Finding, RawChannel, RawLog, Severity
from tethertest.records.rig import Rig, Sensor
from tethertest.records.run import Log
from tethertest.units import UnitScale, channel_scale

#: what a sensor's channel may be logged as, by the sensor's kind, tried in this order
LOGGED_KINDS = {
    "tension": ("tension", "ratio", "voltage", "count"),
    "wavelength": ("wavelength",),
    "displacement": ("displacement",),
}


@dataclass(frozen=True, slots=True)
class Pairing:
    """One column of a log with the sensor that wrote it."""

    raw: RawChannel
    sensor: Sensor | None  #: None for a peak that is yet to be given to a grating
    scale: UnitScale
    written: str  #: unit as used: the run file's where it names one


def is_grating(sensor: Sensor) -> bool:
    """Return whether the sensor is a fibre Bragg grating, strained or not."""
    return sensor.kind == "wavelength" or (sensor.kind == "temperature" and sensor.expected is not None)


def paired(raw: RawLog, entry: Log, rig: Rig) -> tuple[tuple[Pairing, ...], tuple[Finding, ...]]:
    """Give every column of a log its sensor and its unit.

    Parameters
    ----------
    raw : RawLog
        The log as read.
    entry : Log
        Its entry in the run file.
    rig : Rig
        The rig.

    Returns
    -------
    tuple
        The pairings, and notes about columns that no sensor claims. Columns of nanometres that name no
        sensor are peaks when no column of the log names a grating.

    Raises
    ------
    DataError
        A mapped name is not in the file, a sensor is not in the rig, a unit is unknown or belongs to
        another kind, or two columns claim one sensor.
    """
    names = [channel.name for channel in raw.channels]
    for name in entry.channels:
        if name not in names:
            message = (
                f"channel {name!r} of run.toml is not in the log, which has {', '.join(map(repr, names))}"
            )
            raise DataError(message, "correct [[log]] channels in run.toml", path=raw.path)
    pairings: list[Pairing] = []
    left_over: list[RawChannel] = []
    claimed: dict[str, str] = {}
    for channel in raw.channels:
        target = entry.channels.get(channel.name, channel.name)
        sensor = rig.sensor_named(target)
        if sensor is None:
            if channel.name in entry.channels:
                known = ", ".join(item.name for item in rig.sensor)
                message = f"channel {channel.name!r} is mapped to {target!r}, which is no sensor of the rig"
                raise DataError(message, f"name one of {known}, or add the sensor to the rig", path=raw.path)
            left_over.append(channel)
            continue
        if target in claimed:
            message = f"channels {claimed[target]!r} and {channel.name!r} both claim sensor {target!r}"
            raise DataError(message, "map one of them elsewhere in [[log]] channels", path=raw.path)
        claimed[target] = channel.name
        pairings.append(_pairing(channel, sensor, raw, entry))
    if not any(pairing.sensor and is_grating(pairing.sensor) for pairing in pairings):
        peaks = [channel for channel in left_over if _unit(channel, entry) == "nm"]
        pairings += [Pairing(peak, None, channel_scale("nm", "wavelength"), "nm") for peak in peaks]
        left_over = [channel for channel in left_over if channel not in peaks]
    if not pairings:
        message = f"no channel of the log belongs to a sensor; it has {', '.join(map(repr, names))}"
        raise DataError(message, "map them in [[log]] channels of run.toml", path=raw.path)
    return tuple(pairings), _ignored(left_over, raw)


def _unit(channel: RawChannel, entry: Log) -> str:
    return entry.units.get(channel.name, channel.unit).strip()


def _pairing(channel: RawChannel, sensor: Sensor, raw: RawLog, entry: Log) -> Pairing:
    written = _unit(channel, entry)
    if sensor.kind == "temperature":
        kinds: tuple[str, ...] = ("wavelength",) if sensor.expected is not None else ("temperature",)
    else:
        kinds = LOGGED_KINDS[sensor.kind]
    for kind in kinds:
        try:
            scale = channel_scale(written, kind)
        except QuantityError:
            continue
        if written:
            return Pairing(channel, sensor, scale, written)
    found = f"has the unit {written!r}" if written else "has no unit"
    expected = " or ".join(kinds)
    message = f"channel {channel.name!r} {found}; sensor {sensor.name!r} is logged as {expected}"
    remedy = f'correct the unit, e.g. units = {{ "{channel.name}" = "{_example(kinds)}" }} under its [[log]]'
    raise DataError(message, remedy, path=raw.path)


def _example(kinds: tuple[str, ...]) -> str:
    return {"tension": "mV/V", "wavelength": "nm", "temperature": "degC", "displacement": "mm"}[kinds[0]]


def _ignored(channels: list[RawChannel], raw: RawLog) -> tuple[Finding, ...]:
    if not channels:
        return ()
    names = ", ".join(channel.name for channel in channels)
    return (Finding(raw.path.name, "ignored", f"{names}: no sensor of the rig, not used", Severity.NOTE),)
