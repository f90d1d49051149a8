"""Lines, events and waves of a run folder, a run store or a bare log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from tethertest.conditioning import drive_findings
from tethertest.errors import DataError, TethertestError
from tethertest.pipeline.analysis_options import (
    FALSE_LINES_OF_RUN,
    Options,
    check_drive,
    named_naturals,
    window_asked,
)
from tethertest.pipeline.analyze_log import analyze_log
from tethertest.pipeline.bare_log import bare_channels, check_usable
from tethertest.pipeline.conditioned import conditioned, placed, read_logs
from tethertest.pipeline.expect import expectation
from tethertest.pipeline.read_bare import settings_of_a_run
from tethertest.pipeline.reservations import reservations
from tethertest.pipeline.run_drive import MOTION, drive_channels, run_crank, run_drive
from tethertest.pipeline.stored import run_of
from tethertest.pipeline.wave_findings import measured_waves, medium_of, pattern_remarks, replayed_waves
from tethertest.readers import load_run
from tethertest.records.analysis import MEASURED, REPLAYED, Analysis, ChannelAnalysis
from tethertest.records.channel import Channel, ConditionedRun, Window
from tethertest.records.lines import ChannelLines, DriveFit
from tethertest.records.response import NaturalFrequency, Response
from tethertest.records.run import Run
from tethertest.records.scene import Scene
from tethertest.replay import BottomMotion, bottom_motion, replayed_channels, run_scene
from tethertest.solver import modes, solve
from tethertest.spectra import find_events, find_lines
from tethertest.spectra.crank_angle import CrankAngle
from tethertest.spectra.cycles import count_cycles, extremes
from tethertest.spectra.resonances import resonance_notes
from tethertest.spectra.snaps import measured_snaps
from tethertest.spectra.waves import Medium
from tethertest.store import is_store, load_store

#: kinds of channels of a run that are analysed unless others are named
KINDS: Final = ("tension", "strain", "displacement")
#: finest mesh of a replay; a snap on the rig is not better known than this
FINEST_MESH: Final = 40


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
    if options.settings and (path.is_dir() or (path.is_file() and is_store(path))):
        raise settings_of_a_run(path)
    if path.is_dir():
        if not (path / "run.toml").is_file():
            message = "the folder has no run.toml"
            remedy = "name a run folder, a run store or a log; --across takes a folder of runs"
            raise TethertestError(message, remedy, path=path)
        run = load_run(path, options.rigs)
        try:
            return analyze_run(str(path), run, conditioned(run, read_logs(run)), options)
        except DataError as error:
            raise placed(error, run) from error
    if path.is_file() and is_store(path):
        stored = load_store(path)
        try:
            return analyze_run(str(path), run_of(stored.header, path), stored.measured, options)
        except DataError as error:
            raise error.located(path) from error
    if options.replay:
        message = "--replay: a log that belongs to no run cannot be replayed"
        raise DataError(message, "name a run folder with run.toml", path=path)
    channels, remarks = bare_channels(path, options.channels, options.settings)
    try:
        return analyze_log(str(path), path.name, channels, options, remarks)
    except DataError as error:
        raise error.located(path) from error


def analyze_run(path: str, run: Run, measured: ConditionedRun, options: Options) -> Analysis:
    """Analyse the conditioned channels of a run and, if asked, its replayed ones by the same functions.

    Raises
    ------
    DataError
        No such channel, no steady window, or a run that cannot be replayed.
    """
    heave = measured.channel(MOTION)
    spans = [channel.time[[0, -1]] for channel in measured.channels]
    duration = max(float(span[1]) for span in spans) - min(float(span[0]) for span in spans)
    scene = run_scene(run, duration)
    naturals = _run_naturals(run, scene, options)
    wanted = _wanted(measured, options)
    nominal = options.drive_frequency
    if nominal is None and run.file.drive.kind != "none":
        nominal = run.file.drive.frequency
    window = _run_window(measured, options, nominal)
    drive = _run_drive(measured, wanted, window, nominal)
    seen = (*measured.findings, *drive_findings(run, measured, drive))
    notes = [f"{f.subject}: {f.text}" for f in seen if f.severity != "note"]
    motion = crank = None
    if drive is not None and window is not None and heave is not None:
        crank = run_crank(measured, window, drive)
        motion = _lines_of(run, scene, heave, window, drive, None, options, FALSE_LINES_OF_RUN, crank)
    medium = medium_of(scene, run.rig)
    level = FALSE_LINES_OF_RUN / max(1, len(wanted))

    def analysed(channel: Channel, side: str) -> ChannelAnalysis:
        item = _with_events(ChannelAnalysis(channel, side), window, medium)
        if drive is None or window is None:
            return replace(item, no_lines="no drive")
        try:
            lines = _lines_of(run, scene, channel, window, drive, motion, options, level, crank)
        except DataError as error:
            if channel.name in options.channels and side == MEASURED:
                raise
            return replace(item, no_lines=error.problem)
        return replace(item, lines=lines)

    found = [analysed(channel, MEASURED) for channel in wanted]
    waves = measured_waves(
        measured,
        [item.lines for item in found if item.lines is not None],
        [event for item in found for event in item.events],
        window,
        scene,
        run.rig,
    )
    if options.replay:
        replayed, motion_used = replayed_response(run, measured, drive)
        found += [
            analysed(channel, REPLAYED) for channel in replayed_channels(replayed, motion_used.start, wanted)
        ]
        other = replayed_waves(replayed, motion_used.start, drive, window, run.rig)
        waves = replace(
            waves,
            parts=(*waves.parts, *other.parts),
            largest=other.largest,
            remarks=(*waves.remarks, *other.remarks, *replayed.warnings),
        )
        if replayed.status.name != "OK":
            notes.append(f"replay: {replayed.status.value}")
    notes += reservations(found, motion=motion is not None)
    if drive is None:
        notes.append("no drive: no lines were looked for")
    else:
        notes += resonance_notes(drive.frequency, naturals, _modulation(found, scene))
        short = pattern_remarks(waves, medium, drive.frequency)
        waves = replace(waves, remarks=(*waves.remarks, *short))
    return Analysis(
        path,
        run.file.id,
        drive,
        window,
        tuple(found),
        naturals,
        options.mains,
        level,
        waves,
        tuple(notes),
    )


def replayed_response(
    run: Run, measured: ConditionedRun, drive: DriveFit | None
) -> tuple[Response, BottomMotion]:
    """Solve a run's own scene, driven by its measured bottom motion, with the velocity at its gauges.

    Raises
    ------
    DataError
        The run has no bottom motion.
    """
    heave = measured.channel(MOTION)
    if heave is None:
        message = "the run has no channel 'heave', so its bottom motion is not known"
        raise DataError(message, "add the encoder's log to run.toml, or leave out --replay")
    motion = bottom_motion(
        heave,
        frequency=None if drive is None else drive.frequency,
        rest_before=measured.rest_before,
        steady=measured.steady,
    )
    scene = run_scene(run, motion.duration)
    scene = replace(scene, output=replace(scene.output, fields=("velocity",)))
    return solve(scene, measured=motion.motion, finest=FINEST_MESH), motion


def _wanted(measured: ConditionedRun, options: Options) -> tuple[Channel, ...]:
    names = [channel.name for channel in measured.channels]
    for name in options.channels:
        if name not in names:
            message = f"there is no channel {name!r}; the run has {', '.join(names)}"
            raise DataError(message, "give --channel one of these names")
        check_usable(next(channel for channel in measured.channels if channel.name == name))
    if options.channels:
        return tuple(channel for channel in measured.channels if channel.name in options.channels)
    return tuple(channel for channel in measured.channels if channel.kind in KINDS and channel.usable.any())


def _run_window(measured: ConditionedRun, options: Options, nominal: float | None) -> Window | None:
    if options.window is not None:
        first = min(float(channel.time[0]) for channel in measured.channels)
        last = max(float(channel.time[-1]) for channel in measured.channels)
        return window_asked(options.window, first, last)
    if nominal is None or measured.steady is not None:
        return measured.steady
    message = f"no steady window of {nominal:.4g} Hz was found"
    raise DataError(message, "give one by --window A:B, or under [windows] steady in run.toml")


def _run_drive(
    measured: ConditionedRun, wanted: Sequence[Channel], window: Window | None, nominal: float | None
) -> DriveFit | None:
    if nominal is None or window is None:
        return None
    channels = drive_channels(measured, wanted)
    for channel in channels:
        check_drive(channel, window, nominal)
    return run_drive(measured, channels, window, nominal)


def _lines_of(
    run: Run,
    scene: Scene,
    channel: Channel,
    window: Window,
    drive: DriveFit,
    motion: ChannelLines | None,
    options: Options,
    level: float,
    crank: CrankAngle | None,
) -> ChannelLines:
    known = channel.name if motion is not None else None
    if motion is not None and known == motion.channel:
        return motion
    told = expectation(run, scene, channel, drive.frequency, motion)
    told = replace(
        told,
        natural_frequencies=(*told.natural_frequencies, *named_naturals(options)),
        mains=options.mains,
    )
    return find_lines(channel, window, drive, told, significance=level, crank=crank)


def _with_events(item: ChannelAnalysis, window: Window | None, medium: Medium) -> ChannelAnalysis:
    channel = item.channel
    part = channel if window is None else channel.between(window.start, window.stop)
    if not part.usable.any():
        return replace(item, no_events="no usable sample in the window")
    item = replace(item, extremes=extremes(channel, window))
    if channel.kind != "tension":
        return item
    events = find_events(channel)
    return replace(
        item,
        events=events,
        snaps=measured_snaps(channel, events, medium),
        cycles=count_cycles(channel, window),
    )


def _run_naturals(run: Run, scene: Scene, options: Options) -> tuple[NaturalFrequency, ...]:
    return (*modes(scene).frequencies, *named_naturals(options))


def _modulation(found: Sequence[ChannelAnalysis], scene: Scene) -> float | None:
    """Return the largest amplitude of the tension at the drive over the tension at rest."""
    rest = scene.top.static_tension
    first = [
        line.amplitude
        for item in found
        if item.channel.kind == "tension" and item.lines and (line := item.lines.line("1")) is not None
    ]
    return max(first) / rest if first and rest else None
