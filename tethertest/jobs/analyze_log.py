"""Lines and extremes of channels that belong to no run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tethertest.errors import DataError
from tethertest.jobs.analysis_options import (
    FALSE_LINES,
    FEWEST_PERIODS,
    Options,
    check_drive,
    named_naturals,
    window_asked,
)
from tethertest.jobs.bare_log import check_usable
from tethertest.jobs.reservations import reservations
from tethertest.records.analysis import MEASURED, Analysis, ChannelAnalysis, WaveFindings
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.lines import DriveFit, Expectation
from tethertest.signal.windows import find_steady
from tethertest.spectra import find_lines, fit_drive
from tethertest.spectra.cycles import count_cycles, extremes
from tethertest.spectra.resonances import resonance_notes
from tethertest.spectra.thomson import blind_search, peaks


def analyze_log(
    path: str, name: str, channels: Sequence[Channel], options: Options, remarks: Sequence[str] = ()
) -> Analysis:
    """Analyse channels that belong to no run.

    Without a drive frequency, each channel gets a blind search in the place of lines. Slack is not looked
    for: nobody knows the zero of a bare log.

    Raises
    ------
    DataError
        No steady window, or a drive that the channels cannot show.
    """
    for channel in channels:
        check_usable(channel)
    naturals = named_naturals(options)
    notes = list(remarks)
    window, drive = _log_window(channels, options), None
    if options.drive_frequency is not None:
        for channel in channels:
            check_drive(channel, window, options.drive_frequency)
        moved = [channel for channel in channels if channel.kind == "displacement"]
        # a limit cuts off tops, not their times
        timed = [replace(item, flags=item.flags & ~np.uint16(Flag.SATURATED)) for item in moved or channels]
        drive = fit_drive(timed, window, options.drive_frequency)
        notes += resonance_notes(drive.frequency, naturals)
    else:
        notes.append("no drive frequency given: a blind search for lines, without verdicts")
    told = Expectation(natural_frequencies=naturals, mains=options.mains)
    level = FALSE_LINES / len(channels)
    found = []
    for channel in channels:
        item = ChannelAnalysis(
            channel,
            MEASURED,
            no_events="slack needs the zero of the load cell, which a bare log does not tell",
            extremes=extremes(channel, window),
            cycles=count_cycles(channel, window) if channel.kind == "tension" else None,
        )
        if drive is None:
            item = replace(item, no_lines="no drive frequency", peaks=peaks(blind_search(channel, window)))
        else:
            item = _with_lines(item, window, drive, told, level, named=bool(options.channels))
        found.append(item)
    notes += reservations(found, motion=False)
    return Analysis(
        path, name, drive, window, tuple(found), naturals, options.mains, level, WaveFindings(), tuple(notes)
    )


def _log_window(channels: Sequence[Channel], options: Options) -> Window:
    first = min(float(channel.time[0]) for channel in channels)
    last = max(float(channel.time[-1]) for channel in channels)
    if options.window is not None:
        return window_asked(options.window, first, last)
    nominal = options.drive_frequency
    if nominal is None:
        return Window(first, last, "the whole record")
    for channel in sorted(channels, key=lambda channel: channel.kind != "displacement"):
        check_drive(channel, Window(first, last), nominal)
        steady = find_steady(channel, nominal)
        if steady is not None:
            return Window(*steady.span, f"steady in {channel.name}, {steady.cycles} periods")
    message = f"no channel holds {FEWEST_PERIODS:g} steady periods of {nominal:.4g} Hz in a row"
    raise DataError(message, "give a window by --window A:B, or correct --drive-frequency")


def _with_lines(
    item: ChannelAnalysis, window: Window, drive: DriveFit, told: Expectation, level: float, *, named: bool
) -> ChannelAnalysis:
    try:
        return replace(item, lines=find_lines(item.channel, window, drive, told, significance=level))
    except DataError as error:
        if named:
            raise
        return replace(item, no_lines=error.problem)
