"""The main job: a run folder of raw logs becomes a validation report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tethertest.compare import compare
from tethertest.conditioning import stated_findings
from tethertest.errors import DataError
from tethertest.pipeline.analysis_options import FALSE_LINES_OF_RUN
from tethertest.pipeline.conditioned import conditioned, placed, read_logs
from tethertest.pipeline.expect import expectation
from tethertest.pipeline.provenance import provenance
from tethertest.pipeline.run_drive import MOTION, drive_channels, run_crank, run_drive
from tethertest.readers import load_prototype_of, load_run
from tethertest.records.channel import Channel, ConditionedRun, RawLog, Window
from tethertest.records.lines import ChannelLines, DriveFit, Event
from tethertest.records.report import Report
from tethertest.records.response import Response
from tethertest.records.rig import Prototype
from tethertest.records.run import Run
from tethertest.records.scene import Scene
from tethertest.records.similarity import Similarity
from tethertest.replay import (
    BottomMotion,
    bottom_motion,
    replayed_channels,
    rest_tensions,
    run_scene,
    variations,
)
from tethertest.similitude import similarity
from tethertest.solver import FIRST_MESH, solve
from tethertest.spectra import find_events, find_lines

#: finest mesh of a replay; a snap on the rig is not better known than this
_FINEST_MESH = 40


@dataclass(frozen=True, slots=True, eq=False)
class _Replay:
    """The replayed side of a run."""

    scene: Scene
    motion: BottomMotion
    response: Response
    channels: tuple[Channel, ...]
    moved: tuple[tuple[Channel, ...], ...]  #: nominal first, then one parameter moved at a time


def make_report(folder: Path, rigs: Path | None = None) -> Report:
    """Run the whole chain on one run folder.

    Parameters
    ----------
    folder : Path
        Run folder with run.toml and raw logs.
    rigs : Path, optional
        Folder of rig files; found upwards from the run folder if absent.

    Raises
    ------
    TethertestError
        Anything in the files that the user can mend.
    """
    run = load_run(folder, rigs)
    prototype = load_prototype_of(run.rig, run.rig_path)
    logs = read_logs(run)
    try:
        return _reported(run, prototype, logs)
    except DataError as error:
        raise placed(error, run) from error


def _reported(run: Run, prototype: Prototype | None, logs: Mapping[str, RawLog]) -> Report:
    measured = conditioned(run, logs)
    drive = _drive(run, measured)
    measured = replace(measured, findings=(*measured.findings, *stated_findings(run, measured, drive)))
    replayed = _replay(run, measured, drive)
    lines, replayed_lines = _lines(run, measured, replayed, drive)
    comparison = compare(
        measured,
        replayed.channels if replayed else (),
        lines,
        replayed_lines,
        run.rig.limits,
        variations=replayed.moved if replayed else (),
        static=rest_tensions(run.rig),
    )
    if replayed is not None:
        first, *others = comparison.reasons
        comparison = replace(comparison, reasons=(first, *replayed.response.warnings, *others))
    return Report(
        run=run,
        measured=measured,
        response=replayed.response if replayed else None,
        replayed=replayed.channels if replayed else (),
        drive=drive,
        measured_lines=lines,
        replayed_lines=replayed_lines,
        events=_events(measured.channels),
        replayed_events=_events(replayed.channels if replayed else ()),
        comparison=comparison,
        similarity=_similarity(run, prototype, drive),
        provenance=provenance(run, logs, _settings(replayed)),
    )


def _drive(run: Run, measured: ConditionedRun) -> DriveFit | None:
    if run.file.drive.kind == "none" or run.file.drive.frequency is None or measured.steady is None:
        return None
    return run_drive(measured, drive_channels(measured), measured.steady, run.file.drive.frequency)


def _replay(run: Run, measured: ConditionedRun, drive: DriveFit | None) -> _Replay | None:
    heave = measured.channel(MOTION)
    if heave is None:
        return None
    motion = bottom_motion(
        heave,
        frequency=None if drive is None else drive.frequency,
        rest_before=measured.rest_before,
        steady=measured.steady,
    )
    scene = run_scene(run, motion.duration)
    response = solve(scene, measured=motion.motion, finest=_FINEST_MESH)
    channels = replayed_channels(response, motion.start, measured.channels)
    moved: tuple[tuple[Channel, ...], ...] = ()
    if drive is not None:
        coarser = max(FIRST_MESH, response.cells // 2)
        varied = variations(run, motion, measured.channels, coarser, response.fidelity)
        moved = tuple(variation.channels for variation in varied)
    return _Replay(scene, motion, response, channels, moved)


def _lines(
    run: Run, measured: ConditionedRun, replayed: _Replay | None, drive: DriveFit | None
) -> tuple[tuple[ChannelLines, ...], tuple[ChannelLines, ...]]:
    if drive is None or measured.steady is None or replayed is None:
        return (), ()
    window = measured.steady
    scene = replayed.scene
    heave = measured.channel(MOTION)
    crank = run_crank(measured, window, drive)
    motion = None
    found: list[ChannelLines] = []
    if heave is not None:
        told = expectation(run, scene, heave, drive.frequency, None)
        motion = find_lines(heave, window, drive, told, crank=crank)
        found.append(motion)

    def search(channels: tuple[Channel, ...]) -> tuple[ChannelLines, ...]:
        searched = [c for c in channels if c.kind in {"tension", "strain"} and _covers(c, window)]
        return tuple(
            find_lines(
                channel,
                window,
                drive,
                expectation(run, scene, channel, drive.frequency, motion),
                significance=FALSE_LINES_OF_RUN / len(searched),
                crank=crank,
            )
            for channel in searched
        )

    return (*found, *search(measured.channels)), search(replayed.channels)


def _covers(channel: Channel, window: Window) -> bool:
    part = channel.between(window.start, window.stop)
    return bool(np.count_nonzero(part.usable) > 0.5 * window.length * channel.rate)


def _events(channels: tuple[Channel, ...]) -> tuple[Event, ...]:
    return tuple(event for channel in channels if channel.kind == "tension" for event in find_events(channel))


def _similarity(run: Run, prototype: Prototype | None, drive: DriveFit | None) -> Similarity | None:
    frequency = drive.frequency if drive is not None else run.file.drive.frequency
    amplitude = run.file.drive.radius or run.file.drive.amplitude
    if prototype is None or frequency is None or not amplitude:
        return None
    return similarity(run.rig, prototype, frequency, amplitude, run.file.platform.mode)


def _settings(replayed: _Replay | None) -> dict[str, str]:
    if replayed is None:
        return {}
    return {
        "motion cut-off": f"{replayed.motion.cutoff:.4g} Hz",
        "motion cut-off where sudden": f"{replayed.motion.wide_cutoff:.4g} Hz",
    }
