"""Amplitude spectra for figures; verdicts rest on `tethertest.spectra.lines`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.channel import Channel, Window
from tethertest.signal.filters import filled_reader
from tethertest.signal.passes import LONGEST

#: a spectrum of fewer samples shows nothing
FEWEST_SAMPLES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """One-sided amplitude spectrum; a cosine between two frequencies shows at 85 % of its peak or more."""

    channel: str
    unit: str
    frequency: FloatArray  #: (m,) [Hz], from zero to half the rate
    amplitude: FloatArray  #: (m,) peak of a cosine, in `unit`; at zero the value left of the mean
    resolution: float  #: [Hz], 1/T


def spectrum(channel: Channel, window: Window) -> Spectrum:
    """Return the amplitude spectrum of a window, mean removed, Hann window scaled to the peak of a cosine.

    Parameters
    ----------
    channel : Channel
        Measured or replayed; straight lines bridge samples that may not be used.
    window : Window
        The part to transform.

    Returns
    -------
    Spectrum
        At the frequencies of the plain transform, without zero-padding. A window of more than `LONGEST`
        samples is cut into equal spans, whose power is averaged.

    Raises
    ------
    DataError
        The window holds fewer than eight samples or none that is usable.
    """
    part = channel.between(window.start, window.stop)
    if part.time.size < FEWEST_SAMPLES:
        message = (
            f"channel {channel.name!r}: {part.time.size} samples in the window, expected {FEWEST_SAMPLES}"
        )
        raise DataError(message, "choose a longer window")
    read = filled_reader(part)
    spans = -(-part.time.size // LONGEST)
    count = part.time.size // spans
    found = [_amplitude(read(start, start + count)) for start in range(0, spans * count, count)]
    amplitude = found[0] if spans == 1 else np.sqrt(np.mean(np.square(found), axis=0))
    frequency = np.fft.rfftfreq(count, 1.0 / part.rate)
    return Spectrum(channel.name, channel.unit, frozen(frequency), frozen(amplitude), part.rate / count)


def _amplitude(values: FloatArray) -> FloatArray:
    taper = np.sin(np.pi * (np.arange(values.size) + 0.5) / values.size) ** 2
    transform = np.fft.rfft(taper * (values - values.mean()))
    return np.asarray(2.0 * np.abs(transform) / taper.sum())
