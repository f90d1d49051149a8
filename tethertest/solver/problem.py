"""What is asked of a model, and what a model answers once its error is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.response import SnapPeak, Status
from tethertest.records.scene import MeasuredMotion, Scene, WindSeries
from tethertest.solver.motion import velocity
from tethertest.solver.norms import relative_difference
from tethertest.solver.solution import Solution

#: share of the largest velocity that may be there at the first instant of a motion that starts smoothly
_SUDDEN = 0.02
#: instants at which a motion is looked at
_INSTANTS = 1025


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A scene with its data, how well it is to be solved and how far the solver may go."""

    scene: Scene
    tolerance: float
    measured: MeasuredMotion | None = None
    wind: WindSeries | None = None
    cells: int | None = None  #: solve on this mesh alone
    finest: int = 1280  #: finest mesh that may be tried
    node_steps: float = 4e9  #: most cells x steps of one march
    native_times: bool = False
    with_field: bool = True  #: follow the tension between the gauges, where that takes time
    rest: FloatArray | None = None  #: (g,) tension at rest [N], where the first row is not at rest

    def apart(self, tension: FloatArray, reference: FloatArray) -> float:
        """Return how far two tensions (n, g) [N] lie apart, relative to the dynamic part."""
        return relative_difference(tension, reference, self.rest)

    @property
    def sudden(self) -> bool:
        """Whether the bottom starts with a velocity."""
        times = np.linspace(0.0, self.scene.output.duration, _INSTANTS)
        speed = np.abs(velocity(self.scene.bottom, times, self.measured))
        return bool(speed[0] > _SUDDEN * float(np.max(speed)))


@dataclass(frozen=True, slots=True, eq=False)
class Refined:
    """A solution with the numerical error that refinement showed."""

    solution: Solution
    fidelity: str
    scheme: str
    cells: int
    error: float  #: NaN where one mesh alone was asked for
    status: Status
    snap: SnapPeak | None = None  #: where the cable goes slack

    @property
    def good(self) -> bool:
        """Whether the error is within the tolerance."""
        return self.status is Status.OK


#: one run of a model on a mesh of so many cells
Run = Callable[[int], Solution]
