"""Smallest calls that compile every kernel, for the processes that run the tests to share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tethertest.bench.finite_volumes.march import run_axial_muscl
from tethertest.bench.spectral_elements.march import run_spectral
from tethertest.readers import read_log
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver import solve

VERTICAL = Scene(
    name="warm-up",
    cable=Cable(3.0, "unstretched", 0.05, axial_stiffness=1e4),
    geometry=Geometry("vertical", tension=5.0),
    bottom=Bottom("harmonic", "vertical", amplitude=1e-3, frequency=1.0, start="ramp", ramp=1.0),
    top=Top("platform", mass=0.4, hover_stiffness=50.0),
    output=Output(0.05, 100.0, (0.0, 1.0)),
)
SHALLOW = replace(VERTICAL, geometry=Geometry("shallow", tension=50.0), top=Top("fixed"))


def _march(_: Path) -> None:
    solve(VERTICAL, fidelity="nonlinear", cells=4)
    inclined = replace(VERTICAL, geometry=Geometry("ends", top=(1.8, 2.4)))
    solve(inclined, fidelity="nonlinear", cells=4)


def _two_grid(_: Path) -> None:
    solve(SHALLOW, fidelity="linear", scheme="two-grid", cells=4)


def _as_printed(_: Path) -> None:
    solve(SHALLOW, fidelity="linear", scheme="as-printed", cells=4)


def _finite_volumes(_: Path) -> None:
    run_axial_muscl(VERTICAL, 8)


def _spectral_elements(_: Path) -> None:
    run_spectral(VERTICAL, 2)


def _text(folder: Path) -> None:
    path = folder / "log.csv"
    path.write_text("time [s],x [N]\n" + "".join(f"{row / 10},1.5\n" for row in range(40)), encoding="utf-8")
    read_log(path)


#: in turn, two processes get about as much to do
CALLS: tuple[Callable[[Path], None], ...] = (
    _march,
    _as_printed,
    _spectral_elements,
    _text,
    _two_grid,
    _finite_volumes,
)


def compile_share(number: int, count: int, folder: Path) -> None:
    """Compile the part of the kernels that is this process's.

    Parameters
    ----------
    number, count : int
        Which of how many processes this is.
    folder : Path
        For a small log.
    """
    for call in CALLS[number::count]:
        call(folder)
