"""What the spectrum of an analysed channel marks: orders with verdicts, levels, naturals, peaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.records.analysis import ChannelAnalysis, Peak
from tethertest.records.arrays import FloatArray, frozen
from tethertest.records.lines import Line, LineVerdict
from tethertest.records.response import NaturalFrequency
from tethertest.render.text import words
from tethertest.spectra.thomson import BlindSearch, peaks


@dataclass(frozen=True, slots=True)
class OrderMark:
    """One order of the drive; amplitudes as people read them."""

    frequency: float  #: [Hz]
    label: str  #: order and verdict
    found: bool  #: whether it is anything at all
    amplitude: float | None  #: with its interval, where one is known to stand there
    interval: tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class SpectrumMarks:
    """All marks of one spectrum, within its frequencies."""

    orders: tuple[OrderMark, ...]  #: by rising frequency
    naturals: tuple[NaturalFrequency, ...]  #: by rising frequency
    peaks: tuple[tuple[float, float], ...]  #: frequency and amplitude of those a blind search is sure of
    level_frequency: FloatArray  #: (n,) [Hz], rising
    level: FloatArray  #: (n,) amplitude from which a line is significant


def spectrum_marks(
    item: ChannelAnalysis,
    naturals: tuple[NaturalFrequency, ...],
    search: BlindSearch | None,
    factor: float,
    span: tuple[float, float],
) -> SpectrumMarks:
    """Return what to mark.

    Parameters
    ----------
    item : ChannelAnalysis
        The channel with its lines.
    naturals : tuple of NaturalFrequency
        Those known.
    search : BlindSearch or None
        Where there are no lines: it gives peaks and level.
    factor : float
        From SI to what is shown.
    span : tuple of float
        Least and greatest frequency shown [Hz].
    """
    low, high = span
    lines = () if item.lines is None else item.lines.lines
    shown = sorted((line for line in lines if low <= line.frequency <= high), key=lambda line: line.frequency)
    if lines or search is None:
        levels = [(line.frequency, line.significant_above) for line in shown if line.significant_above]
        at = np.array([frequency for frequency, _ in levels])
        level = np.array([above for _, above in levels])
    else:
        inside = (search.frequency >= low) & (search.frequency <= high)
        at, level = search.frequency[inside], search.significant_above[inside]
    blind = () if lines or search is None else peaks(search)
    known = sorted(naturals, key=lambda natural: natural.frequency)
    return SpectrumMarks(
        tuple(_order(line, factor) for line in shown),
        tuple(natural for natural in known if low <= natural.frequency <= high),
        tuple(_peak(peak, factor) for peak in blind if peak.significant and low <= peak.frequency <= high),
        frozen(at),
        frozen(factor * level),
    )


def _order(line: Line, factor: float) -> OrderMark:
    found = line.verdict is not LineVerdict.NONE
    measured = line.significant_above is not None and line.amplitude > 0.0
    return OrderMark(
        line.frequency,
        f"{line.order}  {words(line.verdict.value)}",
        found,
        factor * line.amplitude if found and measured else None,
        (factor * line.interval[0], factor * line.interval[1]),
    )


def _peak(peak: Peak, factor: float) -> tuple[float, float]:
    return peak.frequency, factor * peak.amplitude
