"""The rig as a uniform elastic bar in closed form: how far a tension moves with what is not known."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import numpy.typing as npt

from tethertest.records.arrays import FloatArray
from tethertest.records.cable import PlatformMode
from tethertest.records.rig import Rig

#: slower motion is answered as at this frequency: the wave number must not vanish [Hz]
SLOWEST = 1e-4
#: changes are told below this [Hz], from a closed form at frequencies this far apart [Hz]: the UAV's bounce
#: is ten times as wide
HIGHEST, APART = 60.0, 0.01
#: relative standard uncertainty of what the rig file states without one
UNSTATED = {
    "length": 0.002,
    "mass_per_length": 0.02,
    "axial_stiffness": 0.02,
    "mass": 0.01,
    "hover_stiffness": 0.05,
    "hover_damping": 0.05,
}
#: standard uncertainty of a damping time that the rig file does not state one for [s]
UNSTATED_DAMPING_TIME = 5e-4


@dataclass(frozen=True, slots=True)
class Bar:
    """A vertical cable below a mass in a position loop, about its rest state."""

    length: float  #: [m]
    mass_per_length: float  #: [kg/m]
    axial_stiffness: float  #: EA [N]
    axial_damping_time: float  #: Kelvin-Voigt [s]
    mass: float  #: [kg]
    hover_stiffness: float  #: [N/m]
    hover_damping: float  #: [N s/m]

    @staticmethod
    def of(rig: Rig, mode: str) -> Bar | None:
        """Return the bar of a rig in one of its platform modes; None where its stiffness is not known."""
        cable, loop = rig.cable, rig.platform.modes.get(mode, PlatformMode())
        if cable.axial_stiffness is None:
            return None
        return Bar(
            cable.length,
            cable.mass_per_length,
            cable.axial_stiffness,
            cable.axial_damping_time or 0.0,
            rig.platform.mass,
            loop.hover_stiffness,
            loop.hover_damping,
        )


def standard_uncertainties(rig: Rig, mode: str, bar: Bar) -> dict[str, float]:
    """Return how well each parameter of the bar is known, by its name; what is known for certain is absent.

    Parameters
    ----------
    rig : Rig
        Its uncertainties; `UNSTATED` stands in where it has none.
    mode : str
        The platform mode.
    bar : Bar
        The rig as a bar.
    """
    found: dict[str, float] = {}
    for name in (item.name for item in fields(Bar)):
        key = _key(name, mode)
        unstated = UNSTATED_DAMPING_TIME if name == "axial_damping_time" else None
        if unstated is None:
            unstated = UNSTATED[name] * getattr(bar, name)
        sigma = rig.uncertainty.get(key, unstated)
        if sigma > 0.0:
            found[name] = sigma
    return found


def _key(name: str, mode: str) -> str:
    if name == "mass":
        return "platform.mass"
    place = f"platform.modes.{mode}" if name.startswith("hover_") else "cable"
    return f"{place}.{name}"


def bottom_tension_over_motion(
    bar: Bar, frequency: FloatArray, place: float = 0.0
) -> npt.NDArray[np.complex128]:
    """Return tension over bottom displacement [N/m] for motion as ``exp(2 pi i f t)``.

    Parameters
    ----------
    bar : Bar
        The rig.
    frequency : ndarray
        (n,) [Hz].
    place : float
        Fraction of the length from the bottom.

    Notes
    -----
    ``E' u'' + m w^2 u = 0`` with ``E' = EA (1 + i w t_d)``, u = 1 at the bottom and, at the top,
    ``E' u' = -(k - M w^2 + i w c) u``.
    """
    omega = 2.0 * np.pi * np.maximum(frequency, SLOWEST)
    modulus = bar.axial_stiffness * (1.0 + 1j * omega * bar.axial_damping_time)
    wavenumber = omega * np.sqrt(bar.mass_per_length / modulus)
    force = modulus * wavenumber
    end = bar.hover_stiffness - bar.mass * omega**2 + 1j * omega * bar.hover_damping
    sine, cosine = np.sin(wavenumber * bar.length), np.cos(wavenumber * bar.length)
    odd = (force * sine - end * cosine) / (force * cosine + end * sine)
    angle = wavenumber * (place * bar.length)
    response = force * (odd * np.cos(angle) - np.sin(angle))
    return np.asarray(response, dtype=np.complex128)


def tension_changes(
    bar: Bar, uncertainties: dict[str, float], height: FloatArray, step: float
) -> tuple[FloatArray, ...]:
    """Return what one standard uncertainty of each parameter changes in the bottom tension.

    Parameters
    ----------
    bar : Bar
        The rig.
    uncertainties : dict
        Parameter -> standard uncertainty, as `standard_uncertainties` gives them.
    height : ndarray
        (n,) bottom displacement [m] at uniform times.
    step : float
        Between them [s].

    Returns
    -------
    tuple of ndarray
        One (n,) change [N] per parameter, by differences of the closed form.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    size = int(next_fast_len(2 * height.size, real=True))
    # back to where it started along a straight line: the transform is periodic
    bridge = np.linspace(height[-1], height[0], size - height.size + 2)[1:-1]
    spectrum = rfft(np.concatenate((height, bridge)) - height[0])
    frequency = np.fft.rfftfreq(size, step)
    frequency = frequency[frequency <= HIGHEST]
    known = np.arange(0.0, HIGHEST + APART, APART)
    responses = []
    for name, sigma in uncertainties.items():
        value = getattr(bar, name)
        below = max(value - sigma, 0.0)
        rise = bottom_tension_over_motion(replace(bar, **{name: value + sigma}), known)
        rise -= bottom_tension_over_motion(replace(bar, **{name: below}), known)
        responses.append(sigma * rise / (value + sigma - below))
    answers = (np.interp(frequency, known, response) * spectrum[: frequency.size] for response in responses)
    return tuple(np.asarray(irfft(answer, size)[: height.size], dtype=np.float64) for answer in answers)
