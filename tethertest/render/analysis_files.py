"""The folder of an analysis: page, numbers and figures, composed first, then written."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from tethertest.errors import DataError
from tethertest.records.analysis import MEASURED, Analysis, ChannelAnalysis
from tethertest.records.channel import Window
from tethertest.render.analysis import analysis_summary
from tethertest.render.as_json import json_text
from tethertest.render.order_table import analysis_page, order_rows
from tethertest.render.scales import scale_for
from tethertest.render.write import write_files
from tethertest.spectra.order_spectrogram import order_spectrogram
from tethertest.spectra.phase_portrait import portrait
from tethertest.spectra.spectrum import spectrum
from tethertest.spectra.thomson import blind_search

SUMMARY_NAME, PAGE_NAME, TABLE_NAME = "analysis.json", "analysis.md", "orders.csv"
#: the spectrum begins at this part of the drive frequency, or at so many 1/T
_LOWEST_ORDER, _LOWEST_CYCLES = 0.2, 2.0


def write_analysis(analysis: Analysis, folder: Path) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """Write the figures, the orders and all numbers of an analysis.

    Parameters
    ----------
    analysis : Analysis
        The same analysis gives the same bytes.
    folder : Path
        Output folder, made if it does not exist.

    Returns
    -------
    paths : tuple of Path
        What was written.
    left_out : tuple of str
        Figures that could not be drawn, with the reason.

    Raises
    ------
    TethertestError
        The folder cannot be made or written; nothing is left half-written.
    """
    figures: dict[str, bytes] = {}
    shown: list[tuple[ChannelAnalysis, tuple[str, ...]]] = []
    left_out: list[str] = []
    used: set[str] = set()
    for item in analysis.channels:
        drawn = _figures(item, analysis, _file_name(item, used), left_out)
        figures.update(drawn)
        shown.append((item, tuple(drawn)))
    contents = {
        PAGE_NAME: analysis_page(analysis, shown, left_out).encode("utf-8"),
        SUMMARY_NAME: json_text(analysis_summary(analysis, tuple(left_out)), indent=1).encode(),
    }
    if any(item.lines is not None for item in analysis.channels):
        contents[TABLE_NAME] = order_rows(analysis).encode("utf-8")
    return write_files(folder, {**contents, **figures}), tuple(left_out)


def _figures(item: ChannelAnalysis, analysis: Analysis, name: str, left_out: list[str]) -> dict[str, bytes]:
    from tethertest.render.figures.analysis import portrait_figure, spectrogram_figure

    channel, drive = item.channel, analysis.drive
    window = analysis.window or Window(float(channel.time[0]), float(channel.time[-1]), "the whole record")
    makers: dict[str, Callable[[], bytes]] = {"spectrum": lambda: _spectrum(item, analysis, window)}
    if drive is not None:
        at = drive.frequency
        makers["portrait"] = lambda: portrait_figure(item, portrait(channel, window, at)).png
        makers["spectrogram"] = lambda: spectrogram_figure(item, order_spectrogram(channel, at), window).png
    made: dict[str, bytes] = {}
    for kind, make in makers.items():
        try:
            made[f"{name}-{kind}.png"] = make()
        except DataError as error:
            left_out.append(f"{name}: no {kind}: {error.problem}")
    return made


def _spectrum(item: ChannelAnalysis, analysis: Analysis, window: Window) -> bytes:
    from tethertest.render.figures.analysis import spectrum_figure
    from tethertest.render.figures.marks import spectrum_marks

    channel, drive = item.channel, analysis.drive
    found = spectrum(channel, window)
    search = blind_search(channel, window) if item.lines is None else None
    low = _LOWEST_CYCLES * found.resolution if drive is None else _LOWEST_ORDER * drive.frequency
    span = (max(low, found.resolution), float(found.frequency[-1]))
    factor = scale_for(channel.kind, channel.unit).factor
    marks = spectrum_marks(item, analysis.natural_frequencies, search, factor, span)
    return spectrum_figure(item, found, window, marks, span).png


def _file_name(item: ChannelAnalysis, used: set[str]) -> str:
    """Return a name that any file system takes and no other channel has, also where case does not count."""
    plain = re.sub(r"[^A-Za-z0-9_.-]+", "_", item.channel.name).strip("._-")[:80] or "channel"
    plain = plain if item.side == MEASURED else f"{plain}-{item.side}"
    name, number = plain, 1
    while name.casefold() in used:
        number += 1
        name = f"{plain}-{number}"
    used.add(name.casefold())
    return name
