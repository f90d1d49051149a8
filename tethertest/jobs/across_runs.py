"""What each run of a folder contributes to curves over many runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.conditioning.stated import AMPLITUDE, CALIBRATION, NOT_STATED
from tethertest.errors import DataError, TethertestError
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.analyze import analyze_run
from tethertest.jobs.evaluation import Evaluation, open_evaluation
from tethertest.records.across import RunChannel, RunPart
from tethertest.records.analysis import ChannelAnalysis
from tethertest.records.channel import Channel, Severity, Window
from tethertest.records.lines import ChannelLines
from tethertest.records.run import Run
from tethertest.spectra import spectrum
from tethertest.store import is_store

#: kinds of channels that get curves; the motion is the setting they are drawn against
KINDS: Final = ("tension", "strain")
#: share of a window's samples that may be unusable before a channel's amplitude is shown and not judged
_FEW_UNUSABLE: Final = 0.01
#: a spectrum is kept up to this multiple of the drive
_HIGHEST_ORDER: Final = 8.0
_STORES: Final = (".h5", ".hdf5")


def members(folder: Path) -> tuple[Path, ...]:
    """Return the run folders and run stores below a folder, by path.

    Raises
    ------
    TethertestError
        There is none, or the folder is itself a run.
    """
    if not folder.is_dir():
        message = "--across: found a file, expected a folder of runs" if folder.exists() else "no such folder"
        raise TethertestError(message, "name a folder that holds run folders", path=folder)
    if (folder / "run.toml").is_file():
        message = "--across: the folder is one run"
        raise TethertestError(message, "name the folder above it, or leave out --across", path=folder)
    folders = [path.parent for path in folder.rglob("run.toml")]
    stores = [
        path for path in folder.rglob("*") if path.suffix in _STORES and path.is_file() and is_store(path)
    ]
    found = (*sorted(folders), *sorted(stores))
    if not found:
        message = "--across: no run folder and no run store below it"
        raise TethertestError(message, "name a folder whose folders hold a run.toml each", path=folder)
    return found


def run_parts(
    paths: Sequence[Path], options: Options, jobs: int, done: Callable[[], None]
) -> tuple[RunPart, ...]:
    """Analyse runs, in the order of time; a run that cannot be analysed says why.

    Parameters
    ----------
    paths : sequence of Path
        Run folders and stores.
    options : Options
        As for one run.
    jobs : int
        Processes, of one core each.
    done : callable
        Called once after each run.
    """
    parts: list[RunPart] = []
    if jobs == 1 or len(paths) == 1:
        for path in paths:
            parts.append(run_part(path, options))
            done()
    else:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        # a fork of a process that has threads may hang
        with ProcessPoolExecutor(min(jobs, len(paths)), get_context("spawn")) as pool:
            for part in pool.map(run_part, paths, [options] * len(paths)):
                parts.append(part)
                done()
    first: dict[str, str] = {}
    for place, part in enumerate(parts):
        known = first.setdefault(part.run, part.path)
        if known != part.path and not part.refused:
            parts[place] = replace(part, refused=f"has the id of {known}, which is used")
    return tuple(sorted(parts, key=lambda part: (part.time, part.path)))


def run_part(path: Path, options: Options) -> RunPart:
    """Analyse one run folder or store, as far as curves need it."""
    part = RunPart(path.name, str(path))
    try:
        evaluation = open_evaluation(path, options)
        part = _described(part, evaluation.run)
        return _analysed(part, evaluation)
    except TethertestError as error:
        return replace(part, refused=error.problem)


def _described(part: RunPart, run: Run) -> RunPart:
    drive = run.file.drive
    return replace(
        part,
        run=run.file.id,
        date=run.file.date.isoformat(),
        time=run.file.date.timestamp(),
        rig=run.file.rig,
        mode=run.file.platform.mode,
        nominal_frequency=drive.frequency,
        nominal_amplitude=drive.radius or drive.amplitude,
        axial_stiffness=run.rig.cable.axial_stiffness,
        length=run.rig.cable.length,
    )


def _analysed(part: RunPart, evaluation: Evaluation) -> RunPart:
    rest = evaluation.conditioned.rest_before
    doubts = [finding for finding in evaluation.measured.findings if finding.severity != Severity.NOTE]
    remarks = [f"{finding.subject}: {finding.text}" for finding in doubts if finding.kind != CALIBRATION]
    part = replace(part, remarks=tuple(remarks), from_rest=rest is not None)
    if evaluation.nominal is None:
        if evaluation.run.file.drive.kind != "none":
            return replace(part, refused="no drive frequency: run.toml states none")
        contradicted = "; ".join(finding.text for finding in doubts if finding.kind == NOT_STATED)
        return replace(part, refused=f"no drive: {contradicted}" if contradicted else "no drive")
    asked = evaluation.options
    try:
        analysis = analyze_run(part.path, evaluation, asked.channels, replay=asked.replay)
    except DataError as error:
        if not asked.replay:
            raise
        remarks.append(f"not replayed: {error.problem}")
        analysis = analyze_run(part.path, evaluation, asked.channels)
    if analysis.drive is None or analysis.window is None:
        return replace(part, refused="no drive frequency: run.toml states none")
    # a setting in doubt puts its run at a wrong place of a curve, or on a wrong one
    doubt = "; ".join(finding.text for finding in evaluation.stated if finding.kind == AMPLITUDE)
    amplitude = _motion_amplitude(evaluation.motion_lines)
    return replace(
        part,
        frequency=analysis.drive.frequency,
        amplitude=part.nominal_amplitude if amplitude is None else amplitude,
        amplitude_measured=amplitude is not None,
        channels=tuple(
            _channel(item, rest, analysis.window, analysis.drive.frequency, doubt)
            for item in analysis.channels
            if item.channel.kind in KINDS
        ),
        remarks=tuple(remarks),
    )


def _motion_amplitude(lines: ChannelLines | None) -> float | None:
    line = None if lines is None else lines.line("1")
    return line.amplitude if line is not None and line.amplitude > 0.0 else None


def _channel(
    item: ChannelAnalysis, rest: Window | None, window: Window, frequency: float, doubt: str
) -> RunChannel:
    channel = item.channel
    at_rest = None if rest is None else _mean(channel.between(rest.start, rest.stop))
    largest = None
    if at_rest is not None and item.extremes is not None:
        largest = item.extremes.maximum - at_rest
    found = None
    try:
        whole = spectrum(channel, window)
    except DataError:
        pass  # too few samples: there is no spectrum to draw
    else:
        kept = whole.frequency <= _HIGHEST_ORDER * frequency
        found = whole.frequency[kept], whole.amplitude[kept]
    return RunChannel(
        channel.name,
        channel.kind,
        channel.unit,
        item.side,
        channel.at,
        item.lines,
        item.no_lines,
        "; ".join(reason for reason in (_damage(channel, window), doubt) if reason),
        largest,
        _rise(channel.between(window.start, window.stop)),
        found,
    )


def _rise(channel: Channel) -> float:
    """Return the largest that white noise of so many samples is expected to be."""
    count = int(np.count_nonzero(channel.usable))
    return channel.noise * math.sqrt(2.0 * math.log(count)) if count > 1 else 0.0


def _mean(channel: Channel) -> float | None:
    usable = channel.usable
    return float(np.mean(channel.values[usable])) if usable.any() else None


def _damage(channel: Channel, window: Window) -> str:
    part = channel.between(window.start, window.stop)
    if part.time.size == 0:
        return "no sample in the window"
    share = 1.0 - float(np.count_nonzero(part.usable)) / max(
        part.time.size, math.floor(window.length * part.rate)
    )
    if share <= _FEW_UNUSABLE:
        return ""
    counts = ", ".join(f"{name} {number}" for name, number in part.flag_counts().items())
    return f"{share:.1%} of the window's samples are missing or unusable" + (f" ({counts})" if counts else "")
