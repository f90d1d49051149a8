"""From when on a response has settled to the drive: a subharmonic takes many cycles to grow."""

from __future__ import annotations

import numpy as np

from tethertest.signal.filters import moving_mean
from tethertest.signal.series import Series
from tethertest.signal.thinning import evenly
from tethertest.signal.windows import Steady

#: orders of the drive that are followed
ORDERS = (0.5, 1.0)
#: cycles over which their amplitudes are measured
CYCLES_AVERAGED = 4
#: with fewer cycles the drive is slow against the rig, whose transients die within one
FEWEST_CYCLES = 40
#: settled within this fraction of the response's root mean square
SETTLED = 0.03
#: a response that takes more than this fraction of the window does not settle at all: nothing is cut
LARGEST_CUT = 0.5


def settled_from(response: Series, steady: Steady) -> Steady:
    """Return the steady window without the cycles in which the response still grows or dies away.

    Parameters
    ----------
    response : Series
        A tension on the same clock.
    steady : Steady
        Window of steady drive.

    Returns
    -------
    Steady
        The same window, or a shorter one with the same end and a whole number of cycles.
    """
    if steady.cycles < FEWEST_CYCLES or not response.usable.any():
        return steady
    time, values, rate = evenly(response, steady.span, steady.frequency)
    values = values - values.mean()
    length = CYCLES_AVERAGED / steady.frequency * rate
    late = time > steady.span[0] + LARGEST_CUT * (steady.span[1] - steady.span[0])
    allowed = SETTLED * float(np.sqrt(np.mean(values**2)))
    cut = steady.span[0]
    for order in ORDERS:
        carrier = np.exp(-2j * np.pi * order * steady.frequency * time)
        amplitude = 2.0 * np.abs(moving_mean(values * carrier, length))
        strays = np.flatnonzero(np.abs(amplitude - np.median(amplitude[late])) > allowed)
        strays = strays[(strays > 0.5 * length) & (strays < time.size - 0.5 * length)]
        if strays.size and late[strays[-1]]:
            return steady
        if strays.size:
            cut = max(cut, float(time[strays[-1]]))
    cycles = int((steady.span[1] - cut) * steady.frequency + 1e-6)
    start = steady.span[1] - cycles / steady.frequency
    return Steady((start, steady.span[1]), steady.frequency, steady.amplitude, cycles)
