"""One run of one model at one resolution, before its error is known."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as a_field

from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field


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
