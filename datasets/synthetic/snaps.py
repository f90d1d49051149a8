"""What `truth.json` states of snaps: every re-tautening of an end, and the peak that it leads to."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .campaign import Plan
from .equilibrium import rest_shape
from .rig import Rig
from .statement import SLACK_BELOW, SLACK_SHORTEST, slack_intervals
from .tether import Truth

Floats = NDArray[np.float64]

TAUT_SHORTEST = 0.010
"""The cable counts as taut between two slack intervals from this long on, in s."""
WITHIN = 0.25
"""The peak is the largest tension within this time of re-tautening, in s."""
FALLEN = 0.9
"""Or later, as long as tension has not fallen below this share of its largest."""
RISE = (0.1, 0.9)


def snaps(plan: Plan, rig: Rig, truth: Truth) -> dict[str, Any]:
    """Return the snaps of both ends, one list per quantity.

    Parameters
    ----------
    plan, rig : Plan, Rig
        The run and the rig.
    truth : Truth
        Its true signals.
    """
    result: dict[str, Any] = {
        "below_N": SLACK_BELOW,
        "slack_shortest_s": SLACK_SHORTEST,
        "taut_shortest_s": TAUT_SHORTEST,
        "within_s": WITHIN,
        "fallen": FALLEN,
        "rise": list(RISE),
    }
    parting = parting_speed(plan, rig, truth)
    for name in ("tension_bottom", "tension_top"):
        tension = getattr(truth, name)
        spans = slack_intervals(truth.time, tension, TAUT_SHORTEST)
        found = [
            _snap(truth.time, tension, parting, span, following[0])
            for span, following in zip(spans, [*spans[1:], [np.inf, np.inf]], strict=False)
            if span[1] < truth.time[-1]
        ]
        keys = ("start_s", "slack_s", "peak_s", "peak_N", "rise_s", "parting_m_per_s")
        result[name] = {key: [snap[key] for snap in found] for key in keys}
    return result


def parting_speed(plan: Plan, rig: Rig, truth: Truth) -> Floats:
    """Return the speed at which the distance of the two ends grows, in m/s."""
    top = rest_shape(rig, plan.cells, plan.offset)[0][-1]
    sideways, upwards = top[0] + truth.top[0], top[1] + truth.top[1] - truth.heave
    return np.asarray(np.gradient(np.hypot(sideways, upwards), truth.time))


def _snap(
    time: Floats, tension: Floats, parting: Floats, span: list[float], following: float
) -> dict[str, float]:
    """Return one snap: what follows one slack interval, up to the next."""
    start = int(np.searchsorted(time, span[1], "right"))
    peak, fallen = start, False
    for index in range(start, int(np.searchsorted(time, following))):
        if fallen and time[index] > time[start] + WITHIN:
            break
        if tension[index] > tension[peak]:
            peak, fallen = index, False
        elif tension[index] < FALLEN * tension[peak]:
            fallen = True
    low, high = (_passed(time, tension, start, share * tension[peak]) for share in RISE)
    return {
        "start_s": float(time[start]),
        "slack_s": span[1] - span[0],
        "peak_s": float(time[peak]),
        "peak_N": float(tension[peak]),
        "rise_s": high - low,
        "parting_m_per_s": float(parting[start:peak].max(initial=parting[start])),
    }


def _passed(time: Floats, tension: Floats, start: int, level: float) -> float:
    """Return when tension passes a level for the first time since it was last below it in slack."""
    above = start
    while above > 0 and tension[above - 1] >= level:
        above -= 1
    while tension[above] < level:
        above += 1
    share = (level - tension[above - 1]) / (tension[above] - tension[above - 1])
    return float(time[above - 1] + share * (time[above] - time[above - 1]))
