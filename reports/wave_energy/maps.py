"""Tension over time and place from the article's start, how much of it stands, and where it is largest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from reports.wave_energy.cases import started
from tethertest.records.arrays import FloatArray
from tethertest.solver import solve
from tethertest.solver.statics.equilibrium import rest_tension

Model = Literal["printed", "linear", "exact"]
MODELS: Final[dict[Model, str]] = {
    "printed": "the article's scheme as printed (its axial wave runs at the transverse speed)",
    "linear": "the article's equations, each wave at its own speed",
    "exact": "the geometrically exact cable",
}
#: meshes of the models; `TensionMap` of half the mesh tells the error
CELLS: Final[dict[Model, int]] = {"printed": 110, "linear": 110, "exact": 160}
#: places that count as the middle of the cable, fractions of its length
MIDDLE: Final = (0.1, 0.9)


@dataclass(frozen=True, slots=True, eq=False)
class TensionMap:
    """Dynamic tension over time and place."""

    frequency: float  #: of the drive [Hz]
    model: Model
    time: FloatArray  #: (n,) [s]
    place: FloatArray  #: (m,) fraction of the length from the bottom
    tension: FloatArray  #: (n, m) [N], that of rest taken off


@dataclass(frozen=True, slots=True)
class Largest:
    """Where and when tension is largest."""

    place: float  #: fraction of the length from the bottom
    time: float  #: [s]
    phase: float  #: periods of the drive since the bottom last went up through its middle
    value: float  #: dynamic [N]
    middle: float  #: the same over `MIDDLE` alone [N]
    bottom: float  #: largest at the bottom [N]
    top: float  #: largest at the top [N]

    @property
    def middle_over_ends(self) -> float:
        """Largest in the middle over the largest at either end."""
        return self.middle / max(self.bottom, self.top)


def started_map(frequency: float, model: Model, cells: int | None = None) -> TensionMap:
    """Return the map of condition 1.1 over the article's record.

    Parameters
    ----------
    frequency : float
        [Hz].
    model : {"printed", "linear", "exact"}
        `MODELS` says what they are.
    cells : int, optional
        Another mesh than that of `CELLS`.
    """
    scene, mesh = started(frequency), cells or CELLS[model]
    if model == "exact":
        response = solve(scene, fidelity="nonlinear", cells=mesh, spread=False)
    else:
        scheme: Literal["as-printed", "two-grid"] = "as-printed" if model == "printed" else "two-grid"
        response = solve(scene, fidelity="linear", scheme=scheme, cells=mesh)
    # a sudden start is in the first row already; the exact cable's tension at rest varies along it
    rest = rest_tension(scene) if model == "exact" else np.array([scene.geometry.tension or 0.0])
    return TensionMap(frequency, model, response.time, response.gauges, response.tension - rest)


def standing_share(tension: FloatArray) -> float:
    """Return the share of the mean square of a map that one shape, moving as one, holds.

    Parameters
    ----------
    tension : (n, m) float64
        Over time and place.

    Returns
    -------
    float
        1 for a standing wave, 1/2 for a wave that travels over whole wave lengths; more shapes, less.

    Notes
    -----
    The first proper orthogonal mode. Feeny, J. Sound Vib. 310 (2008) 477-503, tells travelling from standing
    waves by the same decomposition.
    """
    squares = np.linalg.svd(tension, compute_uv=False) ** 2
    return float(squares[0] / np.sum(squares))


def largest(found: TensionMap) -> Largest:
    """Return where and when the tension of a map is largest."""
    row, column = np.unravel_index(int(np.argmax(found.tension)), found.tension.shape)
    along = found.tension.max(axis=0)
    inner = (found.place >= MIDDLE[0]) & (found.place <= MIDDLE[1])
    time = float(found.time[row])
    return Largest(
        place=float(found.place[column]),
        time=time,
        phase=found.frequency * time % 1.0,
        value=float(found.tension[row, column]),
        middle=float(along[inner].max()),
        bottom=float(along[0]),
        top=float(along[-1]),
    )


def crest(found: TensionMap) -> FloatArray:
    """Return the place (n,) of the largest tension of each instant."""
    return np.asarray(found.place[np.argmax(found.tension, axis=1)])


def share_in_middle(found: TensionMap) -> float:
    """Return the share of the instants whose largest tension lies in the middle."""
    places = crest(found)
    return float(np.mean((places >= MIDDLE[0]) & (places <= MIDDLE[1])))
