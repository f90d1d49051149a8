"""Marker taps: short knocks on the base while the rig is at rest."""

from __future__ import annotations

import numpy as np

from tethertest.records.channel import Channel
from tethertest.signal.filters import filled
from tethertest.signal.noise import white_noise
from tethertest.signal.windows import Rest, Span

#: the base moves in a tap by more than this many standard deviations of one sample
HEIGHT_SIGMAS = 10.0
#: knocks closer than this are one tap [s]
APART = 0.3
#: a longer excursion is no tap [s]
LONGEST = 0.6
#: compared before and after a tap [s]; three periods of the UAV bouncing on the cable, no more: an error of
#: its frequency adds up with every period
BEFORE, AFTER = 0.1, 0.2


def tap_spans(heave: Channel, rest: Rest) -> tuple[Span, ...]:
    """Return the spans around the taps in the rest windows.

    Parameters
    ----------
    heave : Channel
        Bottom displacement [m].
    rest : Rest
        Its rest windows, on the channel's own clock.
    """
    sigma = white_noise(filled(heave))
    spans: list[Span] = []
    for window in (rest.before, rest.after):
        if window is None:
            continue
        part = heave.between(*window)
        values, time = part.values[part.usable], part.time[part.usable]
        if not time.size:
            continue
        out = time[np.abs(values - np.median(values)) > HEIGHT_SIGMAS * sigma]
        for group in np.split(out, np.flatnonzero(np.diff(out) > APART) + 1):
            if group.size > 1 and group[-1] - group[0] <= LONGEST:
                spans.append((float(group[0]) - BEFORE, float(group[-1]) + AFTER))
    return tuple(spans)
