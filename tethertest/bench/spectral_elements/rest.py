"""Rest of a cable in spectral elements: geometry of the scene, then Newton on the elements' own balance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.bench.spectral_elements.kernel import SpectralCable, pull_nodes
from tethertest.bench.spectral_elements.mesh import SpectralMesh
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.statics.catenary_shape import (
    ElasticCatenary,
    catenary_between,
    catenary_of_rest_length,
    shallow_catenary,
)
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import axial_stiffness, drag_coefficients, leaves_plane, spatial, steady_wind

#: change of a node at which Newton's iteration has settled, relative to the length
_SETTLED = 1e-12
#: change from which the iteration may be left where rounding allows no less
_ACCEPTED = 1e-9
#: step of the difference quotients, relative to the length
_QUOTIENT = 1e-7
#: most iterations
_ITERATIONS = 60


@dataclass(frozen=True, slots=True, eq=False)
class SpectralRest:
    """A scene's cable at rest."""

    mesh: SpectralMesh
    cable: SpectralCable
    axes: tuple[int, ...]  #: which of x, y, z the march follows
    position: FloatArray  #: (d, m) [m] from the bottom end
    force: FloatArray  #: (d, m) of cable, gravity and air on the nodes [N]; zero but at the ends
    start_force: FloatArray  #: (3,) with which the cable pulls the bottom end [N]


def spectral_rest(scene: Scene, elements: int) -> SpectralRest:
    """Return the rest of a scene, in its wind.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical", "straight", "shallow" or "ends".
    elements : int
        Number of elements.

    Raises
    ------
    DataError
        The geometry is another one or lacks a key, the ends are out of reach, or no taut rest was found.
    """
    shape, turn = _still_shape(scene)
    axes = _axes(scene, turn)
    picked = list(axes)
    mesh = SpectralMesh(shape.length, elements)
    start = (shape.position(mesh.arc) @ turn)[:, picked].T.copy()
    fixed_length = scene.cable.length if _length_moves(scene) else None
    position, length = _newton(scene, start, mesh, picked, fixed_length)
    mesh = SpectralMesh(length, elements)
    cable = _cable(scene, mesh, picked)
    inner, force = np.zeros_like(position), np.zeros_like(position)
    if not pull_nodes(position, np.zeros_like(position), cable, inner, force) > 1.0:
        message = f"scene {scene.name!r}: the cable is slack at rest"
        raise DataError(message, "give a shorter cable or more tension; this reference knows taut cables")
    pull = np.zeros(3)
    pull[picked] = force[:, 0]
    return SpectralRest(mesh, cable, axes, position, force, pull)


def _length_moves(scene: Scene) -> bool:
    """Return whether the unstretched length follows from the length that the cable has in its wind."""
    return scene.geometry.kind == "ends" and scene.cable.length_state == "equilibrium"


def _still_shape(scene: Scene) -> tuple[ElasticCatenary, FloatArray]:
    """Return the rest without wind in its own plane, and that plane's axes (2, 3) in space."""
    cable, kind = scene.cable, scene.geometry.kind
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    if kind in {"vertical", "straight"}:
        rest = rest_state(scene)
        load = np.array([0.0, -rest.mass_per_length * rest.gravity])
        return ElasticCatenary(
            rest.length, rest.axial_stiffness, load, np.array([0.0, rest.bottom_tension])
        ), turn
    stiffness = axial_stiffness(scene)
    if kind == "shallow" and scene.geometry.tension is not None:
        tension, mass = scene.geometry.tension, cable.mass_per_length
        return shallow_catenary(
            cable.length, cable.length_state, mass, stiffness, tension, scene.gravity
        ), turn
    if kind == "ends" and scene.geometry.top is not None:
        top = spatial(scene.geometry.top)
        across = float(np.hypot(top[0], top[1]))
        if top[1] != 0.0:
            turn[0] = np.array([top[0], top[1], 0.0]) / across
        chord = turn @ top
        load = np.array([0.0, -cable.mass_per_length * scene.gravity])
        if cable.length_state == "unstretched":
            return catenary_between(chord, cable.length, stiffness, load), turn
        return catenary_of_rest_length(chord, cable.length, stiffness, load * cable.length), turn
    message = f"scene {scene.name!r}: geometry {kind!r} is unknown to this reference or lacks its place"
    raise DataError(message, "give [geometry] tension, or its top for kind ends")


def _axes(scene: Scene, turn: FloatArray) -> tuple[int, ...]:
    if leaves_plane(scene) or turn[0, 1] != 0.0:
        return (0, 1, 2)
    windy = any(drag_coefficients(scene)) and bool(np.any(steady_wind(scene)[:2]))
    along = scene.bottom.direction in {"tangent", "vertical"}
    return (2,) if scene.geometry.kind in {"vertical", "straight"} and along and not windy else (0, 2)


def _cable(scene: Scene, mesh: SpectralMesh, picked: list[int]) -> SpectralCable:
    """Return the cable of a scene whose unstretched length is that of the mesh."""
    cable = scene.cable
    normal, tangential = drag_coefficients(scene)
    up = 0.0 if scene.geometry.kind == "straight" else scene.gravity
    return SpectralCable(
        mass=cable.mass_per_length * cable.length / mesh.length,
        stiffness=axial_stiffness(scene),
        damping_time=cable.axial_damping_time or 0.0,
        gravity=np.array([0.0, 0.0, -up])[picked],
        normal_drag=normal,
        tangential_drag=tangential,
        wind=steady_wind(scene)[picked],
        derivative=np.ascontiguousarray(mesh.derivative),
        points=mesh.points,
        integral=np.ascontiguousarray(mesh.integral),
        nodes=mesh.nodes,
    )


def _newton(
    scene: Scene, start: FloatArray, mesh: SpectralMesh, picked: list[int], rest_length: float | None
) -> tuple[FloatArray, float]:
    """Return the inner nodes' places in balance and the unstretched length, which a rest length decides."""
    d, m = start.shape
    inner, force, still = np.zeros((d, m)), np.zeros((d, m)), np.zeros((d, m))
    stiffness = axial_stiffness(scene)

    def unfold(unknowns: FloatArray) -> tuple[FloatArray, float]:
        position = start.copy()
        position[:, 1:-1] = unknowns[:-1].reshape(d, m - 2)
        return position, float(unknowns[-1])

    def residual(unknowns: FloatArray) -> FloatArray:
        position, length = unfold(unknowns)
        cut = SpectralMesh(length, mesh.elements)
        cable = _cable(scene, cut, picked)
        pull_nodes(position, still, cable, inner, force)
        misfit = length - mesh.length
        if rest_length is not None:
            misfit = cut.stretched_length(position) - rest_length
        return np.append(force[:, 1:-1].ravel(), misfit * stiffness / mesh.length)

    unknowns = np.append(start[:, 1:-1].ravel(), mesh.length)
    change = np.inf
    for _ in range(_ITERATIONS):
        step = np.linalg.solve(
            _difference_quotients(residual, unknowns, _QUOTIENT * mesh.length), residual(unknowns)
        )
        before, change = change, float(np.max(np.abs(step))) / mesh.length
        if change > _ACCEPTED or change < before:
            unknowns = unknowns - step * min(1.0, 0.05 / change)
        if change <= _SETTLED or (change <= _ACCEPTED and change >= before):
            return unfold(unknowns)
    message = f"scene {scene.name!r}: no rest of the cable found in this wind"
    raise DataError(message, "lower [air] wind, or raise the tension of the cable")


def _difference_quotients(
    function: Callable[[FloatArray], FloatArray], at: FloatArray, step: float
) -> FloatArray:
    columns = []
    for i in range(at.size):
        shift = np.zeros(at.size)
        shift[i] = step
        columns.append((function(at + shift) - function(at - shift)) / (2.0 * step))
    return np.column_stack(columns)
