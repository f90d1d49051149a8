"""The sweep of drive frequencies: every model from the article's start, every kind of loss settled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from reports.wave_energy.cases import CASES, FIGURE_8, FREQUENCIES, settled, started
from reports.wave_energy.maps import (
    CELLS,
    MODELS,
    Largest,
    Model,
    TensionMap,
    largest,
    share_in_middle,
    standing_share,
    started_map,
)
from reports.wave_energy.orders import CELLS as SETTLED_CELLS
from reports.wave_energy.orders import SettledRun, settled_run
from reports.wave_energy.steady import steady_state
from tethertest.records.arrays import FloatArray
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.solver.modal.coupled_modes import in_plane_frequencies

#: natural frequencies shown
_NATURALS: Final = 5
#: the mesh error is told at this settled frequency and loss
_JUDGED: Final = (0.24, "air")


@dataclass(frozen=True, slots=True)
class StartedRun:
    """One drive frequency from the article's start, with one model."""

    frequency: float  #: [Hz]
    model: Model
    share: float  #: of the mean square that one shape holds
    largest: Largest
    in_middle: float  #: share of the instants whose own largest tension lies in the middle


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """All results."""

    started: tuple[StartedRun, ...]
    maps: tuple[TensionMap, ...]  #: of the frequencies of Fig. 8
    settled: tuple[SettledRun, ...]
    closed: dict[tuple[float, str], float]  #: (frequency, case) -> power of the linear closed form [W]
    naturals: FloatArray  #: of the article's equations, both ends held [Hz]
    mesh_largest: float  #: relative change of the exact maps' largest tensions from half the mesh, at most
    mesh_ratio: float  #: change of a settled energy ratio from half the mesh

    def start(self, frequency: float, model: Model) -> StartedRun:
        """Return one run from the article's start."""
        return next(run for run in self.started if (run.frequency, run.model) == (frequency, model))

    def of_case(self, case: str) -> tuple[SettledRun, ...]:
        """Return the settled runs of one kind of loss, by rising frequency."""
        return tuple(run for run in self.settled if run.case == case)

    def natural_near(self, frequency: float) -> float:
        """Return how far the nearest natural frequency lies, relative to it."""
        return float(np.min(np.abs(self.naturals - frequency) / self.naturals))


def run_sweep(frequencies: Sequence[float] = FREQUENCIES) -> Sweep:
    """Run everything.

    Parameters
    ----------
    frequencies : sequence of float
        Of the drive [Hz]; those of Fig. 8 must be among them.
    """
    found: list[StartedRun] = []
    maps: list[TensionMap] = []
    for frequency in frequencies:
        for model in MODELS:
            one = started_map(frequency, model)
            share = standing_share(one.tension)
            found.append(StartedRun(frequency, model, share, largest(one), share_in_middle(one)))
            if frequency in FIGURE_8:
                maps.append(one)
    runs = tuple(settled_run(frequency, what) for what in CASES for frequency in frequencies)
    closed = {
        (frequency, what.name): steady_state(settled(frequency, what)).work
        for what in CASES
        for frequency in frequencies
    }
    return Sweep(
        tuple(found),
        tuple(maps),
        runs,
        closed,
        in_plane_frequencies(coupled_cable(started(frequencies[0])), _NATURALS),
        _mesh_largest(maps),
        _mesh_ratio(),
    )


def _mesh_largest(maps: Sequence[TensionMap]) -> float:
    """Return how much half the mesh changes the exact maps' largest tensions, at most."""
    changes = []
    for fine in maps:
        if fine.model == "exact":
            coarse = started_map(fine.frequency, "exact", CELLS["exact"] // 2)
            changes.append(abs(float(coarse.tension.max() / fine.tension.max()) - 1.0))
    return max(changes)


def _mesh_ratio() -> float:
    """Return how much half the mesh changes the energy ratio at the bottom."""
    frequency, name = _JUDGED
    what = next(one for one in CASES if one.name == name)
    ratios = []
    for cells in (SETTLED_CELLS // 2, SETTLED_CELLS):
        waves = settled_run(frequency, what, cells).order(0.0)
        ratios.append(waves.energy_ratio if waves is not None else np.nan)
    return abs(ratios[1] - ratios[0])
