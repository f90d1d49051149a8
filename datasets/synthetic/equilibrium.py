"""Rest state of the chain of lumped masses that MoorDyn integrates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .rig import GRAVITY, Rig


def segment_pulls(rig: Rig, cells: int) -> NDArray[np.float64]:
    """Vertical pull in each segment at rest, from the bottom up, in N."""
    spacing = rig.length / cells
    above = rig.length - (np.arange(cells) + 0.5) * spacing
    return rig.static_tension - rig.mass_per_length * GRAVITY * above


def rest_shape(rig: Rig, cells: int, offset: float) -> tuple[NDArray[np.float64], float]:
    """Return node positions (x, z) at rest and the sideways pull.

    Parameters
    ----------
    rig : Rig
        The rig; its static tension is the vertical pull on the top end.
    cells : int
        Number of segments.
    offset : float
        How far the top stands to the side of the bottom, in m.
    """
    spacing = rig.length / cells
    vertical = segment_pulls(rig, cells)

    def shape(sideways: float) -> NDArray[np.float64]:
        tension = np.hypot(sideways, vertical)
        stretched = spacing * (1.0 + tension / rig.axial_stiffness)
        steps = np.column_stack((sideways / tension, vertical / tension)) * stretched[:, None]
        return np.vstack((np.zeros((1, 2)), np.cumsum(steps, axis=0)))

    if offset == 0.0:
        return shape(0.0), 0.0
    sideways = float(brentq(lambda pull: shape(pull)[-1, 0] - offset, -5.0, 5.0, xtol=1e-15, rtol=1e-14))
    return shape(sideways), sideways
