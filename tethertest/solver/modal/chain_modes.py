"""Natural frequencies of the chain about its rest: elastic and geometric stiffness, bending, body on top.

The chain moves about its rest in the steady wind; what the air's drag adds in stiffness and damping takes no
part. A cell of tangent t, tension T and stretch 1 + e resists with ``EA/h`` along t and ``T/(h (1 + e))``
across it. Frequencies of two meshes are extrapolated: they approach the continuous cable's with the square
of the cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.scene import Scene
from tethertest.solver.statics.equilibrium import RestChain, rest_chain
from tethertest.solver.terms import per_direction

#: cells of the coarser of two meshes, and at least so many per frequency asked for
_CELLS, _CELLS_PER_MODE = 80, 12
#: cells for an estimate: the first frequency is then within 0.1 %
_FEW_CELLS = 24
#: deviation from a line or plane, relative to the largest, that is none
_NONE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class LinearChain:
    """A chain for small motions about rest, in d directions; the nodes above the bottom one that move."""

    link: FloatArray  #: (n, d, d) stiffness of the cells [N/m]
    mass: FloatArray  #: (m,) of the nodes that move, n with a body on top, else n - 1 [kg]
    hold: FloatArray  #: (d, d) stiffness of the position loop at the upper end [N/m]
    bending: float  #: ``EI/h^3`` [N/m]

    def along(self, axes: FloatArray) -> LinearChain:
        """Return the chain that moves along the rows of axes (c, d) alone."""
        return LinearChain(axes @ self.link @ axes.T, self.mass, axes @ self.hold @ axes.T, self.bending)

    def squares(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest squared angular frequencies (k,) and shapes (k, m, d) of equal kinetic energy.

        k is ``count``, or as many as the chain has.
        """
        from scipy.linalg import eig_banded

        d, moving, n = self.link.shape[1], self.mass.size, self.link.shape[0]
        width = 2 * d if self.bending > 0.0 else 2 * d - 1
        band = np.zeros((width + 1, d * moving))
        own = self.link[:moving].copy()
        own[: n - 1] += self.link[1 : moving + 1]
        if moving == n:
            own[-1] += self.hold
        for row in range(d):
            for column in range(d):
                if row >= column:
                    band[row - column, column::d] += own[:, row, column]
                band[d + row - column, column:-d:d] -= self.link[1:moving, row, column]
        if self.bending > 0.0:
            hinged = np.zeros(n + 3)
            hinged[2:-2] = self.bending
            low, mid, high = hinged[1 : moving + 1], hinged[2 : moving + 2], hinged[3 : moving + 3]
            for column in range(d):
                band[0, column::d] += low + 4.0 * mid + high
                band[d, column:-d:d] -= 2.0 * (mid + high)[:-1]
                band[2 * d, column : -2 * d : d] += high[:-2]
        root = np.repeat(np.sqrt(self.mass), d)
        for offset in range(width + 1):
            kept = root.size - offset
            band[offset, :kept] /= root[:kept] * root[offset:]
        last = min(count, root.size) - 1
        squares, vectors = eig_banded(band, lower=True, select="i", select_range=(0, last))
        return np.asarray(np.maximum(squares, 0.0)), np.asarray(vectors.T.reshape(-1, moving, d))


def linear_chain(scene: Scene, rest: RestChain) -> LinearChain:
    """Return a scene's chain at rest for small motions along x, y, z."""
    free = scene.top.kind == "platform"
    n, tension = rest.force.shape[0], rest.tension
    along = rest.force / tension[:, None]
    across = (tension / (1.0 + tension / rest.stiffness))[:, None, None]
    axial = along[:, :, None] * along[:, None, :]
    mass = np.full(n if free else n - 1, rest.mass * rest.cell)
    if free:
        mass[-1] = 0.5 * rest.mass * rest.cell + (scene.top.mass or 0.0)
    return LinearChain(
        link=np.asarray((rest.stiffness * axial + across * (np.eye(3) - axial)) / rest.cell),
        mass=mass,
        hold=np.diag(per_direction(scene.top.hover_stiffness)),
        bending=scene.cable.bending_stiffness / rest.cell**3,
    )


def upright_frequencies(scene: Scene, count: int) -> tuple[FloatArray, FloatArray] | None:
    """Return the axial and the lateral (along x) frequencies [Hz] of a cable that stands upright, else None.

    Raises
    ------
    DataError
        As `rest_chain`.
    """

    def both(chain: LinearChain) -> tuple[FloatArray, FloatArray]:
        axes = np.eye(3)
        return _frequencies(chain.along(axes[2:]), count), _frequencies(chain.along(axes[:1]), count)

    rest = rest_chain(scene, 2)
    if float(np.max(np.abs(rest.force[:, :2]))) > _NONE * float(np.max(rest.tension)):
        return None
    return _extrapolated(scene, count, lambda rest: both(linear_chain(scene, rest)))


def bowed_frequencies(scene: Scene, count: int) -> tuple[FloatArray, FloatArray]:
    """Return the in-plane and the out-of-plane frequencies (count,) [Hz], each ascending.

    The plane is the upright one through the ends. Where side wind bows the cable out of it, or the position
    loop ties both, a mode belongs to where most of its kinetic energy is.

    Raises
    ------
    DataError
        As `rest_chain`.
    """

    def both(rest: RestChain) -> tuple[FloatArray, FloatArray]:
        axes = plane_axes(rest)
        chain = linear_chain(scene, rest).along(axes)
        tied = np.abs(chain.link[:, 2, :2]).max() > _NONE * chain.link.max()
        if tied or np.abs(chain.hold[2, :2]).max() > _NONE * max(1e-300, chain.hold.max()):
            return _sorted_apart(chain, count)
        one = np.eye(3)
        return _frequencies(chain.along(one[:2]), count), _frequencies(chain.along(one[2:]), count)

    return _extrapolated(scene, count, both)


def lowest_frequencies(scene: Scene) -> tuple[float, float]:
    """Return the first transverse and the first axial frequency [Hz]: an estimate for choosing a model.

    The transverse one is the cable's own, out of its plane between held ends, which no sag raises and no
    position loop lowers: 0.1 %. The axial one is that of the cable laid straight, with the body and its
    position loop on top.

    Raises
    ------
    DataError
        As `rest_chain`.
    """
    rest = rest_chain(scene, _FEW_CELLS)
    body = linear_chain(scene, rest)
    string = rest.tension / (1.0 + rest.tension / rest.stiffness) / rest.cell
    across = LinearChain(string[:, None, None], body.mass[: _FEW_CELLS - 1], np.zeros((1, 1)), body.bending)
    tangent = rest.end_force[None] / float(np.linalg.norm(rest.end_force))
    straight = LinearChain(
        link=np.full((_FEW_CELLS, 1, 1), rest.stiffness / rest.cell),
        mass=body.mass,
        hold=tangent @ body.hold @ tangent.T,
        bending=0.0,
    )
    return float(_frequencies(across, 1)[0]), float(_frequencies(straight, 1)[0])


def plane_axes(rest: RestChain) -> FloatArray:
    """Return the unit vectors (3, 3) level in the plane of the ends, upwards, and across the plane.

    A chain whose ends lie one above the other has the plane of its largest distance from that line; one that
    is upright has the plane of x and z.
    """
    level = rest.nodes[-1, :2]
    size = float(np.linalg.norm(rest.nodes[-1]))
    if float(np.linalg.norm(level)) <= _NONE * size:
        distance = np.linalg.norm(rest.nodes[:, :2], axis=1)
        furthest = int(np.argmax(distance))
        level = rest.nodes[furthest, :2] if distance[furthest] > _NONE * size else np.array([1.0, 0.0])
    x, y = level / float(np.linalg.norm(level))
    return np.array([[x, y, 0.0], [0.0, 0.0, 1.0], [-y, x, 0.0]])


def _frequencies(chain: LinearChain, count: int) -> FloatArray:
    return np.asarray(np.sqrt(chain.squares(count)[0]) / (2.0 * np.pi))


def _sorted_apart(chain: LinearChain, count: int) -> tuple[FloatArray, FloatArray]:
    """Return the frequencies of modes within the first two directions and across them."""
    wanted = 2 * count
    while True:
        squares, shapes = chain.squares(wanted)
        energy = np.sum(shapes**2, axis=1)
        outside: BoolArray = energy[:, 2] > 0.5 * np.sum(energy, axis=1)
        found = min(int(np.sum(outside)), int(np.sum(~outside)))
        if found >= count or squares.size < wanted:
            frequencies = np.sqrt(squares) / (2.0 * np.pi)
            return np.asarray(frequencies[~outside][:count]), np.asarray(frequencies[outside][:count])
        wanted *= 2


def _extrapolated(
    scene: Scene, count: int, both: Callable[[RestChain], tuple[FloatArray, FloatArray]]
) -> tuple[FloatArray, FloatArray]:
    """Return two lists of frequencies on cells of size zero, from two meshes."""
    cells = max(_CELLS, _CELLS_PER_MODE * count)
    coarse, fine = both(rest_chain(scene, cells)), both(rest_chain(scene, 2 * cells))
    first, second = ((4.0 * f - c) / 3.0 for c, f in zip(coarse, fine, strict=True))
    return first, second
