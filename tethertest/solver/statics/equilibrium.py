"""The discrete equilibrium that every march starts from: in space, in steady wind, with bending stiffness.

The geometries "vertical", "straight" and "shallow" state a cable in still air: tension, length at rest and
the places of the ends are those without wind, and in wind the cable bows between these ends. "ends" and
"hovering" state the cable as it is, in its wind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.scene import Scene
from tethertest.solver.statics.air import body_drag
from tethertest.solver.statics.blown import loaded_chain, node_bending, node_loads
from tethertest.solver.statics.catenary_shape import LARGEST_STRAIN, shallow_catenary
from tethertest.solver.statics.chain import ChainLoad, ChainState
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import axial_stiffness, drag_coefficients, spatial, steady_wind

#: cells of the chain that gives the tension at rest
_REST_CELLS = 50
#: largest relative difference between a stated force at the top and the one at rest that counts as agreement
_AGREEMENT = 5e-3
#: cosine between neighbouring cells below which the chain is folded over
_FOLDED = -0.999


@dataclass(frozen=True, slots=True, eq=False)
class RestChain:
    """A chain of equal cells at rest."""

    cell: float  #: unstretched cell length [m]
    mass: float  #: per unstretched length [kg/m]
    stiffness: float  #: EA [N]
    nodes: FloatArray  #: (n + 1, 3) x, y, z from the bottom end [m]
    force: FloatArray  #: (n, 3) the upper part's elastic pull on the lower; the tension is its norm [N]
    start_force: FloatArray  #: (3,) at the bottom end, half a cell's load and bending included [N]
    end_force: FloatArray  #: (3,) that the upper end exerts on the cable, the same included [N]
    lift: FloatArray  #: (3,) constant force that holds the platform at rest; zero for a fixed top [N]

    @property
    def tension(self) -> FloatArray:
        """Tension of the cells (n,) [N]."""
        return np.asarray(np.linalg.norm(self.force, axis=1))


def rest_chain(scene: Scene, cells: int) -> RestChain:
    """Return the chain of ``cells`` cells at rest.

    Parameters
    ----------
    scene : Scene
        Any geometry.
    cells : int
        At least 2.

    Raises
    ------
    DataError
        A key is missing, two statements are at odds, the cable cannot be taut, its ends are out of reach,
        or the wind folds it over.
    """
    load = chain_load(scene, cells)
    state = loaded_chain(load)
    _check_shape(scene, state, load.stiffness)
    nodes = state.nodes(load.stiffness)
    loads, bend = node_loads(load, state), node_bending(load, state.cell, nodes)
    end_force = state.force[-1] - 0.5 * loads[-1] - bend[-1]
    lift = np.zeros(3)
    if scene.top.kind == "platform":
        lift = end_force + body_weight(scene) - body_drag(scene)
        _check_statement(scene, end_force, lift, not load.windy)
    return RestChain(
        cell=state.cell,
        mass=_total_mass(scene) / (cells * state.cell),
        stiffness=load.stiffness,
        nodes=frozen(nodes),
        force=frozen(state.force),
        start_force=frozen(state.force[0] + 0.5 * loads[0] + bend[0]),
        end_force=frozen(end_force),
        lift=frozen(lift),
    )


def rest_tension(scene: Scene) -> FloatArray:
    """Return the tension at rest (g,) [N] at the gauges of a scene."""
    rest = rest_chain(scene, _REST_CELLS)
    ends = [float(np.linalg.norm(force)) for force in (rest.start_force, rest.end_force)]
    places = np.concatenate([[0.0], (np.arange(_REST_CELLS) + 0.5) / _REST_CELLS, [1.0]])
    along = np.concatenate([ends[:1], rest.tension, ends[1:]])
    return np.asarray(np.interp(np.asarray(scene.output.gauges), places, along))


def chain_load(scene: Scene, cells: int) -> ChainLoad:
    """Return what a scene asks of its chain.

    Raises
    ------
    DataError
        A key is missing or at odds with another, or the cable cannot be taut.
    """
    cable, kind = scene.cable, scene.geometry.kind
    if cells < 2:
        message = f"scene {scene.name!r}: a chain of {cells} cells, expected at least 2"
        raise DataError(message, "use more cells")
    weight = _total_mass(scene) * np.array([0.0, 0.0, -gravity(scene)])
    length, fixed_rest_length = cable.length, cable.length_state == "equilibrium"
    stiffness = axial_stiffness(scene)
    wind = steady_wind(scene)
    drag = drag_coefficients(scene) if np.any(wind) else (0.0, 0.0)
    windy = any(drag)
    chord: FloatArray | None = None
    end_force = np.zeros(3)
    if kind in {"vertical", "straight"}:
        rest = rest_state(scene)
        length, fixed_rest_length = rest.length, False
        if windy:
            mean = 0.5 * (rest.bottom_tension + rest.top_tension)
            chord = np.array([0.0, 0.0, length * (1.0 + mean / stiffness)])
        else:
            end_force = np.array([0.0, 0.0, rest.top_tension])
    elif kind == "shallow":
        chord, length = _level_chord(scene, stiffness)
        fixed_rest_length = False
    elif kind == "ends":
        if scene.geometry.top is None:
            message = f'scene {scene.name!r}: geometry "ends" has no upper end'
            raise DataError(message, 'give [geometry] top, such as ["110 m", "90 m"]')
        chord = spatial(scene.geometry.top)
    else:
        end_force = _known_end_force(scene, weight)
    return ChainLoad(
        cells=cells,
        length=length,
        fixed_rest_length=fixed_rest_length,
        stiffness=stiffness,
        bending=cable.bending_stiffness,
        weight=weight,
        wind=wind if windy else np.zeros(3),
        drag=drag,
        chord=chord,
        end_force=end_force,
    )


def gravity(scene: Scene) -> float:
    """Return the gravity that acts in a scene [m/s^2]; a straight cable has none."""
    return 0.0 if scene.geometry.kind == "straight" else scene.gravity


def body_weight(scene: Scene) -> FloatArray:
    """Return the force (3,) that would carry the platform's own weight [N]."""
    return np.array([0.0, 0.0, (scene.top.mass or 0.0) * gravity(scene)])


def _total_mass(scene: Scene) -> float:
    return scene.cable.length * scene.cable.mass_per_length


def _level_chord(scene: Scene, stiffness: float) -> tuple[FloatArray, float]:
    """Return the chord and the unstretched length of a cable with level ends and a given level tension."""
    cable, tension = scene.cable, scene.geometry.tension
    if tension is None:
        message = f'scene {scene.name!r}: geometry "shallow" has no tension'
        raise DataError(message, 'give [geometry] tension, such as "80 N"')
    shape = shallow_catenary(
        cable.length, cable.length_state, cable.mass_per_length, stiffness, tension, scene.gravity
    )
    span = shape.position(np.array([shape.length]))[0]
    return np.array([span[0], 0.0, 0.0]), shape.length


def _known_end_force(scene: Scene, weight: FloatArray) -> FloatArray:
    """Return the force (3,) with which a hovering platform pulls the cable."""
    top = scene.top
    if top.kind != "platform":
        message = f'scene {scene.name!r}: geometry "hovering" has a fixed top'
        raise DataError(message, 'set [top] kind = "platform" with its mass and lift')
    if (top.lift is None) == (top.static_tension is None):
        found = "neither lift nor static_tension" if top.lift is None else "both lift and static_tension"
        message = f"scene {scene.name!r}: the platform has {found}"
        raise DataError(message, "give one of the two in [top]")
    drag, own = body_drag(scene), body_weight(scene)
    if top.lift is not None:
        lift = spatial(top.lift) if isinstance(top.lift, tuple) else np.array([0.0, 0.0, top.lift])
        force = lift - own + drag
        said = f"the lift of {float(lift[2]):.4g} N leaves {float(force[2]):.4g} N upwards for the cable"
    else:
        tension = float(top.static_tension or 0.0)
        across = float(np.hypot(drag[0], drag[1]))
        if across >= tension:
            message = (
                f"scene {scene.name!r}: the wind pushes the platform with {across:.4g} N, "
                f"static_tension is {tension:.4g} N"
            )
            raise DataError(message, "raise [top] static_tension above the wind's push, or lower the wind")
        force = np.array([drag[0], drag[1], float(np.sqrt(tension**2 - across**2))])
        said = f"the static tension of {tension:.4g} N pulls upwards with {float(force[2]):.4g} N"
    needed = -float(weight[2])
    if force[2] <= needed:
        message = f"scene {scene.name!r}: {said}, which weighs {needed:.4g} N; it cannot be taut"
        key = "lift" if top.lift is not None else "static_tension"
        raise DataError(message, f"raise [top] {key} by more than {needed - float(force[2]):.4g} N")
    return np.asarray(force)


def _check_shape(scene: Scene, state: ChainState, stiffness: float) -> None:
    if state.sharpest_turn < _FOLDED:
        message = f"scene {scene.name!r}: the cable cannot be taut, it folds back on itself at rest"
        raise DataError(message, "shorten [cable] length, move [geometry] top aside, or raise the tension")
    mean = float(np.mean(np.linalg.norm(state.force, axis=1))) / stiffness
    if mean > LARGEST_STRAIN:
        message = f"scene {scene.name!r}: the cable would be strained by {mean:.0%} at rest"
        raise DataError(message, "check stiffness, length and tension of the cable")


def _check_statement(scene: Scene, end_force: FloatArray, lift: FloatArray, still: bool) -> None:
    """Raise if a platform's stated lift or tension does not hold it at a given place."""
    top = scene.top
    if top.lift is not None and top.static_tension is not None:
        message = f"scene {scene.name!r}: the platform has both lift and static_tension"
        raise DataError(message, "give one of the two in [top]")
    if not (scene.geometry.kind == "ends" or (scene.geometry.kind == "shallow" and still)):
        return
    tension = float(np.linalg.norm(end_force))
    if top.static_tension is not None and abs(top.static_tension - tension) > _AGREEMENT * tension:
        message = (
            f"scene {scene.name!r}: held there the cable pulls with {tension:.6g} N at the top, "
            f"[top] static_tension says {top.static_tension:.6g} N"
        )
        raise DataError(message, f'leave it out, write "{tension:.6g} N", or change [cable] length')
    if top.lift is None:
        return
    stated = spatial(top.lift) if isinstance(top.lift, tuple) else np.array([0.0, 0.0, top.lift])
    if float(np.linalg.norm(stated - lift)) > _AGREEMENT * float(np.linalg.norm(lift)):
        needed = ", ".join(f'"{value:.6g} N"' for value in lift)
        message = f"scene {scene.name!r}: [top] lift {top.lift!r} does not hold the platform at its place"
        raise DataError(message, f'leave out lift, write [{needed}], or set [geometry] kind = "hovering"')
