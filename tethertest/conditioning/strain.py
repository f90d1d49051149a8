"""Wavelengths -> strain and temperature change since rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel
from tethertest.records.rig import Rig, Sensor
from tethertest.signal.filters import filled, low_passed

#: the temperature of cable and air changes slowly: what is faster in its grating is noise [Hz]
TEMPERATURE_CUTOFF = 0.05


def temperature_of(channel: Channel, sensor: Sensor, rest: float) -> Channel:
    """Return the temperature change of an unstrained grating since rest, ``ln(lambda/lambda0)/S1`` [K].

    Parameters
    ----------
    channel : Channel
        Wavelength [m].
    sensor : Sensor
        The grating, with its ``thermo_optic`` coefficient S1 [1/K].
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
    formula = f"dT = ln(lambda/{1e9 * rest:.8g} nm)/{sensor.thermo_optic:g} K"
    step = f"{formula}, low-passed at {TEMPERATURE_CUTOFF:g} Hz"
    logarithm = channel.with_values(np.log(channel.values / rest) / sensor.thermo_optic)
    smooth = low_passed(filled(logarithm), channel.rate, TEMPERATURE_CUTOFF)
    values = np.where(channel.usable, smooth, np.nan)
    return replace(logarithm.with_values(values, step, unit="K"), kind="temperature")


def strain_of(
    channel: Channel, sensor: Sensor, rest: float, temperature: Channel | None, rig: Rig
) -> Channel:
    """Return the mechanical strain since rest: ``ln(lambda/lambda0) = k eps + S1 dT``, less expansion.

    Parameters
    ----------
    channel : Channel
        Wavelength [m].
    sensor : Sensor
        The grating: gauge factor k, thermo_optic S1 [1/K], expansion of the cable [1/K].
    rest : float
        Its wavelength at rest, lambda0 [m].
    temperature : Channel or None
        Temperature change since rest [K] on the same clock; None leaves the strain uncompensated.
    rig : Rig
        For the uncertainty of the gauge factor.

    Raises
    ------
    DataError
        The gauge factor is not known.
    """
    if sensor.gauge_factor is None:
        message = f"grating {sensor.name!r} has no gauge factor"
        raise DataError(message, f"give {sensor.name!r} its gauge_factor in the rig file")
    factor = sensor.gauge_factor
    relative = rig.uncertainty.get(f"sensor.{sensor.name}.gauge_factor", 0.0) / factor
    thermal = sensor.thermo_optic or 0.0
    expansion = sensor.expansion or 0.0
    total = np.log(channel.values / rest) / factor
    step = f"eps = ln(lambda/{1e9 * rest:.8g} nm)/{factor:g} (relative uncertainty {relative:.2g})"
    if temperature is not None:
        change = _at(temperature, channel.time)
        total = total - (thermal / factor + expansion) * change
        step += f" - ({thermal:g}/{factor:g} + {expansion:g}) dT of {temperature.name}"
    strained = channel.with_values(total, step, unit="1")
    return replace(strained, kind="strain", uncertainty=relative)


def _at(channel: Channel, times: FloatArray) -> FloatArray:
    """Return a slow channel at other times, straight across holes and level beyond its ends."""
    return np.interp(times, channel.time, filled(channel))
