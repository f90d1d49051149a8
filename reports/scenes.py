"""Scenes that several reports run: the shipped files, and those whose figures are known from elsewhere."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.statics.catenary_shape import ElasticCatenary

#: the scene files that come with the tool
SHIPPED = Path(__file__).parents[1] / "rigs" / "scenes"
#: drag of a cable in air, normal and tangential
_AIR = Air(1.225, 1.2, 0.01)
_GRAVITY = 9.81


def condition(
    frequency: float = 0.18, *, amplitude: float = 2.0, duration: float = 67.5, rate: float = 30.0
) -> Scene:
    """Return the article's condition 1.1 with a ramped start, gauges at both ends."""
    return Scene(
        name=f"condition 1.1, {frequency:g} Hz, {amplitude:g} m",
        cable=Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=0.003),
        geometry=Geometry("shallow", tension=80.0),
        bottom=Bottom("harmonic", amplitude=amplitude, frequency=frequency, start="ramp", ramp=10.0),
        top=Top("fixed"),
        output=Output(duration, rate, (0.0, 1.0)),
        gravity=_GRAVITY,
    )


def condition_upright(frequency: float) -> Scene:
    """Return the cable of condition 1.1 hung vertically with 80 N at the bottom."""
    flat = condition(frequency)
    cable = Cable(149.164, "unstretched", 0.03352, axial_stiffness=120.17)
    return replace(
        flat, name="condition 1.1 upright", cable=cable, geometry=Geometry("vertical", tension=80.0)
    )


def prototype(degrees: float, tension: float = 50.0, amplitude: float = 2.0) -> Scene:
    """Return the 150 m tether in air, driven along itself at 0.2 Hz.

    Parameters
    ----------
    degrees : float
        Its chord above the level.
    tension : float
        At mid-length, at rest [N].
    amplitude : float
        [m].
    """
    weight, angle = 0.0484 * _GRAVITY, math.radians(degrees)

    def chord(pull: float) -> np.ndarray:
        force = tension * np.array([math.cos(pull), math.sin(pull)]) - [0.0, 0.5 * weight * 150.0]
        load = np.array([0.0, -weight])
        return np.asarray(ElasticCatenary(150.0, 10020.0, load, force).position(np.array([150.0]))[0])

    def too_steep(pull: float) -> float:
        end = chord(pull)
        return math.atan2(end[1], end[0]) - angle

    end = chord(float(brentq(too_steep, -1.5, 1.55, xtol=1e-14)))
    return Scene(
        name=f"150 m at {degrees:g} degrees, {tension:g} N at mid-length",
        cable=Cable(150.0, "unstretched", 0.0484, axial_stiffness=10020.0, diameter=0.006),
        geometry=Geometry("ends", top=(float(end[0]), float(end[1]))),
        bottom=Bottom("harmonic", amplitude=amplitude, frequency=0.2, start="ramp", ramp=10.0),
        top=Top("fixed"),
        output=Output(40.0, 100.0, (0.0, 1.0)),
        air=_AIR,
        gravity=_GRAVITY,
    )


def snap() -> Scene:
    """Return the 150 m vertical tether that goes slack, undamped and without air; gauge at the top."""
    return replace(
        prototype(45.0),
        name="vertical snap",
        geometry=Geometry("vertical", tension=50.0),
        air=None,
        output=Output(40.0, 1000.0, (1.0,)),
        gravity=9.80665,
    )


def rig(mass: float = 0.4, damping_time: float | None = None) -> Scene:
    """Return the 3 m rig with a platform of some mass under 5 N, heaved by 0.1 m at 0.3 Hz."""
    return Scene(
        name=f"3 m rig, {mass:g} kg",
        cable=Cable(
            3.0,
            "unstretched",
            0.0484,
            axial_stiffness=10020.0,
            axial_damping_time=damping_time,
            diameter=0.006,
        ),
        geometry=Geometry("vertical"),
        bottom=Bottom("harmonic", amplitude=0.1, frequency=0.3, start="ramp", ramp=5.0),
        top=Top("platform", mass=mass, static_tension=5.0),
        output=Output(30.0, 200.0, (0.0, 1.0)),
        gravity=_GRAVITY,
    )
