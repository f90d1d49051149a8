"""The dimensionless numbers of a scene that choose its model and its coarsest mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.modal.chain_modes import lowest_frequencies
from tethertest.solver.motion import displacement

#: orders of a crank's turn that matter
_CRANK_ORDERS = 3.0
#: share of the squared velocity of a measured motion that lies below its highest frequency
_MOST_OF_THE_POWER = 0.995
#: samples in which a measured motion is looked at
_SAMPLES = 4096


@dataclass(frozen=True, slots=True)
class SceneNumbers:
    """Frequencies [Hz] and their ratios."""

    first_transverse: float  #: lowest natural frequency across the cable, between held ends
    first_axial: float  #: lowest natural frequency along the cable, with the body on top
    highest_drive: float  #: highest frequency of the bottom motion that matters; 0 without one

    @property
    def drive_over_first(self) -> float:
        """Highest drive frequency over the first transverse natural frequency."""
        return self.highest_drive / self.first_transverse

    @property
    def drive_over_axial(self) -> float:
        """Highest drive frequency over the first axial natural frequency."""
        return self.highest_drive / self.first_axial


def scene_numbers(scene: Scene, measured: MeasuredMotion | None = None) -> SceneNumbers:
    """Return the numbers of a scene.

    Raises
    ------
    DataError
        The scene has no rest.
    """
    transverse, axial = lowest_frequencies(scene)
    return SceneNumbers(transverse, axial, highest_drive(scene, measured))


def highest_drive(scene: Scene, measured: MeasuredMotion | None = None) -> float:
    """Return the highest frequency of the bottom motion that matters [Hz]; 0 for a step or a fixed end."""
    bottom = scene.bottom
    if bottom.motion == "measured":
        time = np.linspace(0.0, scene.output.duration, _SAMPLES)
        speed = np.gradient(displacement(bottom, time, measured), time)
        power = np.cumsum(np.abs(np.fft.rfft(speed * np.hanning(_SAMPLES))) ** 2)
        if power[-1] == 0.0:
            return 0.0
        return float(np.searchsorted(power, _MOST_OF_THE_POWER * power[-1]) / scene.output.duration)
    orders = _CRANK_ORDERS if bottom.motion == "crank-slider" else 1.0
    return orders * (bottom.frequency or 0.0)
