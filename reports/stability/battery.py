"""Stability battery: long, stiff, light, heavy and slack runs, each against what was asked of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from reports.scenes import condition, prototype, rig
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Air, Cable
from tethertest.records.response import Status
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.solver import solve
from tethertest.solver.nonlinear.chain_march import chain_case, run_chain
from tethertest.solver.norms import finished
from tethertest.solver.solution import Solution

#: steps of the long runs
LONG = 1_000_000
#: rows kept of a long run
_ROWS = 2000
#: cells of the long runs
_CELLS = 50
#: bow of the straight cable over its length and the root of its strain
_BOW, _LARGE_BOW = 0.05, 0.15


@dataclass(frozen=True, slots=True)
class Check:
    """One line of the battery."""

    name: str
    asked: str
    found: str
    met: bool


def battery(steps: int = LONG) -> tuple[Check, ...]:
    """Return every line; the long runs take so many steps."""
    lines: list[Callable[[], Check]] = [
        lambda: resonance(100, 1e-3),
        lambda: resonance(10, 2e-2),
        beyond_the_limit,
        lambda: courant_numbers(600.0),
        lambda: large_motion(600.0),
        large_motion_without_viscosity,
        *(lambda ratio=ratio: energy(ratio, steps) for ratio in (1.3, 5.0, 20.0, 300.0)),
        lambda: rare_slack(steps),
        pretensions,
        masses,
        implicit_damping,
        light_cable,
    ]
    return tuple(line() for line in lines)


def resonance(cells: int, limit: float) -> Check:
    """Measure how a straight cable's end tension grows at its first axial resonance, Courant number 1."""
    amplitude, stiffness, mass, length = 1e-3, 1e4, 0.05, 100.0
    speed = math.sqrt(stiffness / mass)
    frequency = speed / (2.0 * length)
    cycles = 50
    scene = Scene(
        name="resonance",
        cable=Cable(length, "unstretched", mass, axial_stiffness=stiffness),
        geometry=Geometry("straight", tension=1000.0),
        bottom=Bottom("harmonic", amplitude=amplitude, frequency=frequency),
        top=Top("fixed"),
        output=Output(cycles / frequency, 10.0, (1.0,)),
    )
    tension = run_chain(scene, cells, viscous=False, courant=1.0, native_times=True).tension[:, 0]
    peaks = np.abs(tension - tension[0]).reshape(-1)[: cycles * 2 * cells].reshape(cycles, -1).max(axis=1)
    growth = float(np.polyfit(np.arange(cycles - 5), peaks[5:], 1)[0])
    exact = 2.0 * math.sqrt(stiffness * mass) * amplitude * 2.0 * math.pi * frequency
    error = growth / exact - 1.0
    return Check(
        f"axial resonance, {cells} cells, {cycles} cycles",
        f"growth per 2 L/c within {limit:g} of 2 Z A w",
        f"{error:+.1e}",
        abs(error) <= limit,
    )


def beyond_the_limit() -> Check:
    """Ask for a Courant number above the limit: refused with advice."""
    try:
        run_chain(condition(), 100, viscous=False, courant=1.01)
    except DataError as error:
        return Check("Courant number 1.01", "refused", f"refused: {error.problem}", True)
    return Check("Courant number 1.01", "refused", "accepted", False)


def courant_numbers(duration: float) -> Check:
    """Run condition 1.1 at several Courant numbers."""
    scene = condition(duration=duration)
    tops = [
        _top(run_chain(scene, 100, viscous=False, courant=number)) for number in (1.0, 0.95, 0.9, 0.7, 0.4)
    ]
    tops.append(_top(run_chain(scene, 100)))
    apart = max(tops) / min(tops) - 1.0
    return Check(
        f"condition 1.1, {duration:g} s, 100 cells, Courant numbers 1, .95, .9, .7, .4 and viscous",
        "largest top tension within .5 %",
        f"{min(tops):.2f} to {max(tops):.2f} N, {apart:.2%} apart",
        apart <= 5e-3,
    )


def large_motion(duration: float) -> Check:
    """Drive condition 1.1 by 5 m: it goes slack and stays bounded with viscosity."""
    solution = run_chain(condition(amplitude=5.0, duration=duration), 100)
    top = _top(solution)
    return Check(
        f"5 m, slack, {duration:g} s, 100 cells, viscous",
        "bounded, 280 to 305 N (the design study: 290 to 300 N)",
        f"{top:.1f} N",
        finished(solution) and 280.0 <= top <= 305.0,
    )


def large_motion_without_viscosity() -> Check:
    """Leave the viscosity out: nonsense, which the solver does not hand out."""
    scene = condition(amplitude=5.0, duration=600.0)
    bare = _top(run_chain(scene, 100, viscous=False))
    answer = solve(condition(amplitude=5.0), spread=False)
    viscous, top = "viscosity" in answer.scheme, float(np.max(answer.field.maximum[:, -1]))
    return Check(
        "the same without viscosity",
        "not handed out: the solver takes the viscous scheme by itself",
        f"forced: {bare:.3g} N; solve (67.5 s): {answer.scheme}, {top:.0f} N, {answer.status.name.lower()}",
        viscous and answer.status is not Status.NOT_FINITE,
    )


def energy(ratio: float, steps: int) -> Check:
    """Follow the energy of a transverse wave between fixed ends, for a ratio of axial to transverse speed."""
    drifts = []
    for courant, viscous in ((1.0, False), (0.95, False), (0.9, True)):
        drifts.append(energy_drift(ratio, steps, courant=courant, viscous=viscous))
    lossless = max(abs(drift) for drift in drifts[:2])
    large = energy_drift(ratio, steps, courant=0.9, viscous=True, bow=_LARGE_BOW)
    found = (
        ", ".join(f"{drift:+.1e}" for drift in drifts)
        + f"; viscous with a bow three times as large {large:+.1e}"
    )
    return Check(
        f"energy, c_l/c_t = {ratio:g}, {steps:.0e} steps, Courant 1, .95, .9 viscous",
        "drifts by less than 2e-3 without viscosity; with it may be lost, not grow by more",
        found,
        lossless < 2e-3 and max(drifts[2], large) < 2e-3,
    )


def energy_drift(ratio: float, steps: int, *, courant: float, viscous: bool, bow: float = _BOW) -> float:
    """Return the relative change of a bowed straight cable's energy from the first to the last tenth."""
    strain = 1.0 / (ratio**2 - 1.0)
    speed, stiffness = 100.0, 1e4
    mass, length = stiffness / speed**2, 100.0
    scene = Scene(
        name="bowed",
        cable=Cable(length, "unstretched", mass, axial_stiffness=stiffness),
        geometry=Geometry("straight", tension=stiffness * strain),
        bottom=Bottom("fixed"),
        top=Top("fixed"),
        output=Output(1.0, 1.0, (0.0,)),
    )
    case = chain_case(scene, _CELLS, viscous=viscous, sideways=True)
    step = min(courant, case.courant) * case.line.cell / speed
    every = max(1, steps // _ROWS)
    gauges = tuple(float(node) / _CELLS for node in range(_CELLS + 1))
    output = Output(steps * step, 1.0 / (every * step), gauges, ("position", "velocity"))
    solution = run_chain(
        replace(scene, output=output), _CELLS, viscous=viscous, courant=min(courant, case.courant),
        imperfection=min(bow * math.sqrt(strain), 0.05),
    )  # fmt: skip
    if not finished(solution):
        return math.inf
    total = _energy(solution.fields["position"], solution.fields["velocity"], case.line.cell, mass, stiffness)
    total -= 0.5 * stiffness * strain**2 * length
    tenth = total.size // 10
    return float(np.mean(total[-tenth:]) / np.mean(total[1 : tenth + 1]) - 1.0)


def _energy(
    position: FloatArray, velocity: FloatArray, cell: float, mass: float, stiffness: float
) -> FloatArray:
    """Return the energy (n,) [J] of chains whose nodes are at positions (n, m, 3)."""
    stretch = np.linalg.norm(np.diff(position, axis=1), axis=2) / cell
    elastic = 0.5 * stiffness * np.sum((stretch - 1.0) ** 2, axis=1) * cell
    return np.asarray(elastic + 0.5 * mass * cell * np.sum(velocity**2, axis=(1, 2)))


def rare_slack(steps: int) -> Check:
    """Run condition 1.1 at 0.2 Hz over many steps: slack now and then."""
    scene = condition(0.2)
    step = chain_case(scene, _CELLS).time_step
    scene = replace(scene, output=Output(steps * step, 1.0, (0.0, 1.0)))
    solution, bare = run_chain(scene, _CELLS), run_chain(scene, _CELLS, viscous=False)
    top, high = float(np.max(solution.field.maximum)), float(np.max(bare.field.maximum))
    return Check(
        f"condition 1.1, 0.2 Hz, 2 m, 50 cells, {steps:.0e} steps, viscous",
        "bounded by 210 N anywhere",
        f"{top:.1f} N (without viscosity {high:.3g} N)",
        finished(solution) and top <= 210.0,
    )


def pretensions() -> Check:
    """Run the 150 m tether at 45 degrees from nearly loose to tight, with and without viscosity."""
    worst, tops = 0.0, []
    for tension in (1.0, 5.0, 20.0, 50.0, 100.0, 200.0, 500.0):
        scene = replace(prototype(45.0, tension, amplitude=0.2), air=None)
        pair = [_top(run_chain(scene, 100, viscous=viscous)) for viscous in (False, True)]
        tops.append(pair[1])
        worst = max(worst, abs(pair[0] / pair[1] - 1.0))
    return Check(
        "tensions 1 to 500 N, 45 degrees, 0.2 m",
        "stable, same peak with and without viscosity to 1e-3",
        f"peaks {', '.join(f'{top:.1f}' for top in tops)} N, at most {worst:.1e} apart",
        worst < 1e-3 and all(math.isfinite(top) for top in tops),
    )


def masses() -> Check:
    """Hold the rig with platforms without mass and of a billion kilograms."""
    tops = {mass: run_chain(rig(mass), 10) for mass in (0.0, 1e-6, 1e-2, 0.4, 1e3, 1e9)}
    flat = float(np.ptp(tops[0.0].tension[:, -1]))
    right = all(finished(run) and bool(np.all(np.isfinite(run.tension))) for run in tops.values())
    return Check(
        "platforms of 0, 1e-6, .01, .4, 1e3, 1e9 kg",
        "finite; without mass the top tension stays 5 N",
        f"{', '.join(f'{_top(run):.4g}' for run in tops.values())} N; without mass flat to {flat:.1e} N",
        right and flat < 1e-6,
    )


def implicit_damping() -> Check:
    """Take damping times far above what an explicit step allows."""
    found, good = [], True
    for time in (1e-2, 1.0):
        runs = [run_chain(rig(damping_time=time), cells) for cells in (10, 40)]
        good = good and all(finished(run) for run in runs)
        cell = 3.0 / 40
        found.append(
            f"{time:g} s (t_d c/h = {time * 455 / cell:.0f}): {', '.join(f'{_top(r):.4f}' for r in runs)}"
        )
        good = good and abs(_top(runs[0]) / _top(runs[1]) - 1.0) < 1e-3
    return Check(
        "axial damping times of .01 and 1 s on the 3 m rig, 10 and 40 cells",
        "finite, both meshes within 1e-3",
        "; ".join(found) + " N",
        good,
    )


def light_cable() -> Check:
    """Put drag on a light cable of few cells: the step is limited, the march bounded."""
    light = Cable(150.0, "unstretched", 1e-3, axial_stiffness=10020.0, diameter=0.006)
    scene = replace(prototype(45.0), cable=light, air=Air(1.225, 1.2, 0.01, wind=(20.0, 0.0)))
    scene = replace(scene, geometry=Geometry("ends", top=(106.0, 106.2)))
    found, good = [], True
    for cells in (5, 20, 80):
        case, solution = chain_case(scene, cells), run_chain(scene, cells)
        good = good and finished(solution)
        found.append(f"{cells} cells: Courant {case.courant:.3f}, {_top(solution):.1f} N")
    return Check(
        "1 g/m, 6 mm, 150 m, 20 m/s wind, 2 m heave, 5 to 80 cells", "bounded", "; ".join(found), good
    )


def _top(solution: Solution) -> float:
    return float(np.max(solution.field.maximum[:, -1]))
