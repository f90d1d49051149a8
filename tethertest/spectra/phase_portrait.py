"""A response seen once per period of the drive, and against its own rate of change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import Channel, Window
from tethertest.signal.filters import filled, low_passed
from tethertest.signal.spline import spline
from tethertest.spectra.stroboscopic_section import PHASES

#: orders of the drive that are kept: differentiation would show the noise above
HIGHEST_ORDER: Final = 12.0
#: points of the orbit per period of the drive, enough for a smooth curve at the highest order
POINTS: Final = 240
#: periods of the orbit shown, the last ones: more would be a blot
MOST_PERIODS: Final = 200
#: a section needs this many periods
FEWEST_PERIODS: Final = 3
#: numbers that hide rounding in a count of periods
_HAIR: Final = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class PhasePortrait:
    """Stroboscopic section and phase portrait of one channel."""

    channel: str
    unit: str
    phase: float  #: of the section, in periods of the drive after the first sample
    time: FloatArray  #: (n,) [s], once per period
    section: FloatArray  #: (n,) values there, in `unit`
    section_rate: FloatArray  #: (n,) rates of change there, in `unit` per second
    values: FloatArray  #: (m,) low-passed, in `unit`
    rates: FloatArray  #: (m,) in `unit` per second
    periods: int  #: of `values`, the window's last

    def step(self, periods: int) -> float:
        """Return how far values so many periods apart differ, root mean square, in `unit`."""
        return float(np.sqrt(np.mean((self.section[periods:] - self.section[:-periods]) ** 2)))


def portrait(channel: Channel, window: Window, frequency: float) -> PhasePortrait:
    """Return the stroboscopic section and the phase portrait of a window.

    Values are low-passed at `HIGHEST_ORDER` orders of the drive; a cubic spline through them gives the rate
    of change and the values between samples. The section has one instant for each period of the window that
    its samples show whole or but for one of them, at that one of `PHASES` phases where it spreads most: a
    response of period two can cross itself at another.

    Parameters
    ----------
    channel : Channel
        Straight lines bridge samples that may not be used.
    window : Window
        The part to show.
    frequency : float
        Of the drive [Hz].

    Raises
    ------
    DataError
        The window holds fewer than three periods of this channel, fewer than two samples per period, or no
        usable sample.
    """
    part = channel.between(window.start, window.stop)
    rate = part.rate
    # n samples last n intervals, and the window's ends may each have cost a part of another
    length = float(part.time[-1] - part.time[0]) + 2.0 / rate if rate else 0.0
    count = int(length * frequency + _HAIR)
    if count < FEWEST_PERIODS or rate <= 2.0 * frequency:
        message = (
            f"channel {channel.name!r}: {count} periods of {frequency:.4g} Hz in the window, sampled at "
            f"{rate:.4g} Hz"
        )
        raise DataError(
            message, f"choose a window of {FEWEST_PERIODS} periods or more, of two samples or more each"
        )
    through = spline(part.time, low_passed(filled(part), rate, HIGHEST_ORDER * frequency))
    start, stop = float(part.time[0]), float(part.time[-1])
    instants = start + (np.arange(count)[None, :] + np.arange(PHASES)[:, None] / PHASES) / frequency
    instants = np.minimum(instants[instants[:, -1] <= stop + _HAIR / frequency], stop)
    best = int(np.argmax(through(instants).std(axis=1)))
    shown = min(count, MOST_PERIODS)
    points = np.linspace(max(start, stop - shown / frequency), stop, shown * POINTS + 1)
    return PhasePortrait(
        channel.name,
        channel.unit,
        float((instants[best, 0] - start) * frequency),
        frozen(instants[best]),
        frozen(through(instants[best])),
        frozen(through(instants[best], 1)),
        frozen(through(points)),
        frozen(through(points, 1)),
        shown,
    )
