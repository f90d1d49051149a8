"""Two grids against energy conservation, the coupled natural frequencies and their plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.kernels.as_printed import march_printed, step_printed
from tethertest.kernels.two_grid import couple, march, shift
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable
from tethertest.records.scene import Bottom, Geometry, MeasuredMotion, Output, Scene, Top
from tethertest.solver.linear import as_printed, two_grid
from tethertest.solver.linear.as_printed import run_as_printed
from tethertest.solver.linear.coupled import coupled_cable
from tethertest.solver.linear.two_grid import _overlap, run_two_grid

PAPER_CABLE = Cable(250.0, "equilibrium", 0.02, youngs_modulus=1.7e7, diameter=3e-3)


def paper(bottom: Bottom, duration: float, gauges: tuple[float, ...]) -> Scene:
    return Scene(
        name="paper 1.1",
        cable=PAPER_CABLE,
        geometry=Geometry("shallow", tension=80.0),
        bottom=bottom,
        top=Top("fixed"),
        output=Output(duration, 10.0, gauges),
        gravity=9.81,
    )


def pulse(duration: float) -> MeasuredMotion:
    """A heave that is over after 8 s."""
    time = np.linspace(0.0, duration, round(10 * duration) + 1)
    return MeasuredMotion(time, np.where(time < 8.0, np.sin(np.pi * np.minimum(time, 8.0) / 8.0) ** 4, 0.0))


def energy(axial: FloatArray, transverse: FloatArray) -> float:
    total = 0.0
    for field in (axial, transverse):
        density = np.sum(field**2, axis=0)
        total += float(np.sum(density) - 0.5 * (density[0] + density[-1])) / (field.shape[1] - 1)
    return total


def energy_after(cells: tuple[int, int], steps: int) -> tuple[float, float]:
    """Return the last energy over the first, and the largest growth in a step, between fixed ends."""
    cable, (n1, n2) = coupled_cable(paper(Bottom("fixed"), 1.0, (0.0,))), cells
    half_turn = 0.5 * cable.curvature * 250.0
    angles = (half_turn / n2, half_turn / n1)
    axial, transverse = np.zeros((2, n1 + 1)), np.zeros((2, n2 + 1))
    axial[0] = np.sin(np.pi * np.arange(n1 + 1) / n1) ** 2
    transverse[0] = np.sin(2.0 * np.pi * np.arange(n2 + 1) / n2) * np.sin(np.pi * np.arange(n2 + 1) / n2)
    buffers, overlap = [np.zeros_like(axial), np.zeros_like(transverse)], _overlap(n1, n2)
    energies = [energy(axial, transverse)]
    for _ in range(steps):
        couple(axial, transverse, overlap, angles, *buffers)
        shifted = [np.zeros_like(axial), np.zeros_like(transverse)]
        shift(axial, 0.0, 0.0, shifted[0])
        shift(transverse, 0.0, 0.0, shifted[1])
        axial, transverse = shifted
        couple(axial, transverse, overlap, angles, *buffers)
        energies.append(energy(axial, transverse))
    return energies[-1] / energies[0], float(np.max(np.diff(energies)))


def test_energy_between_fixed_ends_never_grows_and_its_loss_is_of_second_order() -> None:
    """450 s, 180 axial traverses, of a smooth state."""
    coarse, coarse_growth = energy_after((55, 87), 10_000)
    fine, fine_growth = energy_after((110, 174), 20_000)
    assert max(coarse_growth, fine_growth) < 1e-13
    assert 0.0 < 1.0 - coarse < 1e-2
    assert (1.0 - coarse) / (1.0 - fine) == pytest.approx(4.0, rel=0.1)


def test_free_vibration_against_the_coupled_natural_frequencies() -> None:
    """What rings after a pulse rings at the table's 0.12996, 0.19341 and 0.26012 Hz, not at n ct/2L."""
    duration = 1000.0
    scene = paper(Bottom("measured"), duration, (0.9,))
    found = run_two_grid(scene, 55, measured=pulse(duration))
    strain = found.strain[200:, 0]
    strain = (strain - np.mean(strain)) * np.hanning(strain.size)
    spectrum = np.abs(np.fft.rfft(strain, 8 * strain.size))
    frequency = np.fft.rfftfreq(8 * strain.size, 0.1)
    for expected in (0.12996, 0.19341, 0.26012):
        near = np.abs(frequency - expected) < 0.004
        assert frequency[near][np.argmax(spectrum[near])] == pytest.approx(expected, rel=5e-4)


def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    from tethertest.kernels import as_printed as printed_kernel
    from tethertest.kernels import two_grid as kernel

    names = (
        "couple",
        "shift",
        "complete_ends",
        "arrive",
        "move_body",
        "fresh_memory",
        "keep_level",
        "observe",
    )
    python = {name: getattr(kernel, name).py_func for name in (*names, "widen")}
    for name, function in python.items():
        monkeypatch.setattr(kernel, name, function)
    for name in ("fresh_memory", "keep_level"):
        monkeypatch.setattr(printed_kernel, name, python[name])
    monkeypatch.setattr(printed_kernel, "step_printed", step_printed.py_func)
    monkeypatch.setattr(two_grid, "march", march.py_func)
    monkeypatch.setattr(as_printed, "march_printed", march_printed.py_func)


@pytest.mark.parametrize("run", [run_two_grid, run_as_printed])
def test_compiled_kernel_against_its_plain_python(run: object, monkeypatch: pytest.MonkeyPatch) -> None:
    assert callable(run)
    scene = paper(
        Bottom("harmonic", direction="vertical", amplitude=1.0, frequency=0.2), 12.0, (0.0, 0.3, 1.0)
    )
    compiled = run(scene, 12)
    plain(monkeypatch)
    interpreted = run(scene, 12)
    assert np.ptp(compiled.tension) > 1.0
    np.testing.assert_allclose(interpreted.tension, compiled.tension, rtol=1e-11)
    np.testing.assert_allclose(interpreted.field.maximum, compiled.field.maximum, rtol=1e-11)
