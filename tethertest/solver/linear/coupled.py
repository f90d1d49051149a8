"""The paper's linear cable about its equilibrium: uniform tension and curvature couple its two motions.

With the forces over mass per length ``q1 = c1^2 eps1``, ``q2 = ct^2 eps2`` and the state
``y = (u1, u2, q1, q2)`` the equations (30)-(33) are ``y' = M(s) y`` with a constant matrix, ``s`` the Laplace
variable (``i w`` on the frequency axis).

References
----------
Tao & Zhang, Drones 2022, 6(11), 349, equations (30)-(33); Irvine & Caughey, Proc. R. Soc. Lond. A 341 (1974).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.statics.rest import rest_state

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class CoupledCable:
    """A cable about an equilibrium of uniform tension and curvature; lengths are those of equilibrium."""

    length: float  #: [m]
    mass_per_length: float  #: [kg/m]
    tension: float  #: P [N]
    axial_stiffness: float  #: EA [N], of the unstretched cable
    curvature: float  #: [1/m], the normal points to its centre
    axial_damping_time: float = 0.0  #: t_d of T = EA (e + t_d de/dt) [s]
    tangential_damping: float = 0.0  #: viscous force over mass and velocity along the cable [1/s]
    normal_damping: float = 0.0  #: the same across it [1/s]

    @property
    def axial_square(self) -> float:
        """``c1^2 = (EA + P)/rl`` [m^2/s^2]."""
        return (self.axial_stiffness + self.tension) / self.mass_per_length

    @property
    def transverse_square(self) -> float:
        """``ct^2 = P/rl`` [m^2/s^2]."""
        return self.tension / self.mass_per_length

    @property
    def axial_speed(self) -> float:
        """``c1`` [m/s]."""
        return math.sqrt(self.axial_square)

    @property
    def transverse_speed(self) -> float:
        """``ct`` [m/s]."""
        return math.sqrt(self.transverse_square)

    @property
    def stretch(self) -> float:
        """Equilibrium over unstretched length."""
        return 1.0 + self.tension / self.axial_stiffness


@dataclass(frozen=True, slots=True)
class EndBody:
    """A body at the top under a constant force, with a linear position loop; axes (tangent, normal)."""

    mass: float  #: [kg]
    stiffness: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0))  #: [N/m]
    damping: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0))  #: [N s/m]


def coupled_cable(scene: Scene) -> CoupledCable:
    """Return the linear cable of a shallow or straight scene. Air drag is quadratic and takes no part.

    Raises
    ------
    DataError
        The geometry has no uniform tension, or its tension is missing.
    """
    if scene.geometry.kind not in {"shallow", "straight"}:
        message = (
            f"scene {scene.name!r}: geometry {scene.geometry.kind!r} has no uniform tension and curvature"
        )
        raise DataError(message, 'set [geometry] kind = "shallow" or "straight", or use the nonlinear model')
    rest = rest_state(scene)  # without weight along the cable in both geometries
    stretch = 1.0 + rest.bottom_tension / rest.axial_stiffness
    mass = rest.mass_per_length / stretch
    gravity = scene.gravity if scene.geometry.kind == "shallow" else 0.0
    return CoupledCable(
        length=rest.length * stretch,
        mass_per_length=mass,
        tension=rest.bottom_tension,
        axial_stiffness=rest.axial_stiffness,
        curvature=mass * gravity / rest.bottom_tension,
        axial_damping_time=scene.cable.axial_damping_time or 0.0,
    )


def end_angle(scene: Scene, cable: CoupledCable, fraction: float) -> float:
    """Return the angle of the tangent above the horizontal [rad] at a fraction of the length from the bottom.

    The chord of a shallow cable is level, and its shape an arc; a straight cable stands upright.
    """
    if scene.geometry.kind == "straight":
        return 0.5 * math.pi
    return (fraction - 0.5) * cable.curvature * cable.length


def local_direction(scene: Scene, cable: CoupledCable) -> tuple[float, float]:
    """Return the (tangent, normal) components of the unit vector along which the bottom moves.

    What moves across the plane is left to `tethertest.solver.linear.axial_waves.out_of_plane_slope`.

    Raises
    ------
    DataError
        The direction has no length, or is not along a straight cable.
    """
    direction = scene.bottom.direction
    if direction == "tangent":
        return 1.0, 0.0
    if scene.geometry.kind == "straight":
        message = (
            f"scene {scene.name!r}: bottom motion {direction!r}, but a straight cable has no set inclination"
        )
        raise DataError(message, 'set [bottom] direction = "tangent"')
    named = {"vertical": (0.0, 1.0), "horizontal": (1.0, 0.0)}
    vector = named[direction] if isinstance(direction, str) else direction
    horizontal, vertical = float(vector[0]), float(vector[-1])
    size = math.sqrt(sum(component**2 for component in vector))
    if size == 0.0:
        message = f"scene {scene.name!r}: bottom motion along a vector without length"
        raise DataError(message, 'give [bottom] direction a component, for instance "tangent"')
    angle = end_angle(scene, cable, 0.0)
    cosine, sine = math.cos(angle), math.sin(angle)
    return (horizontal * cosine + vertical * sine) / size, (vertical * cosine - horizontal * sine) / size


def end_body(scene: Scene, cable: CoupledCable) -> EndBody | None:
    """Return the body at the top of a scene in the cable's own directions there; None if the top is fixed."""
    if scene.top.kind == "fixed":
        return None
    angle = end_angle(scene, cable, 1.0)
    return EndBody(
        scene.top.mass or 0.0,
        _turned(scene.top.hover_stiffness, angle),
        _turned(scene.top.hover_damping, angle),
    )


def _turned(
    value: float | tuple[float, ...], angle: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    along, up = (value, value) if isinstance(value, float | int) else (float(value[0]), float(value[-1]))
    cosine, sine = math.cos(angle), math.sin(angle)
    mixed = (up - along) * cosine * sine
    return (
        (along * cosine**2 + up * sine**2, mixed),
        (mixed, along * sine**2 + up * cosine**2),
    )


def system_matrix(cable: CoupledCable, s: ComplexArray) -> ComplexArray:
    """Return ``M`` of ``y' = M y``, ``y = (u1, u2, q1, q2)``.

    Parameters
    ----------
    cable : CoupledCable
    s : (n,) complex128
        Laplace variable [1/s].

    Returns
    -------
    (n, 4, 4) complex128
    """
    s = np.asarray(s, dtype=np.complex128)
    axial, transverse, along, across = coefficients(cable, s)
    matrix = np.zeros((s.size, 4, 4), dtype=np.complex128)
    matrix[:, 0, 1] = matrix[:, 2, 3] = cable.curvature
    matrix[:, 1, 0] = matrix[:, 3, 2] = -cable.curvature
    matrix[:, 0, 2] = 1.0 / axial
    matrix[:, 1, 3] = 1.0 / transverse
    matrix[:, 2, 0] = along
    matrix[:, 3, 1] = across
    return matrix


def coefficients(
    cable: CoupledCable, s: ComplexArray
) -> tuple[ComplexArray, float, ComplexArray, ComplexArray]:
    """Return ``c1^2 (1 + s t_d)``, ``ct^2``, ``s (s + b1)`` and ``s (s + b2)``."""
    axial = cable.axial_square * (1.0 + s * cable.axial_damping_time)
    return axial, cable.transverse_square, s * (s + cable.tangential_damping), s * (s + cable.normal_damping)


def wave_number_squares(cable: CoupledCable, s: ComplexArray) -> ComplexArray:
    """Return the two ``mu^2`` of the waves ``exp(+-mu x)``, the larger in magnitude first.

    On the frequency axis ``mu^2 = -k^2``, and this is the dispersion relation of the infinite cable.

    Parameters
    ----------
    cable : CoupledCable
    s : (n,) complex128
        Laplace variable [1/s], not zero.

    Returns
    -------
    (2, n) complex128
        [1/m^2].
    """
    axial, transverse, along, across = coefficients(cable, np.asarray(s, dtype=np.complex128))
    bend = cable.curvature**2
    total = along / axial + across / transverse - 2.0 * bend
    product = (along + bend * transverse) * (across + bend * axial) / (axial * transverse)
    root = np.sqrt(total**2 - 4.0 * product)
    root = np.where((total.conj() * root).real < 0.0, -root, root)
    larger = 0.5 * (total + root)
    return np.stack([larger, product / larger])


def undamped_transfer(cable: CoupledCable, angular: FloatArray, station: FloatArray | float) -> FloatArray:
    """Return ``exp(M x)`` of the cable without damping, in closed form and real.

    No basis of waves is needed, so nothing is singular at the cut-offs ``kappa ct`` and ``kappa c1``.

    Parameters
    ----------
    cable : CoupledCable
    angular : (n,) float64
        [rad/s], above zero.
    station : (n,) float64 or float
        x [m].

    Returns
    -------
    (n, 4, 4) float64
        Takes the state at 0 to the state at x.

    Notes
    -----
    Cayley-Hamilton: ``exp(M x) = ((M^2 - b)(Ca + Sa M) - (M^2 - a)(Cb + Sb M))/(a - b)`` for the squares a, b
    of the wave numbers, ``C = cosh(sqrt(a) x)``, ``S = sinh(sqrt(a) x)/sqrt(a)``; a and b are real and apart.
    """
    frequency = np.atleast_1d(np.asarray(angular, dtype=np.float64))
    axial, transverse, bend = cable.axial_square, cable.transverse_square, cable.curvature**2
    square = frequency**2
    total = -square / axial - square / transverse - 2.0 * bend
    product = (square - bend * transverse) * (square - bend * axial) / (axial * transverse)
    spread = np.sqrt(
        (square / axial - square / transverse) ** 2 + 8.0 * square * bend * (1 / axial + 1 / transverse)
    )
    larger = 0.5 * (total - spread)
    smaller = product / larger
    matrix = np.zeros((frequency.size, 4, 4))
    matrix[:, 0, 1] = matrix[:, 2, 3] = cable.curvature
    matrix[:, 1, 0] = matrix[:, 3, 2] = -cable.curvature
    matrix[:, 0, 2] = 1.0 / axial
    matrix[:, 1, 3] = 1.0 / transverse
    matrix[:, 2, 0] = matrix[:, 3, 1] = -square
    squared = matrix @ matrix
    one = np.eye(4)
    parts = []
    for own, other in ((larger, smaller), (smaller, larger)):
        even, odd = _even_odd(own, station)
        factor = squared - other[:, None, None] * one
        parts.append(factor @ (even[:, None, None] * one + odd[:, None, None] * matrix))
    return np.asarray((parts[0] - parts[1]) / (larger - smaller)[:, None, None])


def _even_odd(square: FloatArray, station: FloatArray | float) -> tuple[FloatArray, FloatArray]:
    """Return ``cosh(m x)`` and ``sinh(m x)/m`` for ``m^2 = square`` of either sign."""
    size = np.sqrt(np.abs(square))
    phase = size * station
    safe = np.where(phase > 0.0, phase, 1.0)
    wave = square < 0.0
    grown = np.where(wave, 0.0, phase)
    even = np.where(wave, np.cos(phase), np.cosh(grown))
    ratio = np.where(wave, np.sin(phase), np.sinh(grown)) / safe
    return even, np.where(phase > 0.0, ratio, 1.0) * station
