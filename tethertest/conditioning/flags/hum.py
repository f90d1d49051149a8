"""Hum at the mains frequency: a line that stands above its surroundings while the rig is at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.records.channel import Channel, Finding, Flag, Window
from tethertest.signal.filters import filled

#: amplitudes are measured in stretches of this length [s]
STRETCH = 1.0
#: the surroundings are the lines this far from the mains [Hz]
NEAREST, FARTHEST = 3.0, 8.0
#: hum is a line this many times the median of its surroundings
SIGNIFICANT = 4.0
#: and above this fraction of one sample's noise as the rig states it (10 mN of 15 mN): less does no harm
HARMFUL = 0.65
#: width of the mains line within which the largest amplitude counts [Hz]
LINE_WIDTH = 1.0
#: samples of a window that are looked at
MOST = 1 << 19


def hum_amplitude(channel: Channel, mains: float, windows: Sequence[Window]) -> tuple[float, float]:
    """Return the amplitude at the mains frequency and that of its surroundings.

    Parameters
    ----------
    channel : Channel
        Any channel sampled fast enough for the mains and its surroundings.
    mains : float
        [Hz]
    windows : sequence of Window
        Rest windows: there no harmonic of the drive can pass for hum.

    Returns
    -------
    tuple of float
        Median over the stretches of the record, so that snaps do not count, in the channel's unit; zeros
        where the sampling is too slow.
    """
    size = round(STRETCH * channel.rate)
    parts = [
        filled(part)
        for part in (channel.between(item.start, item.stop).rows(0, MOST) for item in windows)
        if part.usable.any()
    ]
    rows = [part[: part.size // size * size].reshape(-1, size) for part in parts if 0 < size <= part.size]
    if not rows or mains + FARTHEST > 0.5 * channel.rate:
        return 0.0, 0.0
    window = np.hanning(size)
    stretches = np.concatenate(rows)
    stretches = stretches - stretches.mean(axis=1, keepdims=True)
    amplitude = 2.0 * np.abs(np.fft.rfft(stretches * window, axis=1)) / window.sum()
    frequency = np.fft.rfftfreq(size, 1.0 / channel.rate)
    away = np.abs(frequency - mains)
    line = float(np.median(amplitude[:, away <= LINE_WIDTH].max(axis=1)))
    around = float(np.median(amplitude[:, (away >= NEAREST) & (away <= FARTHEST)]))
    return line, around


def with_hum_flagged(
    channel: Channel, mains: float, noise: float, windows: Sequence[Window]
) -> tuple[Channel, tuple[Finding, ...]]:
    """Return the channel with `Flag.HUM` on every sample when it hums, and the finding.

    Parameters
    ----------
    channel : Channel
        A channel in SI.
    mains, noise : float
        Mains frequency [Hz], and the standard deviation of one sample that is normal for the sensor.
    windows : sequence of Window
        Rest windows.
    """
    line, around = hum_amplitude(channel, mains, windows)
    if line <= max(SIGNIFICANT * around, HARMFUL * noise) or line == 0.0:
        return channel, ()
    ratio = line / max(around, np.finfo(float).tiny)
    text = f"hum of {line:.3g} {channel.unit} at {mains:g} Hz, {ratio:.0f} times its surroundings"
    span = ((float(channel.time[0]), float(channel.time[-1])),)
    finding = Finding(channel.name, "hum", text, spans=span, samples=channel.time.size)
    return channel.with_flags(np.ones(channel.time.size, dtype=bool), Flag.HUM), (finding,)
