"""What each sensor's channel becomes once the clocks and the windows are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.flags.limits import sensor_of
from tethertest.conditioning.gratings.strain import (
    RECTANGLE,
    TEMPERATURE_CUTOFF,
    apparent_strain,
    strain_of,
    temperature_of,
)
from tethertest.conditioning.load_cells.tare import (
    DEFAULT_RATED,
    STRAIN_DRIFT,
    TENSION_DRIFT,
    Level,
    rest_level,
    zeroed,
)
from tethertest.conditioning.rest import RunWindows
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.conditioning.timestamps.mapping import is_grating
from tethertest.records.channel import Channel, Finding, Severity
from tethertest.records.rig import Rig, Sensor
from tethertest.signal.filters import filled, filled_reader, low_passed
from tethertest.signal.noise import white_noise_of

#: the base stands in the same place before and after when it differs by less than this [m]: only then does a
#: difference of tension at rest mean that a zero drifted
SAME_PLACE = 2e-3


def finished(
    channels: Sequence[Channel], rig: Rig, priors: RigPriors, windows: RunWindows
) -> tuple[tuple[Channel, ...], tuple[Finding, ...]]:
    """Return tared tensions and displacements, strains and temperatures.

    Parameters
    ----------
    channels : sequence of Channel
        Tension [N], displacement [m] and wavelengths [m] on the run's clock.
    rig : Rig
        Their sensors.
    priors : RigPriors
        Tensions at rest.
    windows : RunWindows
        The rest windows.
    """
    levels = {channel.name: _levels(channel, windows) for channel in channels}
    findings: list[Finding] = []
    if _moved(channels, levels):
        text = "the base stands elsewhere after the run: only the rest before it is used for zeros"
        findings.append(Finding("rest_after", "base_moved", text, Severity.NOTE))
        levels = {name: (before, None if before else after) for name, (before, after) in levels.items()}
    temperatures = {
        channel.name: _temperature(channel, sensor_of(rig, channel), levels[channel.name])
        for channel in channels
        if sensor_of(rig, channel).kind == "temperature"
    }
    result: list[Channel] = []
    for channel in channels:
        sensor = sensor_of(rig, channel)
        before, after = levels[channel.name]
        found: tuple[Finding, ...] = ()
        if channel.name in temperatures:
            changed = temperatures[channel.name]
        elif is_grating(sensor):
            changed, found = _strain(channel, sensor, rig, temperatures, windows, before or after)
        elif channel.kind == "tension":
            if channel.name not in priors.static_tension:
                text = "the tension at rest is not known: rest is set to zero"
                findings.append(Finding(channel.name, "no_static_tension", text))
            allowed = TENSION_DRIFT * (sensor.rated or DEFAULT_RATED)
            expected = priors.static_tension.get(channel.name, 0.0)
            changed, found = zeroed(channel, before, after, expected, allowed)
        else:
            changed, found = zeroed(channel, before, None if before else after, 0.0, np.inf)
        findings += found
        result.append(replace(changed, noise=_noise(changed)))
    return tuple(result), tuple(findings)


def _levels(channel: Channel, windows: RunWindows) -> tuple[Level | None, Level | None]:
    return rest_level(channel, windows.rest_before), rest_level(channel, windows.rest_after)


def _moved(channels: Sequence[Channel], levels: dict[str, tuple[Level | None, Level | None]]) -> bool:
    pairs = [levels[channel.name] for channel in channels if channel.kind == "displacement"]
    return any(before and after and abs(after.value - before.value) > SAME_PLACE for before, after in pairs)


def _temperature(channel: Channel, sensor: Sensor, levels: tuple[Level | None, Level | None]) -> Channel:
    level = levels[0] or levels[1]
    if not is_grating(sensor) or not channel.usable.any():
        return channel
    rest = level.value if level is not None else float(np.median(channel.values[channel.usable]))
    return temperature_of(channel, sensor, rest)


def _strain(
    channel: Channel,
    sensor: Sensor,
    rig: Rig,
    temperatures: dict[str, Channel],
    windows: RunWindows,
    level: Level | None,
) -> tuple[Channel, tuple[Finding, ...]]:
    temperature = _change(sensor, rig, temperatures, windows)
    found = () if temperature is not None else _uncompensated(sensor)
    if level is not None:
        rest = level.value
    else:
        rest = float(np.median(channel.values[channel.usable])) if channel.usable.any() else 1.0
    strain = strain_of(channel, sensor, rest, temperature, rig)
    before, after = _levels(strain, windows)
    tared, drifted = zeroed(strain, before, after, 0.0, STRAIN_DRIFT)
    return tared, (*found, *drifted)


def _change(
    sensor: Sensor, rig: Rig, temperatures: dict[str, Channel], windows: RunWindows
) -> Channel | None:
    """Return the temperature change since rest [K] that compensates a grating; None where there is none."""
    temperature = temperatures.get(sensor.compensation or "")
    if temperature is None or temperature.unit != "K" or not temperature.usable.any():
        return None
    if is_grating(sensor_of(rig, temperature)):
        return temperature
    before, after = _levels(temperature, windows)
    level = before or after
    rest = level.value if level else float(np.median(temperature.values[temperature.usable]))
    smooth = low_passed(filled(temperature), temperature.rate, TEMPERATURE_CUTOFF)
    return temperature.with_values(smooth - rest)


def _uncompensated(sensor: Sensor) -> tuple[Finding, ...]:
    """Say what an uncompensated grating is worth: a note where the rig states how far temperature may go."""
    why = (
        f"no temperature from {sensor.compensation!r}"
        if sensor.compensation
        else "no compensation in the rig file"
    )
    if sensor.temperature_change is not None:
        open_ = 1e6 * abs(apparent_strain(sensor, sensor.temperature_change)) * RECTANGLE
        text = (
            f"{why}: the strain is uncertain by {open_:.3g} microstrain (standard) for the stated "
            f"+/-{sensor.temperature_change:g} K"
        )
        return (Finding(sensor.name, "not_compensated", text, Severity.NOTE),)
    text = (
        f"{why}: strain is not compensated, a kelvin reads as "
        f"{1e6 * apparent_strain(sensor, 1.0):.3g} microstrain; state temperature_change in the rig file"
    )
    return (Finding(sensor.name, "not_compensated", text),)


def _noise(channel: Channel) -> float:
    """Return the standard deviation of one sample; none for a temperature, which is smoothed."""
    if channel.kind == "temperature" or not channel.usable.any():
        return 0.0
    return white_noise_of(filled_reader(channel), channel.time.size)
