"""The answer that a scene's runs are measured with: a closed form or another discretisation, named."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.bench.case import Case
from tethertest.bench.finite_volumes.march import run_axial_muscl
from tethertest.bench.spectral_elements.march import run_spectral, step_count
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.norms import finished, goes_slack, relative_difference
from tethertest.solver.problem import Problem
from tethertest.solver.solution import Solution
from tethertest.solver.statics.rest import rest_state
from tethertest.solver.terms import steady_wind

#: elements and cells that a reference goes through, coarse to fine, and where it stops
_ELEMENTS, _ELEMENT_STEPS = (2, 4, 8, 12, 24, 48), 4e6
_CELLS, _CELL_STEPS, _DAMPED_STEPS = (20, 40, 80, 160, 320, 640, 1280), 7e8, 1.5e8
#: places and instants at which a taut cable is asked whether it goes slack
_PLACES, _INSTANTS = np.linspace(0.0, 1.0, 21), 2000
#: distance of a mesh from the one before at which no finer one is needed
_CLOSE = 1e-6
#: meshes of the march itself, where nothing else knows the scene
_SAME_TAUT, _SAME_SLACK = (800, 1600, 3200), (320, 640, 1280)


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """A reference answer at a scene's output times and gauges."""

    name: str
    kind: str  #: "closed form", "other discretisation" or "same scheme"
    tension: FloatArray  #: (n, g) [N]
    own_error: float | None  #: its distance from the next coarser one of its kind; None for a closed form
    first_gauge: int = 0  #: gauges before this one do not count


def reference_for(case: Case) -> Reference:
    """Return the best reference that knows a scene.

    Raises
    ------
    DataError
        The scene has no rest.
    """
    if _along(case):
        exact = closed_form(case.scene)
        if exact is not None:
            return Reference("d'Alembert's series", "closed form", exact, None)
        return _finite_volumes(case)
    if case.wind is None:
        try:
            return _spectral(case)
        except DataError:  # a start too sudden, a slack cable, or what that reference does not know
            pass
    return _same_scheme(case)


def closed_form(scene: Scene) -> FloatArray | None:
    """Return the tension (n, g) [N] of a taut elastic cable under a fixed top, moved along itself.

    ``T = P - Z sum_n [v0(t - (2 n L + S)/c) + v0(t - (2 (n + 1) L - S)/c)]`` in the unstretched coordinate S;
    the values at the instant of a front are those after it.

    Parameters
    ----------
    scene : Scene
        Geometry "vertical" or "straight", moved by a step or a harmonic motion.

    Returns
    -------
    (n, g) float64 or None
        None where the series is not the answer: the cable is damped, in air or slack, or its end moves.
    """
    cable, bottom = scene.cable, scene.bottom
    smooth_or_known = bottom.motion in {"step", "harmonic"}
    if scene.top.kind != "fixed" or scene.air is not None or cable.axial_damping_time or not smooth_or_known:
        return None
    rest = rest_state(scene)
    traverse = rest.length * math.sqrt(rest.mass_per_length / rest.axial_stiffness)
    impedance = math.sqrt(rest.axial_stiffness * rest.mass_per_length)
    rows = math.floor(scene.output.duration * scene.output.rate + 1e-9) + 1
    time = np.arange(rows)[:, None] / scene.output.rate

    def tension(fraction: FloatArray, time: FloatArray) -> FloatArray:
        arrived = np.zeros((time.size, fraction.size))
        for passage in range(math.ceil(scene.output.duration / (2.0 * traverse)) + 1):
            for delay in (2.0 * passage + fraction, 2.0 * (passage + 1) - fraction):
                arrived += _speed(scene, time - delay * traverse)
        return np.asarray(rest.bottom_tension + fraction * rest.weight - impedance * arrived)

    if np.min(tension(_PLACES, time[:: math.ceil(rows / _INSTANTS)])) <= 0.0:
        return None
    return tension(np.asarray(scene.output.gauges), time)


def _speed(scene: Scene, time: FloatArray) -> FloatArray:
    """Return the bottom's velocity [m/s], written out anew; an instant counts as begun to rounding."""
    bottom, begun = scene.bottom, time >= -1e-9
    if bottom.motion == "step":
        return np.where(begun, bottom.velocity or 0.0, 0.0)
    amplitude, w = bottom.amplitude or 0.0, 2.0 * math.pi * (bottom.frequency or 0.0)
    envelope, slope = np.ones_like(time), np.zeros_like(time)
    if bottom.start == "ramp":
        ramp = bottom.ramp or 1.0
        x = np.clip(time / ramp, 0.0, 1.0)
        envelope, slope = ((6.0 * x - 15.0) * x + 10.0) * x**3, 30.0 * (x * (1.0 - x)) ** 2 / ramp
    moving = amplitude * (w * np.cos(w * time) * envelope + np.sin(w * time) * slope)
    return np.where(begun, moving, 0.0)


def _along(case: Case) -> bool:
    scene = case.scene
    moved = scene.bottom.direction in {"tangent", "vertical"}
    still = case.wind is None and not np.any(steady_wind(scene))
    return scene.geometry.kind in {"vertical", "straight"} and moved and still


def _finite_volumes(case: Case) -> Reference:
    damped = bool(case.scene.cable.axial_damping_time)
    most = _DAMPED_STEPS if damped else _CELL_STEPS

    def work(cells: int) -> float:
        rest = rest_state(case.scene)
        return cells * case.scene.output.duration * rest.wave_speed / (0.4 * rest.length / cells)

    def run(cells: int) -> Solution:
        return run_axial_muscl(case.scene, cells, measured=case.measured)

    # where a damped cable gets taut again, these volumes' tension spikes at the lower end for one row
    first = int(damped and len(case.scene.output.gauges) > 1 and case.scene.output.gauges[0] == 0.0)
    tension, own, cells = _pair(run, [cells for cells in _CELLS if work(cells) <= most], first)
    name = f"finite volumes, exact taut-slack Riemann solver, {cells} cells"
    if first:
        name += ", bottom gauge left out"
    return Reference(name, "other discretisation", tension, own, first)


def _spectral(case: Case) -> Reference:
    def run(elements: int) -> Solution:
        return run_spectral(case.scene, elements, measured=case.measured)

    affordable = [n for n in _ELEMENTS if n * step_count(case.scene, n) <= _ELEMENT_STEPS]
    tension, own, elements = _pair(run, affordable)
    return Reference(f"{elements} spectral elements of degree 8", "other discretisation", tension, own)


def _same_scheme(case: Case) -> Reference:
    probe = run_chain(case.scene, 40, viscous=False, measured=case.measured, wind=case.wind)
    slack = goes_slack(probe)

    def run(cells: int) -> Solution:
        return run_chain(case.scene, cells, viscous=slack, measured=case.measured, wind=case.wind)

    tension, own, cells = _pair(run, list(_SAME_SLACK if slack else _SAME_TAUT))
    return Reference(f"same scheme, {cells} cells", "same scheme", tension, own)


def _pair(run: Callable[[int], Solution], meshes: list[int], first: int = 0) -> tuple[FloatArray, float, int]:
    """Return the finest run that is needed, its distance from the one before, and its mesh."""
    if len(meshes) < 2:
        message = "no pair of meshes of this reference is affordable"
        raise DataError(message, "shorten [output] duration")
    fine, own, used = _finished(run(meshes[0])), np.inf, meshes[0]
    for used in meshes[1:]:
        coarse, fine = fine, _finished(run(used))
        own = relative_difference(coarse[:, first:], fine[:, first:])
        if own < _CLOSE:
            break
    return fine, own, used


def _finished(solution: Solution) -> FloatArray:
    if not finished(solution):
        message = "the cable goes slack, which this reference does not know"
        raise DataError(message, "take another reference")
    return solution.tension


def is_sudden(case: Case) -> bool:
    """Return whether the bottom starts with a velocity."""
    return Problem(case.scene, case.scene.accuracy.tolerance, case.measured).sudden
