"""Natural frequencies of any scene about its rest, by name."""

from __future__ import annotations

from tethertest.records.arrays import FloatArray
from tethertest.records.response import Modes, NaturalFrequency
from tethertest.records.scene import Scene
from tethertest.solver.modal.chain_modes import bowed_frequencies, upright_frequencies
from tethertest.solver.modal.coupled_modes import coupled_modes
from tethertest.solver.terms import per_direction


def modes(scene: Scene, count: int = 3) -> Modes:
    """Return the lowest natural frequencies about rest in the steady wind.

    Parameters
    ----------
    scene : Scene
        Any geometry.
    count : int
        How many of each kind.

    Returns
    -------
    Modes
        "axial" and "lateral" of a cable that stands upright ("vertical", "straight"); the lowest lateral mode
        of a body that is free sideways is named "pendulum". "in-plane" and "out-of-plane" of any other: of
        "shallow" from the paper's linear cable, of uniform tension and curvature, else from the chain.

    Raises
    ------
    DataError
        The scene has no rest; see `rest_chain`.
    """
    kind = scene.geometry.kind
    if kind == "shallow":
        return coupled_modes(scene, count)
    upright = upright_frequencies(scene, count) if kind in {"vertical", "straight"} else None
    if upright is None:
        inside, outside = bowed_frequencies(scene, count)
        return Modes((*_named("in-plane", inside), *_named("out-of-plane", outside)))
    axial, lateral = upright
    if scene.top.kind == "fixed" or per_direction(scene.top.hover_stiffness)[0] > 0.0:
        return Modes((*_named("axial", axial), *_named("lateral", lateral)))
    pendulum = NaturalFrequency("pendulum", float(lateral[0]))
    return Modes((*_named("axial", axial), pendulum, *_named("lateral", lateral[1:])))


def _named(name: str, frequencies: FloatArray) -> tuple[NaturalFrequency, ...]:
    return tuple(
        NaturalFrequency(f"{name} {number}", float(frequency))
        for number, frequency in enumerate(frequencies, start=1)
    )
