"""The geometrically exact cable in its plane: one march on one mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.kernels.planar import PlanarLine, PlanarTop, march_plane
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Field
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.nonlinear.axial import VISCOSITY, AxialSolution, courant_limit, empty_record
from tethertest.solver.statics.catenary_shape import (
    ElasticCatenary,
    catenary_between,
    catenary_of_rest_length,
    shallow_catenary,
)
from tethertest.solver.statics.chain_rest import ChainRest, chain_rest
from tethertest.solver.motion import displacement
from tethertest.solver.statics.rest import rest_state

#: geometries whose rest is known from the ends or the tension
GEOMETRIES = ("shallow", "ends", "vertical")
#: distance between the two statements of an upper end's tension that still counts as agreement
_TENSION_AGREEMENT = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class PlanarCase:
    """A scene turned into a chain at rest with everything its march needs."""

    shape: ElasticCatenary  #: rest of the continuous cable without wind
    line: PlanarLine
    top: PlanarTop
    rest: ChainRest
    direction: FloatArray  #: (2,) unit vector of the bottom motion

    @property
    def wave_speed(self) -> float:
        """Axial wave speed in the material coordinate [m/s]."""
        return math.sqrt(self.line.stiffness / self.line.mass)


def rest_shape(scene: Scene) -> ElasticCatenary:
    """Return the rest of the continuous cable without wind.

    Raises
    ------
    DataError
        The geometry is not one of `GEOMETRIES`, leaves the plane, or has no rest.
    """
    cable, geometry = scene.cable, scene.geometry
    if geometry.kind == "vertical":
        rest = rest_state(scene)
        load = np.array([0.0, -rest.mass_per_length * rest.gravity])
        return ElasticCatenary(rest.length, rest.axial_stiffness, load, np.array([0.0, rest.bottom_tension]))
    if geometry.kind == "shallow":
        if geometry.tension is None:
            message = f'scene {scene.name!r}: geometry "shallow" has no tension'
            raise DataError(message, "give [geometry] tension")
        return shallow_catenary(
            cable.length,
            cable.length_state,
            cable.mass_per_length,
            _axial_stiffness(scene),
            geometry.tension,
            scene.gravity,
        )
    if geometry.kind == "ends":
        if geometry.top is None:
            message = f'scene {scene.name!r}: geometry "ends" has no upper end'
            raise DataError(message, "give [geometry] top = [x, z]")
        chord = _plane_vector(geometry.top, scene, "[geometry] top")
        load = np.array([0.0, -cable.mass_per_length * scene.gravity])
        if cable.length_state == "unstretched":
            return catenary_between(chord, cable.length, _axial_stiffness(scene), load)
        return catenary_of_rest_length(chord, cable.length, _axial_stiffness(scene), load * cable.length)
    message = f"scene {scene.name!r}: geometry {geometry.kind!r} is not one that the planar march handles"
    raise DataError(message, f"give [geometry] kind as one of {', '.join(GEOMETRIES)}")


def planar_case(scene: Scene, cells: int, *, viscous: bool) -> PlanarCase:
    """Return the chain at rest, in wind, with the upper end that holds it.

    Parameters
    ----------
    scene : Scene
        With a geometry of `GEOMETRIES`.
    cells : int
        Number of cells, at least 2.
    viscous : bool
        With the limited viscosity that slack and fronts need.

    Raises
    ------
    DataError
        As `rest_shape`; or the scene has what this march does not know.
    """
    shape = rest_shape(scene)
    mass = scene.cable.mass_per_length
    if scene.cable.length_state == "equilibrium":
        mass *= scene.cable.length / shape.length
    normal, tangential, wind = _air(scene)
    line = PlanarLine(
        cell=shape.length / cells,
        mass=mass,
        stiffness=shape.axial_stiffness,
        damping_time=scene.cable.axial_damping_time or 0.0,
        viscosity=VISCOSITY if viscous else 0.0,
        gravity_x=0.0,
        gravity_z=-scene.gravity,
        normal_drag=normal,
        tangential_drag=tangential,
        wind_x=float(wind[0]),
        wind_z=float(wind[1]),
    )
    rest = chain_rest(shape, cells, line, shape.position(np.array([shape.length]))[0])
    return PlanarCase(shape, line, _top_end(scene, rest), rest, _direction(scene, rest))


def planar_step(case: PlanarCase, courant: float | None = None) -> float:
    """Return the time step [s]: the largest stable one, or that of a given Courant number.

    Raises
    ------
    DataError
        The Courant number is above the stability limit.
    """
    line = case.line
    limit = courant_limit(line.viscosity, line.damping_time, case.wave_speed, line.cell)
    if courant is not None and not 0.0 < courant <= limit:
        message = f"Courant number {courant:g} lies outside 0 to the stability limit {limit:.4g}"
        raise DataError(message, "give a smaller one, or none for the largest stable one")
    return (limit if courant is None else courant) * line.cell / case.wave_speed


def run_planar(
    scene: Scene,
    cells: int,
    *,
    viscous: bool,
    courant: float | None = None,
    measured: MeasuredMotion | None = None,
) -> AxialSolution:
    """March a scene in its plane once.

    Parameters
    ----------
    scene : Scene
        Geometry "shallow", "ends" or "vertical".
    cells : int
        Number of cells, at least 2.
    viscous : bool
        True for the default with limited viscosity; False only for taut, smooth scenes.
    courant : float, optional
        Courant number of the axial wave; the largest stable one if absent.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.

    Returns
    -------
    AxialSolution
        ``platform_position`` is the height of the upper end above its rest.

    Raises
    ------
    DataError
        As `planar_case` and `planar_step`.
    """
    case = planar_case(scene, cells, viscous=viscous)
    time_step = planar_step(case, courant)
    steps = math.ceil(scene.output.duration / time_step) + 2
    bottom = displacement(scene.bottom, np.arange(steps + 2, dtype=np.float64) * time_step, measured)
    bottom = bottom - bottom[0]  # at rest where the record begins
    x, z = case.rest.x.copy(), case.rest.z.copy()
    record = empty_record(scene, cells, steps)
    direction = (float(case.direction[0]), float(case.direction[1]))
    done = march_plane(bottom, direction, x, z, case.line, case.top, time_step, record)
    bins = record.field_maximum.shape[0]
    centres = (np.arange(cells) + 0.5) / cells
    return AxialSolution(
        time=np.arange(record.top.size, dtype=np.float64) / scene.output.rate,
        tension=record.tension,
        strain=record.strain - _rest_strain(case, record.gauge_index, record.gauge_weight),
        platform_position=record.top - case.rest.z[-1],
        field=Field(
            time=np.arange(bins, dtype=np.float64) * (record.bin_steps * time_step),
            position=np.concatenate([[0.0], centres, [1.0]]),
            maximum=record.field_maximum,
            minimum=record.field_minimum,
        ),
        time_step=time_step,
        steps_done=done,
        steps=steps,
    )


def _rest_strain(case: PlanarCase, index: np.ndarray, weight: FloatArray) -> FloatArray:
    """Return the strain (g,) at rest, between stations as the march interpolates."""
    ends = [float(np.linalg.norm(force)) for force in (case.rest.start_force, case.rest.end_force)]
    strain = np.concatenate([ends[:1], case.rest.tension, ends[1:]]) / case.line.stiffness
    return np.asarray((1.0 - weight) * strain[index] + weight * strain[index + 1])


def _axial_stiffness(scene: Scene) -> float:
    cable = scene.cable
    if cable.axial_stiffness is not None:
        return cable.axial_stiffness
    if cable.youngs_modulus is None or cable.diameter is None:
        message = f"scene {scene.name!r}: neither axial_stiffness nor youngs_modulus with diameter is given"
        raise DataError(message, "give [cable] axial_stiffness")
    return cable.youngs_modulus * math.pi * cable.diameter**2 / 4.0


def _plane_vector(vector: tuple[float, ...], scene: Scene, key: str) -> FloatArray:
    """Return x and z of a vector [x, z] or [x, 0, z]."""
    if len(vector) == 3 and vector[1] != 0.0:
        message = f"scene {scene.name!r}: {key} leaves the plane"
        raise DataError(message, "turn the axes so that y is 0")
    return np.array([vector[0], vector[-1]], dtype=np.float64)


def _air(scene: Scene) -> tuple[float, float, FloatArray]:
    """Return normal and tangential drag per length and velocity squared [N s^2/m^3], and the wind [m/s]."""
    air = scene.air
    if air is None:
        return 0.0, 0.0, np.zeros(2)
    if air.wind_file is not None:
        message = f"scene {scene.name!r}: wind from a file is not one that the planar march handles"
        raise DataError(message, "give [air] wind")
    wind = _plane_vector(air.wind, scene, "[air] wind") if isinstance(air.wind, tuple) else air.wind
    still = isinstance(wind, float) and wind == 0.0
    wind_vector = np.array([wind, 0.0]) if isinstance(wind, float) else wind
    diameter = scene.cable.diameter
    if diameter is None:
        if still and air.normal_drag == 0.0 and air.tangential_drag == 0.0:
            return 0.0, 0.0, np.zeros(2)
        message = f"scene {scene.name!r}: drag needs the diameter of the cable"
        raise DataError(message, "give [cable] diameter")
    pressure = 0.5 * air.density * diameter
    return pressure * air.normal_drag, pressure * math.pi * air.tangential_drag, wind_vector


def _direction(scene: Scene, rest: ChainRest) -> FloatArray:
    """Return the unit vector of the bottom motion; the tangent is that of the cable at its bottom end."""
    direction = scene.bottom.direction
    if direction == "vertical":
        return np.array([0.0, 1.0])
    if direction == "horizontal":
        return np.array([1.0, 0.0])
    if direction == "tangent":
        vector = np.asarray(rest.start_force)
    else:
        vector = _plane_vector(direction, scene, "[bottom] direction")
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        message = f"scene {scene.name!r}: the bottom motion has no direction"
        raise DataError(message, "give [bottom] direction as a vector that is not zero")
    return np.asarray(vector / size)


def _top_end(scene: Scene, rest: ChainRest) -> PlanarTop:
    """Return the upper end; a platform's lift is what holds it at rest, from the discrete chain in wind."""
    top = scene.top
    if top.kind == "fixed":
        return PlanarTop(True, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if top.drag_area is not None and any(top.drag_area):
        message = f"scene {scene.name!r}: drag of the body is not one that the planar march handles"
        raise DataError(message, "leave out [top] drag_area")
    mass = top.mass or 0.0
    lift = rest.end_force + np.array([0.0, mass * scene.gravity])
    tension = float(np.linalg.norm(rest.end_force))
    stated = top.static_tension
    if stated is not None and abs(stated - tension) > _TENSION_AGREEMENT * tension and _still(scene):
        message = (
            f"scene {scene.name!r}: at rest the cable pulls with {tension:.6g} N at the top, "
            f"[top] static_tension says {stated:.6g} N"
        )
        raise DataError(message, "leave out [top] static_tension, or change the length of the cable")
    stiffness = _per_direction(top.hover_stiffness)
    damping = _per_direction(top.hover_damping)
    return PlanarTop(False, mass, float(lift[0]), float(lift[1]), *stiffness, *damping)


def _still(scene: Scene) -> bool:
    return scene.air is None or not np.any(scene.air.wind)


def _per_direction(value: float | tuple[float, ...]) -> tuple[float, float]:
    """Return a position loop's constants along x and z."""
    return (value[0], value[-1]) if isinstance(value, tuple) else (value, value)
