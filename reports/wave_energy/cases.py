"""The source article's condition 1.1, started as it starts it, and run until it has settled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from reports.scenes import condition
from tethertest.records.cable import Air
from tethertest.records.scene import Output, Scene, Top

#: drive frequencies of the sweep [Hz]: from half the first natural frequency to beyond the fourth
FREQUENCIES: Final = tuple(round(0.01 * step, 2) for step in range(6, 41))
#: those of the article's Fig. 8 [Hz]
FIGURE_8: Final = (0.13, 0.18, 0.24, 0.30)
#: stations along the cable, the first at the bottom
STATIONS: Final = tuple(float(place) for place in np.linspace(0.0, 1.0, 81))
#: the article's record: 2048 samples at 30 Hz
DURATION, RATE = 68.27, 30.0
#: a settled run: ramp [s], periods after it, samples per period; whole periods need no window function
RAMP, PERIODS, SAMPLES = 100.0, 20, 64
#: impedance of the axial wave ``sqrt(EA m)`` [N s/m], to two digits
MATCHED: Final = 2.0


_FIXED: Final = Top("fixed")


@dataclass(frozen=True, slots=True)
class Case:
    """What takes energy out of the cable."""

    name: str
    text: str
    air: Air | None = None
    top: Top = _FIXED


#: drag of a cylinder, as the shipped rigs assume it
_AIR: Final = Air(1.225, 1.2, 0.01)
CASES: Final = (
    Case("article", "fixed top, no loss, as in the article"),
    Case("air", "fixed top, air drag on the cable", _AIR),
    Case(
        "held",
        "air drag, and 5 kg held by 100 N/m and 60 N s/m",
        _AIR,
        Top("platform", mass=5.0, hover_stiffness=100.0, hover_damping=60.0),
    ),
    Case(
        "matched",
        "no drag; a top without mass that yields along the cable by the cable's own impedance",
        None,
        Top("platform", mass=0.0, hover_stiffness=(0.0, 1e5), hover_damping=(MATCHED, 0.0)),
    ),
)


def case(name: str) -> Case:
    """Return the case of that name."""
    return next(found for found in CASES if found.name == name)


def started(frequency: float) -> Scene:
    """Return the scene as the article starts it: the bottom moves with its full velocity at once."""
    scene = condition(frequency)
    bottom = replace(scene.bottom, start="jump", ramp=None)
    return replace(scene, bottom=bottom, output=Output(DURATION, RATE, STATIONS))


def settled(frequency: float, what: Case) -> Scene:
    """Return the scene with a slow ramp and whole periods after it, velocity and position along the cable."""
    scene = condition(frequency)
    duration = RAMP + (PERIODS + 1.0) / frequency
    return replace(
        scene,
        bottom=replace(scene.bottom, ramp=RAMP),
        air=what.air,
        top=what.top,
        output=Output(duration, SAMPLES * frequency, STATIONS, ("position", "velocity")),
    )
