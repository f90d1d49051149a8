"""What is kept of a march: rows at the gauges, and the extremes of the tension along the cable."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from tethertest.kernels.cells import FloatArray
from tethertest.kernels.jit import compiled

IntArray: TypeAlias = npt.NDArray[np.int64]


class Record(NamedTuple):
    """What is kept of the march, filled in place."""

    interval: float  #: between output rows [s]; 0 for a row at every step
    bin_steps: int  #: steps per bin of the field
    gauge_index: IntArray  #: (g,) station below the gauge, of bottom end, cell centres, top end
    gauge_weight: FloatArray  #: (g,) weight of the station above
    node_index: IntArray  #: (g,) node below the gauge
    node_weight: FloatArray  #: (g,) weight of the node above
    #: (rows, g, m): tension [N], strain of the unstretched length and, where m > 2, position (d) [m],
    #: velocity (d) [m/s] and curvature [1/m]
    rows: FloatArray
    top: FloatArray  #: (rows,) height of the upper end [m]
    field_maximum: FloatArray  #: (bins, n + 2) [N]
    field_minimum: FloatArray  #: (bins, n + 2) [N]


@compiled
def widen(station: FloatArray, highest: FloatArray, lowest: FloatArray) -> None:
    """Widen the extremes by the stations' tension."""
    for i in range(station.size):
        highest[i] = max(highest[i], station[i])
        lowest[i] = min(lowest[i], station[i])


@compiled
def sample_tension(
    index: IntArray,
    weight: FloatArray,
    station: FloatArray,
    stretch: FloatArray,
    stiffness: float,
    now: FloatArray,
) -> None:
    """Fill the first two columns of ``now`` (g, m) with tension and strain at this time level.

    The cells know their stretch; at an end the strain follows the tension's slope over the last half cell.

    Parameters
    ----------
    index, weight : (g,) int64, (g,) float64
        Gauge index and weight of a `Record`.
    station : (n + 2,) float64
        Tension at bottom end, cell centres and top end [N].
    stretch : (n,) float64
        Stretch of the cells.
    stiffness : float
        EA [N].
    """
    n = stretch.size
    for g in range(index.size):
        j = index[g]
        upper = weight[g]
        now[g, 0] = (1.0 - upper) * station[j] + upper * station[j + 1]
        low, high = min(max(j - 1, 0), n - 1), min(j, n - 1)
        low_strain, high_strain = stretch[low] - 1.0, stretch[high] - 1.0
        if j == 0:
            low_strain += (station[0] - station[1]) / stiffness
        if j == n:
            high_strain += (station[n + 1] - station[n]) / stiffness
        now[g, 1] = max(0.0, (1.0 - upper) * low_strain + upper * high_strain)


@compiled
def sample_motion(
    places: tuple[IntArray, FloatArray],
    position: FloatArray,
    velocity: FloatArray,
    along: FloatArray,
    stretch: FloatArray,
    cell: float,
    now: FloatArray,
) -> None:
    """Fill the columns of ``now`` (g, 3 + 2 d) after the second with position, velocity and curvature.

    Parameters
    ----------
    places : tuple of (g,) arrays
        Node index and weight of a `Record`.
    position, velocity : (d, n + 1) float64
        Nodes at this time level [m], [m/s].
    along : (d, n) float64
        Unit vectors of the cells.
    stretch : (n,) float64
        Stretch of the cells.
    cell : float
        Unstretched cell length [m].
    """
    d = position.shape[0]
    index, weight = places
    for g in range(index.size):
        i, part = index[g], weight[g]
        for c in range(d):
            now[g, 2 + c] = (1.0 - part) * position[c, i] + part * position[c, i + 1]
            now[g, 2 + d + c] = (1.0 - part) * velocity[c, i] + part * velocity[c, i + 1]
        bend = bend_at(along, stretch, cell, i)
        now[g, 2 + 2 * d] = (1.0 - part) * bend + part * bend_at(along, stretch, cell, i + 1)


@compiled
def bend_at(along: FloatArray, stretch: FloatArray, cell: float, node: int) -> float:
    """Return the curvature [1/m] at a node; an end has that of its neighbour."""
    d, n = along.shape
    if n < 2:
        return 0.0
    i = min(max(node, 1), n - 1)
    turned = 0.0
    for c in range(d):
        turned += (along[c, i] - along[c, i - 1]) ** 2
    return float(np.sqrt(turned) / (0.5 * cell * max(stretch[i] + stretch[i - 1], 1e-12)))
