"""The cable, the air around it and the body at its top."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from tethertest.records.checked import check_types
from tethertest.records.quantity import SI

LengthState = Literal["unstretched", "equilibrium"]


@dataclass(frozen=True, slots=True)
class Cable:
    """A uniform cable; its length and mass per length belong to one state."""

    length: Annotated[float, SI("m", above=0.0)]
    length_state: LengthState
    mass_per_length: Annotated[float, SI("kg/m", above=0.0)]
    axial_stiffness: Annotated[float, SI("N", above=0.0)] | None = None  #: EA
    youngs_modulus: Annotated[float, SI("Pa", above=0.0)] | None = None
    diameter: Annotated[float, SI("m", above=0.0)] | None = None
    axial_damping_time: Annotated[float, SI("s", minimum=0.0)] | None = None  #: Kelvin-Voigt; None is unknown
    bending_stiffness: Annotated[float, SI("N m^2", minimum=0.0)] = 0.0

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Air:
    """Drag of Morison type on cable and body, and the wind."""

    density: Annotated[float, SI("kg/m^3", minimum=0.0)]
    normal_drag: Annotated[float, SI("1", minimum=0.0)] = 0.0
    tangential_drag: Annotated[float, SI("1", minimum=0.0)] = 0.0
    wind: Annotated[float, SI("m/s")] | tuple[Annotated[float, SI("m/s")], ...] = 0.0
    wind_file: str | None = None

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class PlatformMode:
    """How the UAV's position loop works in one mode of the rig."""

    hover_stiffness: Annotated[float, SI("N/m", minimum=0.0)] = 0.0
    hover_damping: Annotated[float, SI("N s/m", minimum=0.0)] = 0.0

    def __post_init__(self) -> None:
        check_types(self)


@dataclass(frozen=True, slots=True)
class Platform:
    """The UAV: a mass under lift, with the modes its position loop has on the rig."""

    mass: Annotated[float, SI("kg", minimum=0.0)]
    static_tension: Annotated[float, SI("N", above=0.0)]  #: the lift holds this top tension at rest
    modes: dict[str, PlatformMode] = field(default_factory=lambda: {"free": PlatformMode()})
    drag_area: (
        tuple[Annotated[float, SI("m^2", minimum=0.0)], Annotated[float, SI("m^2", minimum=0.0)]] | None
    ) = None
    tilt: Annotated[float, SI("rad")] = 0.0

    def __post_init__(self) -> None:
        check_types(self)
