"""Thomson's harmonic F test: which frequencies of a record hold a line, without a drive to go by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.analysis import Peak
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.signal.filters import filled
from tethertest.spectra.multitaper import BANDWIDTH, f_value_at, harmonic_test, tapers

#: zero-padding: points per 1/T
PADDING: Final = 4
#: chance of one false peak among all frequencies of a record
SIGNIFICANCE: Final = 0.01
#: a longer record is averaged down to about this many samples first
MOST_SAMPLES: Final = 1 << 16
FEWEST_SAMPLES: Final = 16


@dataclass(frozen=True, slots=True, eq=False)
class BlindSearch:
    """The harmonic F test at all frequencies of a record."""

    frequency: FloatArray  #: (m,) [Hz]
    amplitude: FloatArray  #: (m,) peak of a cosine, in the channel's unit
    p_value: FloatArray  #: (m,) of each frequency alone
    significant_above: FloatArray  #: (m,) amplitude from which a line is significant over all of them
    bandwidth: float  #: [Hz], W = 4/T: lines closer than this are one

    @property
    def significant(self) -> BoolArray:
        """(m,) True where a line is significant over all frequencies."""
        found: BoolArray = self.p_value * self.frequency.size <= SIGNIFICANCE
        return found


def blind_search(channel: Channel, window: Window) -> BlindSearch:
    """Return the harmonic F test of a window at all frequencies between W and half the rate less W.

    Parameters
    ----------
    channel : Channel
        Any kind; straight lines bridge samples that may not be used.
    window : Window
        The part to search.

    Returns
    -------
    BlindSearch
        Without any frequency where the channel stands still.

    Raises
    ------
    DataError
        Too few samples, or none that is usable.

    References
    ----------
    D. J. Thomson, Proc. IEEE 70 (1982) 1055-1096.
    """
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
    bandwidth = BANDWIDTH * rate / count
    nothing = np.empty(0)
    if not np.any(values):
        return BlindSearch(nothing, nothing, nothing, nothing, bandwidth)
    shapes = tapers(count)
    frequency = np.fft.rfftfreq(PADDING * count, 1.0 / rate)
    inside = (frequency > bandwidth) & (frequency < 0.5 * rate - bandwidth)
    transforms = np.fft.rfft(shapes * values, PADDING * count, axis=1)
    test = harmonic_test(transforms[:, inside], shapes.sum(axis=1))
    # padded frequencies overlap, but a line is tried at each of them
    needed = f_value_at(SIGNIFICANCE / max(1, int(np.count_nonzero(inside))))
    return BlindSearch(
        frequency[inside],
        2.0 * np.abs(test.mean),
        test.p_value,
        float(np.sqrt(needed)) * test.at_unit_f,
        bandwidth,
    )


def peaks(search: BlindSearch, most: int = 12) -> tuple[Peak, ...]:
    """Return the most significant lines of a blind search, at least the bandwidth apart.

    Parameters
    ----------
    search : BlindSearch
        The test at all frequencies.
    most : int
        Peaks returned at most.

    Returns
    -------
    tuple of Peak
        Those that are significant, by falling amplitude; where none is, the most significant one.
    """
    found: list[Peak] = []
    significant = search.significant
    for index in np.argsort(search.p_value):
        if len(found) == most or (found and not significant[index]):
            break
        frequency = float(search.frequency[index])
        if all(abs(frequency - peak.frequency) >= search.bandwidth for peak in found):
            amplitude, p_value = float(search.amplitude[index]), float(search.p_value[index])
            found.append(Peak(frequency, amplitude, p_value, bool(significant[index])))
    return tuple(sorted(found, key=lambda peak: -peak.amplitude))
