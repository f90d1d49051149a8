"""Thomson's harmonic F test: which frequencies of a record hold a line, without a drive to go by."""

from __future__ import annotations

from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.analysis import Peak
from tethertest.records.channel import Channel, Window
from tethertest.signal.filters import filled

#: time-bandwidth product and number of the tapers
BANDWIDTH, TAPERS = 4.0, 7
#: zero-padding: points per 1/T
PADDING: Final = 4
#: chance of one false peak among all frequencies of a record
SIGNIFICANCE: Final = 0.01
#: a longer record is averaged down to about this many samples first
MOST_SAMPLES: Final = 1 << 16
FEWEST_SAMPLES: Final = 16


def peaks(channel: Channel, window: Window, most: int = 12) -> tuple[Peak, ...]:
    """Return the most significant lines of a window, at least the bandwidth W = 4/T apart.

    ``F = (K - 1) |mu|^2 sum |H_k|^2 / sum |J_k - mu H_k|^2`` follows F(2, 2K - 2) under noise.

    Parameters
    ----------
    channel : Channel
        Any kind; straight lines bridge samples that may not be used.
    window : Window
        The part to search.
    most : int
        Peaks returned at most.

    Returns
    -------
    tuple of Peak
        Those that are significant, by falling amplitude; where none is, the most significant one.

    Raises
    ------
    DataError
        Too few samples, or none that is usable.

    References
    ----------
    D. J. Thomson, Proc. IEEE 70 (1982) 1055-1096.
    """
    from scipy.signal.windows import dpss

    part = channel.between(window.start, window.stop)
    if part.time.size < FEWEST_SAMPLES:
        message = f"channel {channel.name!r}: {part.time.size} samples in the window"
        raise DataError(message, f"choose a window of at least {FEWEST_SAMPLES} samples")
    values, rate = filled(part), part.rate
    width = -(-values.size // MOST_SAMPLES)
    values = values[: values.size // width * width].reshape(-1, width).mean(axis=1)
    rate /= width
    count = values.size
    trend = np.polynomial.Polynomial.fit(np.arange(count), values, 1)
    values = values - trend(np.arange(count))
    if not np.any(values):
        return ()
    tapers = np.asarray(dpss(count, BANDWIDTH, TAPERS))
    size = PADDING * count
    spectra = np.fft.rfft(tapers * values, size, axis=1)
    sums = tapers.sum(axis=1)
    power = float(sums @ sums)
    mean = (sums @ spectra) / power
    left = np.sum(np.abs(spectra - sums[:, None] * mean) ** 2, axis=0)
    f_value = (TAPERS - 1) * np.abs(mean) ** 2 * power / np.maximum(left, np.finfo(np.float64).tiny)
    p_value = (1.0 + f_value / (TAPERS - 1)) ** (1 - TAPERS)  # survival of F(2, 2K - 2) in closed form
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    bandwidth = BANDWIDTH * rate / count
    usable = (frequency > bandwidth) & (frequency < 0.5 * rate - bandwidth)
    # padded frequencies overlap, but a line is tried at each of them
    tried = int(np.count_nonzero(usable))
    found: list[Peak] = []
    for index in np.argsort(np.where(usable, p_value, np.inf)):
        if not usable[index] or len(found) == most:
            break
        apart = all(abs(frequency[index] - peak.frequency) >= bandwidth for peak in found)
        significant = bool(p_value[index] * tried <= SIGNIFICANCE)
        if apart and (significant or not found):
            found.append(
                Peak(
                    float(frequency[index]),
                    2.0 * float(np.abs(mean[index])),
                    float(p_value[index]),
                    significant,
                )
            )
        if not significant:
            break
    return tuple(sorted(found, key=lambda peak: -peak.amplitude))
