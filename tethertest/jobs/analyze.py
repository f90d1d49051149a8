"""Lines, events and waves of a run folder, a run store or a bare log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from tethertest.conditioning.stated import CALIBRATION
from tethertest.errors import DataError, TethertestError
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.analyze_log import analyze_log
from tethertest.jobs.bare_log import bare_channels, check_usable
from tethertest.jobs.evaluation import Evaluation, open_evaluation
from tethertest.jobs.read_bare import settings_of_a_run
from tethertest.jobs.reservations import reservations
from tethertest.jobs.wave_findings import measured_waves, pattern_remarks, replayed_waves
from tethertest.records.analysis import REPLAYED, Analysis, ChannelAnalysis
from tethertest.records.channel import Channel, ConditionedRun, Severity, Window
from tethertest.records.response import Response
from tethertest.records.scene import Scene
from tethertest.spectra.cycles import count_cycles, extremes
from tethertest.spectra.resonances import resonance_notes
from tethertest.store import is_store

#: kinds of channels of a run that are analysed unless others are named
KINDS: Final = ("tension", "strain", "displacement")


def analyze(path: Path, options: Options) -> Analysis:
    """Analyse a run folder, a run store or a bare log.

    Parameters
    ----------
    path : Path
        Folder with run.toml, store as ``ingest`` writes it, or any log that can be read.
    options : Options
        What to look at and what is known beforehand.

    Raises
    ------
    TethertestError
        The path cannot be read, or cannot be analysed as asked.
    """
    if is_run(path):
        if options.settings:
            raise settings_of_a_run(path)
        evaluation = open_evaluation(path, options)
        with evaluation.errors_placed():
            return analyze_run(str(path), evaluation, options.channels, replay=options.replay)
    if path.is_dir():
        message = "the folder has no run.toml"
        remedy = "name a run folder, a run store or a log; --across takes a folder of runs"
        raise TethertestError(message, remedy, path=path)
    if options.replay:
        message = "--replay: a log that belongs to no run cannot be replayed"
        raise DataError(message, "name a run folder with run.toml", path=path)
    channels, remarks = bare_channels(path, options.channels, options.settings)
    try:
        return analyze_log(str(path), path.name, channels, options, remarks)
    except DataError as error:
        raise error.located(path) from error


def is_run(path: Path) -> bool:
    """Tell whether a path is a run folder or a run store."""
    return (path / "run.toml").is_file() if path.is_dir() else path.is_file() and is_store(path)


def analyze_run(
    path: str, evaluation: Evaluation, channels: Sequence[str] = (), *, replay: bool = False
) -> Analysis:
    """Return what a run's evaluation found, with extremes, load cycles, snaps and waves.

    Parameters
    ----------
    path : str
        Of the run folder or store, as it was given.
    evaluation : Evaluation
        Of the run.
    channels : sequence of str
        Names; all that fit where empty.
    replay : bool
        Analyse the replayed channels too.

    Raises
    ------
    DataError
        No such channel, no steady window, or a run that cannot be replayed.
    """
    measured = evaluation.measured
    wanted = _wanted(measured, channels)
    _check_window(evaluation)
    window, drive = evaluation.window, evaluation.drive
    notes = [
        f"{finding.subject}: {finding.text}"
        for finding in measured.findings
        if finding.severity != Severity.NOTE and finding.kind != CALIBRATION
    ]
    found = [
        _with_measures(_searched(evaluation, channel, named=channel.name in channels), window)
        for channel in wanted
    ]
    waves = measured_waves(
        measured,
        [item.lines for item in found if item.lines is not None],
        [event for item in found for event in item.events],
        window,
        evaluation.scene,
        evaluation.run.rig,
    )
    if replay:
        response, start = _replay(evaluation)
        names = {channel.name for channel in wanted}
        found += [
            _with_measures(evaluation.found(channel, REPLAYED), window)
            for channel in evaluation.replayed
            if channel.name in names
        ]
        other = replayed_waves(response, start, drive, window, evaluation.run.rig)
        waves = replace(
            waves,
            parts=(*waves.parts, *other.parts),
            largest=other.largest,
            remarks=(*waves.remarks, *other.remarks, *response.warnings),
        )
        if response.status.name != "OK":
            notes.append(f"replay: {response.status.value}")
    notes += reservations(found, motion=evaluation.motion_lines is not None)
    if drive is None:
        notes.append("no drive: no lines were looked for")
    else:
        modulation = _modulation(found, evaluation.scene)
        notes += resonance_notes(drive.frequency, evaluation.natural_frequencies, modulation)
        short = pattern_remarks(waves, evaluation.medium, drive.frequency)
        waves = replace(waves, remarks=(*waves.remarks, *short))
    return Analysis(
        path,
        evaluation.run.file.id,
        drive,
        window,
        tuple(found),
        evaluation.natural_frequencies,
        evaluation.options.mains,
        evaluation.significance,
        waves,
        tuple(notes),
    )


def _replay(evaluation: Evaluation) -> tuple[Response, float]:
    """Return the replay and the run's time at its start [s]."""
    if evaluation.response is None or evaluation.motion is None:
        message = "the run has no displacement channel at its bottom, so its motion is not known"
        raise DataError(message, "add the encoder's log to run.toml, or leave out --replay")
    return evaluation.response, evaluation.motion.start


def _wanted(measured: ConditionedRun, named: Sequence[str]) -> tuple[Channel, ...]:
    names = [channel.name for channel in measured.channels]
    for name in named:
        if name not in names:
            message = f"there is no channel {name!r}; the run has {', '.join(names)}"
            raise DataError(message, "give --channel one of these names")
        check_usable(next(channel for channel in measured.channels if channel.name == name))
    if named:
        return tuple(channel for channel in measured.channels if channel.name in named)
    return tuple(channel for channel in measured.channels if channel.kind in KINDS and channel.usable.any())


def _check_window(evaluation: Evaluation) -> None:
    if evaluation.nominal is not None and evaluation.window is None:
        message = f"no steady window of {evaluation.nominal:.4g} Hz was found"
        raise DataError(message, "give one by --window A:B, or under [windows] steady in run.toml")


def _searched(evaluation: Evaluation, channel: Channel, *, named: bool) -> ChannelAnalysis:
    """Return what was found in a channel; one that was asked for by name must show its lines."""
    item = evaluation.found(channel)
    if item.no_lines and evaluation.drive is not None and named:
        message = f"channel {channel.name!r} shows no lines: {item.no_lines}"
        raise DataError(message, "give another --window, or leave the channel out")
    return item


def _with_measures(item: ChannelAnalysis, window: Window | None) -> ChannelAnalysis:
    """Return the analysis of a channel with its extremes and, of a tension, its load cycles."""
    channel = item.channel
    part = channel if window is None else channel.between(window.start, window.stop)
    if not part.usable.any():
        return replace(item, no_events=item.no_events or "no usable sample in the window")
    item = replace(item, extremes=extremes(channel, window))
    return replace(item, cycles=count_cycles(channel, window)) if channel.kind == "tension" else item


def _modulation(found: Sequence[ChannelAnalysis], scene: Scene) -> float | None:
    """Return the largest amplitude of the tension at the drive over the tension at rest."""
    rest = scene.top.static_tension
    first = [
        line.amplitude
        for item in found
        if item.channel.kind == "tension" and item.lines and (line := item.lines.line("1")) is not None
    ]
    return max(first) / rest if first and rest else None
