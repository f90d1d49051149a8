"""Random scenes over the parameter space that the solver's error statement is meant for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable
from tethertest.records.scene import Accuracy, Bottom, Geometry, Output, Scene, Top
from tethertest.solver.numbers import scene_numbers

#: density of the cables, from which their diameter follows [kg/m^3]
_DENSITY = 1100.0
#: output rows of every record
_ROWS = 2000
#: periods of the drive in a record, and the share of it that the ramp takes
_PERIODS, _RAMP = 6.0, 0.35
#: longest record, in periods of the first natural frequency, but for the fewest periods of the drive
_LONGEST, _FEWEST = 24.0, 2.0
#: largest elastic answer of a cable between fixed ends, over its rest tension
_LARGEST_PULL = 20.0
#: share of the scenes that are upright, inclined, level, hovering and without gravity
_KINDS = (("vertical", 0.3), ("ends", 0.3), ("shallow", 0.15), ("hovering", 0.15), ("straight", 0.1))


def random_scene(seed: int) -> Scene:
    """Return the scene of a seed.

    Length 1 to 500 m, axial over transverse speed 1.3 to 300, bottom amplitude 1e-4 to 0.1 of the length,
    drive 0.01 to 5 first natural frequencies, platform or fixed, wind to 15 m/s in half of them, known
    damping in half. Cables that no rest exists for are drawn again.
    """
    for draw in range(1000):
        generator = np.random.default_rng((seed, draw))
        try:
            return _with_drive(_at_rest(generator, seed), generator)
        except DataError:
            continue
    message = f"no scene found for seed {seed}"
    raise RuntimeError(message)


def _at_rest(generator: np.random.Generator, seed: int) -> Scene:
    def spread(low: float, high: float) -> float:
        return float(math.exp(generator.uniform(math.log(low), math.log(high))))

    kind = str(generator.choice([name for name, _ in _KINDS], p=[share for _, share in _KINDS]))
    length, mass, ratio = spread(1.0, 500.0), spread(0.005, 0.2), spread(1.3, 300.0)
    weight = mass * 9.80665 * length
    tension = weight * spread(1.0, 20.0)
    damping = spread(1e-4, 3e-3) if generator.random() < 0.5 else None
    cable = Cable(
        length,
        "unstretched",
        mass,
        axial_stiffness=tension * (ratio**2 - 1.0),
        diameter=math.sqrt(4.0 * mass / (math.pi * _DENSITY)),
        axial_damping_time=damping,
    )
    platform = kind == "hovering" or (kind in {"vertical", "ends"} and generator.random() < 0.5)
    top = Top("fixed")
    if platform:
        body = mass * length * spread(0.5, 10.0)
        hover = float(generator.choice([0.0, spread(0.02, 1.0)]))
        stiffness = hover * tension / length
        top = Top(
            "platform",
            mass=body,
            hover_stiffness=stiffness,
            hover_damping=2.0 * generator.uniform(0.2, 1.0) * math.sqrt(stiffness * body),
        )
    geometry = Geometry(kind)  # type: ignore[arg-type]
    if kind == "hovering" or (kind == "vertical" and platform):
        top = replace(top, static_tension=tension + weight)
    elif kind in {"vertical", "straight", "shallow"}:
        geometry = replace(geometry, tension=tension)
    else:
        angle = generator.uniform(math.radians(10.0), math.radians(80.0))
        slenderness = 1.0 - (weight * math.cos(angle) / tension) ** 2 / 24.0 + tension / cable.axial_stiffness  # type: ignore[operator]
        chord = length * max(0.5, slenderness)
        geometry = replace(geometry, top=(chord * math.cos(angle), chord * math.sin(angle)))
    air = None
    if generator.random() < 0.7:
        wind = generator.uniform(0.0, 15.0) if generator.random() < 0.5 else 0.0
        air = Air(1.225, 1.2, 0.01, wind)
    return Scene(
        name=f"random {seed}",
        cable=cable,
        geometry=geometry,
        bottom=Bottom("fixed"),
        top=top,
        output=Output(1.0, 1.0, (0.0, 0.5, 1.0)),
        air=air,
        accuracy=Accuracy(0.01),
    )


def _with_drive(scene: Scene, generator: np.random.Generator) -> Scene:
    first = scene_numbers(scene).first_transverse
    ratio = math.exp(generator.uniform(math.log(0.01), math.log(5.0)))
    amplitude = scene.cable.length * math.exp(generator.uniform(math.log(1e-4), math.log(0.1)))
    upright = scene.geometry.kind in {"vertical", "straight"}
    stiffness = scene.cable.axial_stiffness or 1.0
    if scene.top.kind == "fixed" and (upright or scene.geometry.kind == "shallow"):
        rest = scene.geometry.tension or 1.0
        amplitude = min(amplitude, _LARGEST_PULL * rest / stiffness * scene.cable.length)
    frequency = ratio * first
    duration = min(_PERIODS / frequency, max(_LONGEST / first, _FEWEST / frequency))
    direction = "tangent" if upright else str(generator.choice(["tangent", "vertical"]))
    bottom = Bottom(
        "harmonic",
        direction,  # type: ignore[arg-type]
        amplitude=amplitude,
        frequency=frequency,
        start="ramp",
        ramp=_RAMP * duration,
    )
    output = replace(scene.output, duration=duration, rate=_ROWS / duration)
    return replace(scene, bottom=bottom, output=output)
