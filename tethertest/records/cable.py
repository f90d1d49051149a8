"""The cable, the air around it and the body at its top."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from tethertest.records.checked import check_types
from tethertest.records.described import Doc
from tethertest.records.quantity import SI

LengthState = Literal["unstretched", "equilibrium"]
Speed = Annotated[float, SI("m/s")]
Area = Annotated[float, SI("m^2", minimum=0.0)]


@dataclass(frozen=True, slots=True)
class Cable:
    """A uniform cable; its length and mass per length belong to one state."""

    length: Annotated[float, SI("m", "along the cable, in the state of length_state", above=0.0)]
    length_state: Annotated[LengthState, Doc("what length and mass belong to: no tension, or at rest")]
    mass_per_length: Annotated[float, SI("kg/m", "in the state of length_state", above=0.0)]
    axial_stiffness: Annotated[float, SI("N", "EA", above=0.0)] | None = None
    youngs_modulus: Annotated[float, SI("Pa", "E; gives EA by the diameter", above=0.0)] | None = None
    diameter: Annotated[float, SI("m", "of the section, for drag and EA", above=0.0)] | None = None
    axial_damping_time: Annotated[float, SI("s", "Kelvin-Voigt damping", minimum=0.0)] | None = (
        None  #: None is unknown
    )
    bending_stiffness: Annotated[float, SI("N m^2", "EI", minimum=0.0)] = 0.0

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Air:
    """Drag of Morison type on cable and body, and the wind."""

    density: Annotated[float, SI("kg/m^3", "of the air", minimum=0.0)]
    normal_drag: Annotated[float, SI("1", "drag coefficient across the cable", minimum=0.0)] = 0.0
    tangential_drag: Annotated[float, SI("1", "drag coefficient along the cable", minimum=0.0)] = 0.0
    wind: Annotated[Speed | tuple[Speed, ...], Doc("steady wind: along x, or its components")] = 0.0
    wind_file: Annotated[str, Doc("series of wind_x, wind_y, wind_z beside the scene")] | None = None

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class PlatformMode:
    """How the UAV's position loop works in one mode of the rig."""

    hover_stiffness: Annotated[float, SI("N/m", "of the position loop", minimum=0.0)] = 0.0
    hover_damping: Annotated[float, SI("N s/m", "of the position loop", minimum=0.0)] = 0.0

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Platform:
    """The UAV: a mass under lift, with the modes its position loop has on the rig."""

    mass: Annotated[float, SI("kg", "of the UAV", minimum=0.0)]
    static_tension: Annotated[float, SI("N", "top tension at rest, which the lift holds", above=0.0)]
    modes: Annotated[dict[str, PlatformMode], Doc("name of a mode -> its position loop")] = field(
        default_factory=lambda: {"free": PlatformMode()}
    )
    drag_area: Annotated[tuple[Area, Area], Doc("Cd times area, forward and upward")] | None = None
    tilt: Annotated[float, SI("rad", "by which the body leans down from level, forward")] = 0.0

    def __post_init__(self) -> None:
        check_types(self)
