"""The main job: a run folder of raw logs becomes a validation report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tethertest.jobs.analysis_options import Options
from tethertest.jobs.evaluation import Evaluation, open_run
from tethertest.jobs.provenance import provenance
from tethertest.readers import load_prototype_of
from tethertest.records.analysis import REPLAYED, ChannelAnalysis
from tethertest.records.lines import Event
from tethertest.records.report import Report
from tethertest.records.rig import Prototype
from tethertest.records.similarity import Similarity
from tethertest.similitude import similarity


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
    evaluation = open_run(folder, Options(rigs=rigs))
    prototype = load_prototype_of(evaluation.run.rig, evaluation.run.rig_path)
    with evaluation.errors_placed():
        return _reported(evaluation, prototype)


def _reported(evaluation: Evaluation, prototype: Prototype | None) -> Report:
    channels, replayed = evaluation.conditioned.channels, evaluation.replayed
    return Report(
        run=evaluation.run,
        measured=evaluation.measured,
        response=evaluation.response,
        replayed=replayed,
        drive=evaluation.drive,
        measured_lines=evaluation.lines(channels),
        replayed_lines=evaluation.lines(replayed, REPLAYED),
        events=_events([evaluation.found(channel) for channel in channels]),
        replayed_events=_events([evaluation.found(channel, REPLAYED) for channel in replayed]),
        comparison=evaluation.comparison,
        similarity=_similarity(evaluation, prototype),
        provenance=provenance(evaluation.run, evaluation.logs, _settings(evaluation)),
    )


def _events(found: Sequence[ChannelAnalysis]) -> tuple[Event, ...]:
    return tuple(event for item in found for event in item.events)


def _similarity(evaluation: Evaluation, prototype: Prototype | None) -> Similarity | None:
    drive = evaluation.run.file.drive
    frequency = drive.frequency if evaluation.drive is None else evaluation.drive.frequency
    amplitude = drive.radius or drive.amplitude
    if prototype is None or frequency is None or not amplitude:
        return None
    return similarity(evaluation.run.rig, prototype, frequency, amplitude, evaluation.run.file.platform.mode)


def _settings(evaluation: Evaluation) -> dict[str, str]:
    if evaluation.motion is None:
        return {}
    return {
        "motion cut-off": f"{evaluation.motion.cutoff:.4g} Hz",
        "motion cut-off where sudden": f"{evaluation.motion.wide_cutoff:.4g} Hz",
    }
