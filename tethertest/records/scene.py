"""Everything the solver needs, and nothing it does not: the types of a scene file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.checked import check_types
from tethertest.records.quantity import SI

if TYPE_CHECKING:
    import pandas as pd

Length = Annotated[float, SI("m")]
Damping = Annotated[float, SI("N s/m", minimum=0.0)]
Stiffness = Annotated[float, SI("N/m", minimum=0.0)]
Area = Annotated[float, SI("m^2", minimum=0.0)]
FieldName = Literal["position", "velocity", "curvature"]


@dataclass(frozen=True, slots=True)
class Geometry:
    """How the cable lies at rest."""

    kind: Literal["shallow", "straight", "vertical", "ends", "hovering"]
    tension: Annotated[float, SI("N", above=0.0)] | None = None
    top: tuple[Length, ...] | None = None

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Bottom:
    """Motion of the bottom end."""

    motion: Literal["harmonic", "crank-slider", "measured", "step", "fixed"]
    direction: Literal["tangent", "vertical", "horizontal"] | tuple[float, ...] = "tangent"
    amplitude: Annotated[float, SI("m", minimum=0.0)] | None = None
    frequency: Annotated[float, SI("Hz", above=0.0)] | None = None
    radius: Annotated[float, SI("m", minimum=0.0)] | None = None
    rod_ratio: Annotated[float, SI("1", minimum=0.0, maximum=0.99)] | None = None
    velocity: Annotated[float, SI("m/s")] | None = None
    start: Literal["jump", "ramp"] = "jump"
    ramp: Annotated[float, SI("s", above=0.0)] | None = None
    file: str | None = None
    time_column: str | None = None
    displacement_column: str | None = None
    unit: str | None = None

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Top:
    """The upper end: fixed, or a platform under lift with a position loop."""

    kind: Literal["fixed", "platform"]
    mass: Annotated[float, SI("kg", minimum=0.0)] | None = None
    static_tension: Annotated[float, SI("N", above=0.0)] | None = None
    lift: Annotated[float, SI("N")] | tuple[Annotated[float, SI("N")], ...] | None = None
    hover_stiffness: Stiffness | tuple[Stiffness, ...] = 0.0
    hover_damping: Damping | tuple[Damping, ...] = 0.0
    drag_area: tuple[Area, Area] | None = None
    tilt: Annotated[float, SI("rad")] = 0.0

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Output:
    """What is wanted, where and how often."""

    duration: Annotated[float, SI("s", above=0.0)]
    rate: Annotated[float, SI("Hz", above=0.0)]
    gauges: tuple[Annotated[float, SI("1", minimum=0.0, maximum=1.0)], ...]
    fields: tuple[FieldName, ...] = ()

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Relative error wanted in the gauges' tension (RMS over the record, of the dynamic part)."""

    tolerance: Annotated[float, SI("1", above=0.0, maximum=1.0)] = 0.01

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredMotion:
    """Bottom displacement as data; the solver makes the velocity that is consistent with it."""

    time: FloatArray  #: (n,) [s], strictly increasing
    displacement: FloatArray  #: (n,) [m] along the direction of the motion, from rest

    @classmethod
    def of_series(cls, series: pd.Series[float]) -> MeasuredMotion:
        """Return the motion that a pandas Series holds; time and displacement count from its first row.

        Parameters
        ----------
        series : pandas.Series
            Displacement [m] over an index of seconds, durations or dates.

        Raises
        ------
        DataError
            The index is no time, or the values are no numbers.
        """
        index = series.index
        if index.dtype.kind in "mM":
            time = (index - index[0]) / np.timedelta64(1, "s")
        elif index.dtype.kind in "iuf" and series.dtype.kind in "iuf":
            time = index - index[0]
        else:
            message = f"found a series of {series.dtype} over {index.dtype}, expected metres over seconds"
            raise DataError(message, "give displacements in m as numbers, over seconds, durations or dates")
        values = series.to_numpy(dtype=np.float64)
        return cls(np.asarray(time, dtype=np.float64), values - values[0])


@dataclass(frozen=True, slots=True, eq=False)
class WindSeries:
    """Wind as data, the same all along the cable."""

    time: FloatArray  #: (n,) [s], strictly increasing
    velocity: FloatArray  #: (n, 3) [m/s] along x, y, z


@dataclass(frozen=True, slots=True)
class Scene:
    """One problem for the solver."""

    name: str
    cable: Cable
    geometry: Geometry
    bottom: Bottom
    top: Top
    output: Output
    air: Air | None = None
    accuracy: Accuracy = Accuracy()
    gravity: Annotated[float, SI("m/s^2", minimum=0.0)] = 9.80665

    def __post_init__(self) -> None:
        check_types(self)
