"""The units people read: microstrain for strain, millimetres for the crank, degrees Celsius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel
from tethertest.records.report import Report

ZERO_CELSIUS = 273.15  #: [K]


@dataclass(frozen=True, slots=True)
class Scale:
    """Linear map from SI to what is shown: ``shown = factor * si + offset``."""

    unit: str
    factor: float = 1.0
    offset: float = 0.0

    def values(self, si: FloatArray) -> FloatArray:
        """Return values as shown."""
        return np.asarray(si * self.factor + self.offset, dtype=np.float64)

    def difference(self, si: float) -> float:
        """Return a difference, an amplitude or an uncertainty as shown."""
        return si * self.factor


_SCALES = {
    "strain": Scale("µε", 1e6),
    "displacement": Scale("mm", 1e3),
    "wavelength": Scale("nm", 1e9),
    "temperature": Scale("°C", 1.0, -ZERO_CELSIUS),
}
_AXIS_NAMES = {
    "tension": "Tension",
    "strain": "Strain",
    "displacement": "Displacement",
    "wavelength": "Wavelength",
    "temperature": "Temperature",
    "other": "Value",
}


def scale_for(kind: str, unit: str) -> Scale:
    """Return how values of a kind of channel are shown."""
    return _SCALES.get(kind, Scale("" if unit == "1" else unit))


def channel_scale(report: Report, name: str, unit: str) -> Scale:
    """Return how values in `unit` of the channel of that name are shown; other units stay as they are."""
    channels = (*report.measured.channels, *report.replayed)
    kind = next(
        (channel.kind for channel in channels if channel.name == name and channel.unit == unit), "other"
    )
    return scale_for(kind, unit)


def axis_label(channel: Channel) -> str:
    """Return the label of a vertical axis with its unit."""
    unit = scale_for(channel.kind, channel.unit).unit
    name = _AXIS_NAMES.get(channel.kind, channel.kind.capitalize())
    return f"{name} [{unit}]" if unit else name
