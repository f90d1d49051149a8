"""Wavelengths -> strain and temperature change since rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel
from tethertest.records.rig import Rig, Sensor
from tethertest.signal.filters import filled, low_passed
from tethertest.units import Kind

#: the temperature of cable and air changes slowly: what is faster in its grating is noise [Hz]
TEMPERATURE_CUTOFF = 0.05
#: standard deviation of a rectangle over its half-width (JCGM 100:2008, 4.3.7)
RECTANGLE = 1.0 / np.sqrt(3.0)


def temperature_of(channel: Channel, sensor: Sensor, rest: float) -> Channel:
    """Return the temperature change of an unstrained grating since rest [K].

    The root of ``ln(lambda/lambda0) = S1 dT + S2 dT^2`` that goes through zero; lambda0 is the wavelength at
    rest, and S1 holds there.

    Parameters
    ----------
    channel : Channel
        Wavelength [m].
    sensor : Sensor
        The grating, with its ``thermo_optic`` coefficient S1 [1/K] and, if known, S2 [1/K^2].
    rest : float
        Its wavelength at rest, lambda0 [m].

    Raises
    ------
    DataError
        The coefficient is not known.
    """
    if not sensor.thermo_optic:
        message = f"temperature grating {sensor.name!r} has no thermo_optic coefficient"
        raise DataError(message, f"give {sensor.name!r} its thermo_optic in the rig file")
    first, second = sensor.thermo_optic, sensor.thermo_optic_squared or 0.0
    ratio = np.log(channel.values / rest)
    # written so that S2 = 0 is no division by zero; where no root exists the value is missing
    with np.errstate(invalid="ignore"):
        change = 2.0 * ratio / (first + np.sign(first) * np.sqrt(first**2 + 4.0 * second * ratio))
    formula = f"dT = ln(lambda/{1e9 * rest:.8g} nm)/{first:g} K"
    if second:
        formula = f"ln(lambda/{1e9 * rest:.8g} nm) = {first:g} dT + {second:g} dT^2"
    step = f"{formula}, low-passed at {TEMPERATURE_CUTOFF:g} Hz"
    logarithm = channel.with_values(change)
    smooth = low_passed(filled(logarithm), channel.rate, TEMPERATURE_CUTOFF)
    values = np.where(channel.usable, smooth, np.nan)
    return replace(logarithm.with_values(values, step, unit="K"), kind=Kind.TEMPERATURE)


def strain_of(
    channel: Channel, sensor: Sensor, rest: float, temperature: Channel | None, rig: Rig
) -> Channel:
    """Return the mechanical strain since rest.

    ``ln(lambda/lambda0) = k (eps + alpha dT) + S1 dT + S2 dT^2``; in the linear form the left side is
    ``(lambda - lambda0)/lambda0``.

    Parameters
    ----------
    channel : Channel
        Wavelength [m].
    sensor : Sensor
        The grating: gauge factor k, thermo_optic S1 [1/K] and S2 [1/K^2], expansion alpha of the cable [1/K].
    rest : float
        Its wavelength at rest, lambda0 [m].
    temperature : Channel or None
        Temperature change since rest [K] on the same clock; None leaves the strain uncompensated, and the
        sensor's ``temperature_change`` becomes uncertainty.
    rig : Rig
        For the uncertainty of the constants.

    Returns
    -------
    Channel
        `Channel.uncertainty` is that of the gauge factor, `Channel.offset_uncertainty` what the temperature
        leaves open.

    Raises
    ------
    DataError
        The gauge factor is not known.
    """
    if sensor.gauge_factor is None:
        message = f"grating {sensor.name!r} has no gauge factor"
        raise DataError(message, f"give {sensor.name!r} its gauge_factor in the rig file")
    factor = sensor.gauge_factor
    relative = _uncertainty(rig, sensor, "gauge_factor") / factor
    if sensor.form == "linear":
        total = (channel.values - rest) / (rest * factor)
        step = f"eps = (lambda/{1e9 * rest:.8g} nm - 1)/{factor:g}"
    else:
        total = np.log(channel.values / rest) / factor
        step = f"eps = ln(lambda/{1e9 * rest:.8g} nm)/{factor:g}"
    step += f" (relative uncertainty {relative:.2g})"
    if temperature is not None:
        change = _at(temperature, channel.time)
        second = sensor.thermo_optic_squared or 0.0
        linear = (sensor.thermo_optic or 0.0) / factor + (sensor.expansion or 0.0)
        total = total - linear * change - second / factor * change**2
        unknown = _thermal_uncertainty(sensor, rig, temperature, float(np.max(np.abs(change))))
        step += (
            f" - ({sensor.thermo_optic or 0.0:g}/{factor:g} + {sensor.expansion or 0.0:g}) dT"
            f"{f' - {second:g}/{factor:g} dT^2' if second else ''} of {temperature.name}, "
            f"which leaves {1e6 * unknown:.2g} microstrain open"
        )
    else:
        reach = sensor.temperature_change or 0.0
        unknown = abs(apparent_strain(sensor, reach)) * RECTANGLE
        step += f"; not compensated, {1e6 * unknown:.2g} microstrain open for +/-{reach:g} K"
    strained = channel.with_values(total, step, unit="1")
    return replace(strained, kind=Kind.STRAIN, uncertainty=relative, offset_uncertainty=unknown)


def apparent_strain(sensor: Sensor, change: float) -> float:
    """Return the strain that an uncompensated grating shows for a temperature change [K]."""
    factor = sensor.gauge_factor or 1.0
    first, second = sensor.thermo_optic or 0.0, sensor.thermo_optic_squared or 0.0
    return (first / factor + (sensor.expansion or 0.0)) * change + second / factor * change**2


def _thermal_uncertainty(sensor: Sensor, rig: Rig, temperature: Channel, change: float) -> float:
    """Return the standard uncertainty of strain by its temperature term, at its largest."""
    factor, first = sensor.gauge_factor or 1.0, sensor.thermo_optic or 0.0
    measured = rig.sensor_named(temperature.name)
    own = 0.0
    if measured is not None and measured.thermo_optic:
        own = change * _uncertainty(rig, measured, "thermo_optic") / abs(measured.thermo_optic)
    parts = (
        change * _uncertainty(rig, sensor, "thermo_optic") / factor,
        change * _uncertainty(rig, sensor, "expansion"),
        change * first / factor**2 * _uncertainty(rig, sensor, "gauge_factor"),
        own * (first / factor + (sensor.expansion or 0.0)),
    )
    return float(np.linalg.norm(parts))


def _uncertainty(rig: Rig, sensor: Sensor, key: str) -> float:
    return rig.uncertainty.get(f"sensor.{sensor.name}.{key}", 0.0)


def _at(channel: Channel, times: FloatArray) -> FloatArray:
    """Return a slow channel at other times, straight across holes and level beyond its ends."""
    return np.interp(times, channel.time, filled(channel))
