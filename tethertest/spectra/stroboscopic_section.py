"""The stroboscopic section: the series seen once per period of the drive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.signal.blocks import Blocks

#: phases of the drive at which the section is taken; their mean is reported
PHASES: Final = 16


@dataclass(frozen=True, slots=True)
class Section:
    """Mean squared differences of the series one and two periods apart."""

    one: float  #: D1 = mean |x(n+1) - x(n)|^2
    two: float  #: D2 = mean |x(n+2) - x(n)|^2

    @property
    def ratio(self) -> float:
        """D1 / D2: about one for noise, far above one for a response of period two."""
        return self.one / max(self.two, 1e-300)


def stroboscopic_section(blocks: Blocks, drive: float) -> Section | None:
    """Return D1 and D2 of a series at the period of the drive, or None for fewer than three periods.

    Parameters
    ----------
    blocks : Blocks
        The channel's window; empty blocks are bridged by straight lines.
    drive : float
        Frequency of the drive [Hz].
    """
    inside = blocks.weights > 0.0
    time, values = blocks.time[inside], blocks.values[inside]
    period = 1.0 / drive
    count = int((time[-1] - time[0]) / period)
    if count < 3:
        return None
    start = time[0] + period * np.arange(PHASES) / PHASES
    instants = start[:, None] + period * np.arange(count)[None, :]
    seen = np.where(instants <= time[-1], np.interp(instants, time, values), np.nan)
    one = float(np.nanmean((seen[:, 1:] - seen[:, :-1]) ** 2))
    two = float(np.nanmean((seen[:, 2:] - seen[:, :-2]) ** 2))
    return Section(one, two)
