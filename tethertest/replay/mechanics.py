"""How a rig's tension answers its bottom motion in closed form, and how well that is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from tethertest.conditioning.rig_priors import UNSTATED_DAMPING_TIME, no_changes
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import PlatformMode
from tethertest.records.rig import Rig
from tethertest.records.run import Run
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver.linear.transfer import ComplexArray, tension_transfer

#: slower motion is answered as at this frequency: the wave number must not vanish [Hz]
SLOWEST = 1e-4
#: changes are told below this [Hz], from a closed form at frequencies this far apart [Hz]: the UAV's bounce
#: is ten times as wide
HIGHEST, APART = 60.0, 0.01
#: relative standard uncertainty of what the rig file states without one
UNSTATED = {
    "cable.length": 0.002,
    "cable.mass_per_length": 0.02,
    "cable.axial_stiffness": 0.02,
    "platform.mass": 0.01,
    "hover_stiffness": 0.05,
    "hover_damping": 0.05,
}
#: everything that the answer depends on; the last two belong to a mode of the platform
PARAMETERS = (
    "cable.length",
    "cable.mass_per_length",
    "cable.axial_stiffness",
    "cable.axial_damping_time",
    "platform.mass",
    "hover_stiffness",
    "hover_damping",
)


def tension_over_motion(run: Run) -> Callable[[float, float], float] | None:
    """Return how large the tension at a place is over the bottom displacement [N/m], by frequency [Hz].

    The returned function takes the frequency and the place as a fraction of the length; None where the
    cable's stiffness is not known or it is slack at rest.
    """
    rig, mode = run.rig, run.file.platform.mode
    if not _answers(rig):
        return None

    def size(frequency: float, place: float) -> float:
        return float(abs(tension_response(rig, mode, np.array([frequency]), place)[0]))

    return size


def tension_changes(run: Run) -> Callable[[FloatArray, float], tuple[FloatArray, ...]]:
    """Return what one standard uncertainty of each parameter changes in the bottom tension.

    The returned function takes the bottom displacement (n,) [m] at uniform times and their step [s], and
    returns one (n,) change [N] per parameter, by differences of the closed form.
    """
    rig, mode = run.rig, run.file.platform.mode
    if not _answers(rig):
        return no_changes

    def changes(height: FloatArray, step: float) -> tuple[FloatArray, ...]:
        from scipy.fft import irfft, next_fast_len, rfft

        size = int(next_fast_len(2 * height.size, real=True))
        # back to where it started along a straight line: the transform is periodic
        bridge = np.linspace(height[-1], height[0], size - height.size + 2)[1:-1]
        spectrum = rfft(np.concatenate((height, bridge)) - height[0])
        frequency = np.fft.rfftfreq(size, step)
        frequency = frequency[frequency <= HIGHEST]
        known = np.arange(0.0, HIGHEST + APART, APART)
        answers = (
            np.interp(frequency, known, _moved_by(rig, mode, name, sigma, known)) * spectrum[: frequency.size]
            for name, sigma in standard_uncertainties(rig, mode).items()
        )
        return tuple(np.asarray(irfft(answer, size)[: height.size], dtype=np.float64) for answer in answers)

    return changes


def tension_response(rig: Rig, mode: str, frequency: FloatArray, place: float) -> ComplexArray:
    """Return the tension at a place over the bottom displacement [N/m] for motion as ``exp(2 pi i f t)``.

    Parameters
    ----------
    rig : Rig
        Cable and platform.
    mode : str
        The platform mode.
    frequency : ndarray
        (n,) [Hz].
    place : float
        Fraction of the length from the bottom.
    """
    loop = rig.platform.modes.get(mode, PlatformMode())
    scene = Scene(
        name=rig.name,
        cable=rig.cable,
        geometry=Geometry(kind="vertical"),
        bottom=Bottom("fixed"),
        top=Top(
            kind="platform",
            mass=rig.platform.mass,
            static_tension=rig.platform.static_tension,
            hover_stiffness=loop.hover_stiffness,
            hover_damping=loop.hover_damping,
        ),
        output=Output(duration=1.0, rate=1.0, gauges=(place,)),
        gravity=rig.gravity,
    )
    return tension_transfer(scene, np.maximum(frequency, SLOWEST), np.array([place]))[:, 0]


def standard_uncertainties(rig: Rig, mode: str) -> dict[str, float]:
    """Return how well each of `PARAMETERS` is known; what is known for certain is absent.

    Parameters
    ----------
    rig : Rig
        Its uncertainties; `UNSTATED` stands in where it has none.
    mode : str
        The platform mode.
    """
    found: dict[str, float] = {}
    for name in PARAMETERS:
        unstated = UNSTATED.get(name, 0.0) * _value(rig, mode, name)
        if name == "cable.axial_damping_time":
            unstated = UNSTATED_DAMPING_TIME
        key = f"platform.modes.{mode}.{name}" if name.startswith("hover_") else name
        sigma = rig.uncertainty.get(key, unstated)
        if sigma > 0.0:
            found[name] = sigma
    return found


def _answers(rig: Rig) -> bool:
    weight = rig.cable.mass_per_length * rig.cable.length * rig.gravity
    return rig.cable.axial_stiffness is not None and rig.platform.static_tension > weight


def _moved_by(rig: Rig, mode: str, name: str, sigma: float, frequency: FloatArray) -> ComplexArray:
    """Return what a standard uncertainty of one parameter changes in the bottom tension's response."""
    value = _value(rig, mode, name)
    below = max(value - sigma, 0.0)
    rise = tension_response(_with(rig, mode, name, value + sigma), mode, frequency, 0.0)
    rise -= tension_response(_with(rig, mode, name, below), mode, frequency, 0.0)
    return np.asarray(sigma * rise / (value + sigma - below))


def _value(rig: Rig, mode: str, name: str) -> float:
    table, _, key = name.rpartition(".")
    record = {"cable": rig.cable, "platform": rig.platform}.get(table)
    if record is None:
        record = rig.platform.modes.get(mode, PlatformMode())
    return float(getattr(record, key) or 0.0)


def _with(rig: Rig, mode: str, name: str, value: float) -> Rig:
    """Return the rig with another value of one parameter."""
    table, _, key = name.rpartition(".")
    changed: dict[str, Any] = {key: value}
    if table == "cable":
        return replace(rig, cable=replace(rig.cable, **changed))
    if table == "platform":
        return replace(rig, platform=replace(rig.platform, **changed))
    loop = replace(rig.platform.modes.get(mode, PlatformMode()), **changed)
    return replace(rig, platform=replace(rig.platform, modes={**rig.platform.modes, mode: loop}))
