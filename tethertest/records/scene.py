"""Everything the solver needs, and nothing it does not: the types of a scene file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Area, Cable
from tethertest.records.checked import check_types
from tethertest.records.described import Doc
from tethertest.records.quantity import SI
from tethertest.records.rig import ROD_RATIO

if TYPE_CHECKING:
    import pandas as pd

_SHAPES = (
    "shallow: a chord with little sag; straight: no sag; vertical: upright; ends: hanging between two ends; "
    "hovering: as lift, weight and wind leave it"
)
_TENSION = (
    "at rest: along the chord of a shallow cable, all along a straight one, at the bottom of an upright one"
)
_MOTIONS = (
    "harmonic: amplitude and frequency; crank-slider: radius, rod_ratio and frequency; measured: a file; "
    "step: a velocity from the start on; fixed: none"
)
Length = Annotated[float, SI("m")]
Force = Annotated[float, SI("N")]
Damping = Annotated[float, SI("N s/m", minimum=0.0)]
Stiffness = Annotated[float, SI("N/m", minimum=0.0)]
FieldName = Literal["position", "velocity", "curvature"]


@dataclass(frozen=True, slots=True)
class Geometry:
    """How the cable lies at rest."""

    kind: Annotated[Literal["shallow", "straight", "vertical", "ends", "hovering"], Doc(_SHAPES)]
    tension: Annotated[float, SI("N", _TENSION, above=0.0)] | None = None
    top: Annotated[tuple[Length, ...], Doc("of the top from the bottom: [x, z] or [x, y, z]")] | None = None

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Bottom:
    """Motion of the bottom end."""

    motion: Annotated[Literal["harmonic", "crank-slider", "measured", "step", "fixed"], Doc(_MOTIONS)]
    direction: Annotated[
        Literal["tangent", "vertical", "horizontal"] | tuple[float, ...],
        Doc("of the motion: along the cable's lower end, up, along x, or the components of a vector"),
    ] = "tangent"
    amplitude: Annotated[float, SI("m", "of a harmonic motion, peak", minimum=0.0)] | None = None
    frequency: Annotated[float, SI("Hz", "of a harmonic motion or a crank", above=0.0)] | None = None
    radius: Annotated[float, SI("m", "of the crank", minimum=0.0)] | None = None
    rod_ratio: Annotated[float, SI("1", ROD_RATIO, minimum=0.0, maximum=0.99)] | None = None
    velocity: Annotated[float, SI("m/s", "from the start on, of a step")] | None = None
    start: Annotated[Literal["jump", "ramp"], Doc("at once, or growing over ramp")] = "jump"
    ramp: Annotated[float, SI("s", "over which the motion grows to its full size", above=0.0)] | None = None
    file: Annotated[str, Doc("table of a measured motion, beside the scene")] | None = None
    time_column: Annotated[str, Doc("name of its time column")] | None = None
    displacement_column: Annotated[str, Doc("name of its displacement column")] | None = None
    unit: Annotated[str, Doc("of the displacement column")] | None = None

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Top:
    """The upper end: fixed, or a platform under lift with a position loop."""

    kind: Annotated[Literal["fixed", "platform"], Doc("held fast, or a mass under lift")]
    mass: Annotated[float, SI("kg", "of the platform", minimum=0.0)] | None = None
    static_tension: Annotated[float, SI("N", "at rest, which the lift holds", above=0.0)] | None = None
    lift: Annotated[Force | tuple[Force, ...], Doc("upwards, or its components")] | None = None
    hover_stiffness: Annotated[Stiffness | tuple[Stiffness, ...], Doc("of the position loop")] = 0.0
    hover_damping: Annotated[Damping | tuple[Damping, ...], Doc("of the position loop")] = 0.0
    drag_area: Annotated[tuple[Area, Area], Doc("Cd times area, forward and upward")] | None = None
    tilt: Annotated[float, SI("rad", "by which the body leans down from level, forward")] = 0.0

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Output:
    """What is wanted, where and how often."""

    duration: Annotated[float, SI("s", "of the record", above=0.0)]
    rate: Annotated[float, SI("Hz", "of the rows", above=0.0)]
    gauges: Annotated[
        tuple[Annotated[float, SI("1", minimum=0.0, maximum=1.0)], ...],
        Doc("places of tension and strain: fractions of the length from the bottom"),
    ]
    fields: Annotated[tuple[FieldName, ...], Doc("what else is written of the gauges")] = ()

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Relative error wanted in the gauges' tension (RMS over the record, of the dynamic part)."""

    tolerance: Annotated[float, SI("1", "largest error wanted", above=0.0, maximum=1.0)] = 0.01

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

    name: Annotated[str, Doc("which answers show")]
    cable: Cable
    geometry: Geometry
    bottom: Bottom
    top: Top
    output: Output
    air: Air | None = None
    accuracy: Accuracy = Accuracy()
    gravity: Annotated[float, SI("m/s^2", "downwards, along -z", minimum=0.0)] = 9.80665

    def __post_init__(self) -> None:
        check_types(self)
