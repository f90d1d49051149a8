"""The speed of a wave from its fronts at several sensors, and the stiffness or tension that it implies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.events import Front, WaveSpeed

#: half width of a 95 % interval in standard errors
COVERAGE: Final = 1.959964
#: shortest interval of a front [s]: two fronts are not known better against each other
SHORTEST: Final = 1e-9
#: a smallest slowness below this share of the largest is what the solver leaves of zero
RESIDUE: Final = 1e-9


def wave_speed(
    fronts: Sequence[Front],
    kind: str,
    length: float,
    mass_per_length: float,
    *,
    mass_error: float = 0.0,
    static_tension: float = 0.0,
    at_bottom: float | None = None,
) -> WaveSpeed:
    """Return the speed that passes through all fronts' intervals, and what it implies.

    Every straight line ``t = t0 + s/c`` through all intervals is possible: the steepest and the flattest give
    the interval of the speed (two linear programmes).

    Parameters
    ----------
    fronts : sequence of Front
        At two places or more; one is enough with `at_bottom`.
    kind : {"axial", "transverse"}
        Axial waves imply ``EA = m c^2`` less `static_tension`, transverse ones the tension ``m c^2``.
    length : float
        Of the cable [m], in the state of `mass_per_length`.
    mass_per_length : float
        [kg/m].
    mass_error : float
        Standard uncertainty of the mass per length, relative.
    static_tension : float
        Tension at rest [N] where length and mass belong to the stretched cable, whose axial speed is
        ``sqrt((EA + T)/m)``; 0 for the unstretched one.
    at_bottom : float, optional
        Known time at which the wave left the bottom [s].

    Raises
    ------
    DataError
        Too few places, or no straight line passes through the intervals: the fronts are not of one wave.
    """
    from scipy.optimize import linprog

    places = np.array([front.at for front in fronts]) * length
    lows, highs = np.array([front.interval for front in fronts]).reshape(-1, 2).T
    times = np.array([front.time for front in fronts])
    if at_bottom is not None:
        places, lows, highs, times = (
            np.append(array, value)
            for array, value in ((places, 0.0), (lows, at_bottom), (highs, at_bottom), (times, at_bottom))
        )
    if np.unique(places).size < 2:
        message = f"{len(fronts)} fronts at one place give no speed"
        raise DataError(message, "use sensors at two places of the cable")
    origin = float(lows.min())
    rows = np.column_stack([np.ones(places.size), places])
    limits = np.concatenate([highs - origin, origin - lows])
    slopes = []
    for sense in (1.0, -1.0):
        found = linprog([0.0, sense], np.vstack([rows, -rows]), limits, bounds=[(None, None), (0.0, None)])
        if found.x is None:
            names = ", ".join(f"{front.channel} {front.time:.5g} s" for front in fronts)
            message = f"no wave of one speed, going up, makes these fronts: {names}"
            raise DataError(message, "check the sensors' clocks and places, or look for fronts one by one")
        slopes.append(max(float(found.x[1]), 0.0))
    if slopes[0] < RESIDUE * slopes[1]:
        slopes[0] = 0.0
    weights = 1.0 / np.maximum(highs - lows, SHORTEST)
    slowness = float(np.polyfit(places, times - origin, 1, w=weights)[0])
    slowness = float(np.clip(slowness, slopes[0], slopes[1]))
    slowest, fastest = 1.0 / slopes[1], 1.0 / slopes[0] if slopes[0] > 0.0 else float("inf")
    speed = 1.0 / slowness if slowness > RESIDUE * slopes[1] else float("inf")
    share = COVERAGE * mass_error
    off = static_tension if kind == "axial" else 0.0
    return WaveSpeed(
        kind=kind,
        fronts=tuple(fronts),
        speed=speed,
        interval=(slowest, fastest),
        implied="axial_stiffness" if kind == "axial" else "tension",
        value=mass_per_length * speed**2 - off,
        value_interval=(
            mass_per_length * (1.0 - share) * slowest**2 - off,
            mass_per_length * (1.0 + share) * fastest**2 - off,
        ),
    )
