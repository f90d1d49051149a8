"""Peaks -> gratings, row by row, so that a lost peak blanks its own grating and moves no other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.mapping import is_grating
from tethertest.records.channel import Channel, Flag
from tethertest.records.rig import Rig, Sensor

#: a grating without a capture range believes peaks this far from its expected wavelength [m]
DEFAULT_CAPTURE = 2e-9
#: a column that holds a grating in fewer rows than this fraction is not its home
HOME_FRACTION = 0.05


def assigned(columns: Sequence[Channel], rig: Rig) -> tuple[Channel, ...]:
    """Give every peak of one interrogator log to the grating whose expected wavelength is nearest.

    Parameters
    ----------
    columns : sequence of Channel
        Wavelength columns of one log with the same times [m]; named after gratings of the rig, or after
        peaks when the logger numbers the peaks it sees.
    rig : Rig
        The rig; with named columns only the named gratings are looked for.

    Returns
    -------
    tuple of Channel
        One channel per grating: samples found in another column than its own carry `Flag.SLIPPED`, rows
        without a peak within the capture range are NaN with `Flag.LOST`.
    """
    names = [channel.name for channel in columns]
    gratings = [sensor for sensor in rig.sensor if is_grating(sensor) and sensor.name in names]
    if not gratings:
        gratings = [sensor for sensor in rig.sensor if is_grating(sensor)]
    gratings = [sensor for sensor in gratings if sensor.expected is not None]
    peaks = np.column_stack([channel.values for channel in columns])
    expected = np.array([sensor.expected for sensor in gratings], dtype=float)
    capture = np.array([sensor.capture or DEFAULT_CAPTURE for sensor in gratings])
    distance = np.abs(peaks[:, :, None] - expected)
    distance[~(distance <= capture)] = np.inf
    owner = np.argmin(distance, axis=2)
    result: list[Channel] = []
    for number, sensor in enumerate(gratings):
        own = np.where(owner == number, distance[:, :, number], np.inf)
        column = np.argmin(own, axis=1)
        seen = np.isfinite(np.min(own, axis=1))
        home = names.index(sensor.name) if sensor.name in names else _home(column, seen)
        if home is None:
            continue
        result.append(_channel(columns[home], sensor, peaks, column, seen, home))
    return tuple(result)


def _home(column: np.ndarray, seen: np.ndarray) -> int | None:
    """Return the column that holds a grating most often, None for a grating that the log does not hold."""
    if np.count_nonzero(seen) < HOME_FRACTION * seen.size:
        return None
    return int(np.argmax(np.bincount(column[seen])))


def _channel(
    template: Channel, sensor: Sensor, peaks: np.ndarray, column: np.ndarray, seen: np.ndarray, home: int
) -> Channel:
    values = np.where(seen, peaks[np.arange(len(peaks)), column], np.nan)
    flags = template.flags & ~np.uint16(Flag.MISSING)
    capture, expected = sensor.capture or DEFAULT_CAPTURE, sensor.expected or 0.0
    channel = replace(
        template,
        name=sensor.name,
        at=sensor.at,
        values=values,
        flags=flags.astype(np.uint16),
    )
    channel = channel.with_flags(~seen, Flag.LOST).with_flags(seen & (column != home), Flag.SLIPPED)
    return channel.with_step(f"peaks within {1e9 * capture:.4g} nm of {1e9 * expected:.7g} nm")
