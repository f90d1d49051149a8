"""One run of one model at one resolution, before its error is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as a_field

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field

#: rows of the tension field kept over a record, about
FIELD_BINS = 480


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What every fidelity returns for one resolution."""

    time: FloatArray  #: (n,) [s], output times or the scheme's own levels
    tension: FloatArray  #: (n, g) [N], total
    strain: FloatArray  #: (n, g), change from rest
    platform_position: FloatArray  #: (n,) [m], height of the upper end above its rest
    field: Field
    time_step: float  #: [s]
    steps_done: int  #: less than `steps` where the solution left the range of numbers
    steps: int
    #: "position", "velocity" (n, g, 3) along x, y, z and "curvature" (n, g), where the scene asks for them
    fields: dict[str, FloatArray] = a_field(default_factory=dict)


def widened(field: Field, time: FloatArray, gauges: FloatArray, tension: FloatArray) -> Field:
    """Return a field whose stations nearest to the gauges reach as far as the gauges do.

    Parameters
    ----------
    field : Field
    time : (n,) float64
        [s].
    gauges : (g,) float64
        Fractions of the length from the bottom.
    tension : (n, g) float64
        [N].
    """
    bins = np.clip(np.searchsorted(field.time, time, "right") - 1, 0, field.time.size - 1)
    maximum, minimum = field.maximum.copy(), field.minimum.copy()
    for g, gauge in enumerate(gauges):
        station = int(np.argmin(np.abs(field.position - gauge)))
        np.maximum.at(maximum[:, station], bins, tension[:, g])
        np.minimum.at(minimum[:, station], bins, tension[:, g])
    return Field(field.time, field.position, maximum, minimum)


def field_of_rows(time: FloatArray, position: FloatArray, tension: FloatArray) -> Field:
    """Return the extremes of a tension known at every row; neighbouring bins share their edge.

    Parameters
    ----------
    time : (n,) float64
        [s].
    position : (m,) float64
        Fractions of the length from the bottom.
    tension : (n, m) float64
        [N].
    """
    starts = np.arange(0, time.size, max(1, math.ceil(time.size / FIELD_BINS)))
    maximum = np.maximum.reduceat(tension, starts, axis=0)
    minimum = np.minimum.reduceat(tension, starts, axis=0)
    maximum[1:] = np.maximum(maximum[1:], tension[starts[1:] - 1])
    minimum[1:] = np.minimum(minimum[1:], tension[starts[1:] - 1])
    return Field(time[starts], position, maximum, minimum)


def beside(fields: Sequence[Field]) -> Field:
    """Return fields of the same times, each of some stations, as one."""
    return Field(
        fields[0].time,
        np.concatenate([field.position for field in fields]),
        np.concatenate([field.maximum for field in fields], axis=1),
        np.concatenate([field.minimum for field in fields], axis=1),
    )
