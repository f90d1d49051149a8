"""Peaks -> gratings, row by row, so that a lost peak blanks its own grating and moves no other."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from tethertest.conditioning.gratings.peak_assignment import NONE, Owners, assign_peaks
from tethertest.conditioning.timestamps.mapping import is_grating
from tethertest.records.channel import Channel, Finding, Flag, Severity
from tethertest.records.rig import Rig, Sensor

#: a grating without a capture range believes peaks this far from its expected wavelength [m]
DEFAULT_CAPTURE = 2e-9
#: a grating that is in fewer rows than this fraction of a log of numbered peaks is not in the log
HOME_FRACTION = 0.05
#: channel of the interrogator in the name of a numbered peak
_FIBRE = re.compile(r"^\s*CH\s*(\d+)\b", re.IGNORECASE)


def assigned(columns: Sequence[Channel], rig: Rig) -> tuple[tuple[Channel, ...], tuple[Finding, ...]]:
    """Give every peak of one interrogator log to its grating; see `assign_peaks` for how.

    Parameters
    ----------
    columns : sequence of Channel
        Wavelength columns of one log with the same times [m]; named after gratings of the rig, or after
        peaks when the logger numbers the peaks it sees.
    rig : Rig
        The rig; with named columns only the named gratings are looked for. Gratings whose sensors have a
        ``fibre`` are looked for among the peaks of that channel alone.

    Returns
    -------
    tuple
        One channel per grating: samples found in another column than its own carry `Flag.SLIPPED`, rows
        without a peak that is its own beyond doubt are NaN with `Flag.LOST`. A finding for each grating
        with peaks in doubt.
    """
    names = [channel.name for channel in columns]
    gratings = [sensor for sensor in rig.sensor if is_grating(sensor) and sensor.name in names]
    if not gratings:
        gratings = [sensor for sensor in rig.sensor if is_grating(sensor)]
    gratings = [sensor for sensor in gratings if sensor.expected is not None]
    result: dict[str, Channel] = {}
    findings: list[Finding] = []
    for group, sensors in _fibres(columns, gratings):
        sensors.sort(key=lambda sensor: sensor.expected or 0.0)
        peaks = np.column_stack([channel.values for channel in group])
        found = assign_peaks(
            peaks,
            group[0].time,
            np.array([sensor.expected for sensor in sensors], dtype=float),
            np.array([sensor.capture or DEFAULT_CAPTURE for sensor in sensors]),
            np.array([sensor.kind == "wavelength" for sensor in sensors]),
        )
        for number, sensor in enumerate(sensors):
            home = _home(sensor.name, group, found.column[:, number])
            if home is None:
                continue
            result[sensor.name] = _channel(group[home], sensor, peaks, found, number, home)
            findings += _doubts(group[home], sensor, found.doubtful[:, number])
    ordered = tuple(result[sensor.name] for sensor in gratings if sensor.name in result)
    return ordered, tuple(findings)


def _fibres(
    columns: Sequence[Channel], gratings: Sequence[Sensor]
) -> Iterator[tuple[list[Channel], list[Sensor]]]:
    """Yield columns and gratings that belong together; those without a stated fibre are one group."""
    by_name = {sensor.name: sensor.fibre for sensor in gratings}
    stated = {sensor.fibre for sensor in gratings} - {None}
    fibre: list[int | None] = []
    for channel in columns:
        match = _FIBRE.match(channel.name)
        number = by_name.get(channel.name, int(match[1]) if match else None)
        fibre.append(number if number in stated else None)
    for key in sorted(set(fibre), key=lambda item: -1 if item is None else item):
        group = [channel for channel, number in zip(columns, fibre, strict=True) if number == key]
        sensors = [sensor for sensor in gratings if sensor.fibre == key]
        if sensors:
            yield group, sensors


def _home(name: str, group: Sequence[Channel], column: np.ndarray) -> int | None:
    """Return a grating's own column: by name, else the usual one; None for a grating not in the log."""
    names = [channel.name for channel in group]
    if name in names:
        return names.index(name)
    seen = column != NONE
    if np.count_nonzero(seen) < HOME_FRACTION * seen.size:
        return None
    return int(np.argmax(np.bincount(column[seen])))


def _channel(
    template: Channel, sensor: Sensor, peaks: np.ndarray, found: Owners, number: int, home: int
) -> Channel:
    column = found.column[:, number]
    seen = column != NONE
    values = np.where(seen, peaks[np.arange(len(peaks)), np.maximum(column, 0)], np.nan)
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
    doubts = int(np.count_nonzero(found.doubtful[:, number]))
    return channel.with_step(
        f"peaks within {1e9 * capture:.4g} nm of {1e9 * expected:.7g} nm that keep to the pattern of all "
        f"gratings; {doubts} rows in doubt left empty"
    )


def _doubts(channel: Channel, sensor: Sensor, doubtful: np.ndarray) -> tuple[Finding, ...]:
    count = int(np.count_nonzero(doubtful))
    if not count:
        return ()
    times = channel.time[doubtful]
    text = (
        f"{count} rows, the first at {times[0]:.3f} s, have a peak that may be this grating's or another's: "
        "left empty; gratings farther apart or a lower capture would tell them apart"
    )
    span = ((float(times[0]), float(times[-1])),)
    return (Finding(sensor.name, "peaks_in_doubt", text, Severity.NOTE, span, count),)
