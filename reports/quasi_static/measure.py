"""The quasi-static model's predicted error against its true one, over random inclined scenes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.nonlinear.chain_march import run_chain
from tethertest.solver.quasi_static.catenary_run import run_catenary
from tethertest.solver.quasi_static.hanging import HangingCable
from tethertest.solver.quasi_static.validity import QuasiStaticEstimate, quasi_static_error

_GRAVITY = 9.80665
#: largest strain of a scene that counts
_STRAIN = 0.05
#: cells of the coarser of two marches, whose 4th-order combination is the reference
_CELLS = 40


@dataclass(frozen=True, slots=True)
class Measured:
    """One scene's predicted and true error."""

    seed: int
    estimate: QuasiStaticEstimate
    true: float  #: relative, as the estimate
    numerical: float  #: of the reference, relative to its dynamic part
    slack: bool  #: whether the march went slack
    simple: float  #: ``(A w^2 / 2 g) / |1 - (3 w / w_t)^2|``, w_t at the lowest quasi-static tension


def random_scene(seed: int) -> Scene:
    """Return an inclined cable in air, its bottom end moved in its plane, under a fixed or hovering top.

    Inclination 10 to 80 degrees, length 1 to 500 m, tension 0.5 to 30 of the cable's weight, wave speed ratio
    5 to 300, drive at 0.02 to 1 of the first lateral frequency with 0.001 to 0.1 of the length.
    """
    random = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(random.uniform(math.log(low), math.log(high))))

    length, mass = between(1.0, 500.0), between(0.01, 0.2)
    weight = mass * _GRAVITY
    tension, ratio = weight * length * between(0.5, 30.0), between(5.0, 300.0)
    stiffness, slope = tension * (ratio**2 - 1.0), math.radians(random.uniform(10.0, 80.0))
    force = np.array([[tension * math.cos(slope), 0.0, tension * math.sin(slope) - 0.5 * weight * length]])
    chord = HangingCable(length, stiffness, np.array([0.0, 0.0, -weight])).position(force, np.ones(1))[0, 0]
    frequency = math.sqrt(tension / mass) / (2.0 * length) * between(0.02, 1.0)
    amplitude, angle = length * between(1e-3, 0.1), random.uniform(0.0, 2.0 * math.pi)
    top = Top("fixed")
    if random.integers(2):
        body = tension / _GRAVITY * between(0.1, 3.0)
        hover = tension / length * between(3.0, 100.0)
        damping = 2.0 * between(0.05, 0.7) * math.sqrt(hover * body)
        top = Top("platform", mass=body, hover_stiffness=hover, hover_damping=damping)
    return Scene(
        name=f"random {seed}",
        cable=Cable(
            length,
            "unstretched",
            mass,
            axial_stiffness=stiffness,
            diameter=math.sqrt(4.0 * mass / (1100.0 * math.pi)),
        ),
        geometry=Geometry("ends", top=(float(chord[0]), float(chord[2]))),
        bottom=Bottom(
            "harmonic",
            direction=(math.cos(angle), math.sin(angle)),
            amplitude=amplitude,
            frequency=frequency,
            start="ramp",
            ramp=2.0 / frequency,
        ),
        top=top,
        output=Output(6.0 / frequency, 64.0 * frequency, (0.0, 0.5, 1.0)),
        air=Air(1.225, 1.2, 0.01),
    )


def measure(seed: int) -> Measured | None:
    """Return a random scene's errors; None where it is strained beyond 5 % or has no rest."""
    scene = random_scene(seed)
    try:
        model = run_catenary(scene)
        estimate = quasi_static_error(scene)
        pair = [run_chain(scene, cells) for cells in (_CELLS, 2 * _CELLS)]
    except DataError:
        return None
    if float(np.max(model.tension)) > _STRAIN * (scene.cable.axial_stiffness or 0.0):
        return None
    first, second = (run.tension - run.tension[0] for run in pair)
    slack = any(float(np.min(run.field.minimum)) <= 0.0 for run in pair)
    reference = second if slack else (4.0 * second - first) / 3.0
    dynamic = _size(reference)
    lateral = 3.0 / max(estimate.frequency_ratio, 1e-9)  # w_t / w
    acceleration = (scene.bottom.amplitude or 0.0) * (2.0 * math.pi * (scene.bottom.frequency or 0.0)) ** 2
    return Measured(
        seed,
        estimate,
        _size(model.tension - model.tension[0] - reference) / dynamic,
        _size(second - first) / dynamic / 3.0,
        slack,
        acceleration / (2.0 * _GRAVITY) / abs(1.0 - (3.0 / lateral) ** 2),
    )


def _size(values: FloatArray) -> float:
    """Return the largest gauge's RMS."""
    return math.sqrt(float(np.max(np.mean(values**2, axis=0))))
