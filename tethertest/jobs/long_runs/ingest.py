"""A run with logs larger than memory into its store."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from tethertest.conditioning import condition
from tethertest.conditioning.condition import mapped_finding
from tethertest.conditioning.flags.plausible import check_rate
from tethertest.conditioning.flags.spikes import CONTEXT
from tethertest.conditioning.rest import RunWindows
from tethertest.errors import DataError
from tethertest.jobs.evaluation import rig_priors
from tethertest.jobs.long_runs.columns import Scratch, Sizes, no_scratch
from tethertest.jobs.long_runs.finish import Final, final_channels
from tethertest.jobs.long_runs.flagging import Flagged, flagged, thinned
from tethertest.jobs.long_runs.gather import gathered
from tethertest.jobs.long_runs.record import record_of
from tethertest.jobs.long_runs.rest import zeroed_sensors
from tethertest.records.channel import ClockFit, Finding, RawLog, Severity
from tethertest.records.run import Log, Run
from tethertest.store import StoreHeader, new_store

#: clocks are fitted over at most this time: their search holds a millisecond grid of it in memory [s]
LONGEST_FIT = 7200.0
#: a drive is looked for in a copy with at least so many samples per cycle
SLOWEST = 8.0
#: findings about stamps that the thinned copy has of its own
_OF_STAMPS = {"gap", "clock_jump", "jitter", "quantised_time", "duplicate_time", "missing_time"}

#: what is being done, and which share of it is done where that is known
Progress = Callable[[str, float | None], None]


@dataclass(frozen=True, slots=True, eq=False)
class Sources:
    """The logs of a run: some whole, some in pieces."""

    whole: Mapping[str, RawLog]  #: by `Log.key`
    pieces: Mapping[str, Iterable[RawLog]]  #: by `Log.key`


def ingest_long(
    run: Run,
    sources: Sources,
    target: Path,
    header: Callable[[Mapping[str, RawLog]], StoreHeader],
    progress: Progress,
    sizes: Sizes,
) -> tuple[dict[str, int], list[Finding]]:
    """Condition a run whose logs do not all fit into memory, and write its store.

    Parameters
    ----------
    run : Run
        The run and its rig.
    sources : Sources
        Its logs; those in pieces may hold load cells and displacements.
    target : Path
        The store.
    header : callable
        Makes the store's header of the logs, whose samples it does not need.
    progress : callable
        Is told what is being done.
    sizes : Sizes
        How much is held in memory.

    Returns
    -------
    tuple
        Samples of every channel by name, and the findings.

    Raises
    ------
    TethertestError
        As `condition`, or a log that takes the whole record to condition, or a disk that is full.
    """
    folder = target.resolve().parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise no_scratch(folder, error) from error
    with Scratch(folder) as scratch:
        return _ingested(run, sources, target, header, progress, sizes, scratch)


def _ingested(
    run: Run,
    sources: Sources,
    target: Path,
    header: Callable[[Mapping[str, RawLog]], StoreHeader],
    progress: Progress,
    sizes: Sizes,
    scratch: Scratch,
) -> tuple[dict[str, int], list[Finding]]:
    logs = {
        entry.key: _gathered(run, entry, sources.pieces[entry.key], scratch, progress, sizes)
        for entry in run.file.log
        if entry.key in sources.pieces
    }
    thin, factors = _thin(run, logs, sizes)
    progress("clocks and windows", None)
    rough = condition(_slower(run, logs, factors), {**sources.whole, **thin}, rig_priors(run))
    raws = {**sources.whole, **{key: log.record.log.raw for key, log in logs.items()}}
    fits = {fit.clock: fit for fit in rough.clocks}
    pairs = [(log, fits[log.record.log.entry.clock]) for log in logs.values()]
    names = {name for log in logs.values() for name in log.names}
    others = [channel for channel in rough.channels if channel.name not in names]
    windows = RunWindows(rough.rest_before, rough.rest_after, rough.steady)
    progress("zeros", None)
    moving = [channel for channel in others if channel.kind == "displacement"]
    zeroed, found = zeroed_sensors(pairs, moving, run.rig, rig_priors(run), windows, sizes)
    findings = [
        *_kept(rough.findings, names, {fit.clock for _, fit in pairs}),
        *_of_logs(pairs),
        *_told(factors),
        *found,
    ]
    finals = {sensor.about.name: Final(sensor, run, windows, sizes) for sensor in zeroed}
    with new_store(target, header(raws)) as store:
        samples = final_channels(store, run, finals, others, progress)
        findings += [finding for final in finals.values() for finding in final.findings]
        spans = {"rest_before": rough.rest_before, "rest_after": rough.rest_after, "steady": rough.steady}
        store.conclude(rough.clocks, findings, spans)
    return samples, findings


def _gathered(
    run: Run, entry: Log, pieces: Iterable[RawLog], scratch: Scratch, progress: Progress, sizes: Sizes
) -> Flagged:
    """Return one log on disk, audited and flagged."""
    log = gathered(pieces, entry, run, scratch, lambda rows: progress(f"{entry.file}: {rows} rows", None))
    progress(f"{entry.file}: stamps", None)
    record = record_of(log, scratch, sizes)
    for channel in record.channels(0, CONTEXT):
        check_rate(channel, run.rig)
    words = f"{entry.file}: flags"
    progress(f"{entry.file}: noise and plateaus", None)
    return flagged(record, run, scratch, sizes, lambda rows: progress(words, rows / record.rows))


def _thin(run: Run, logs: Mapping[str, Flagged], sizes: Sizes) -> tuple[dict[str, RawLog], dict[str, int]]:
    """Return thinned copies that together hold no more numbers than fit into memory."""
    clocks = {entry.clock for entry in run.file.log} - set(run.file.override.clock_offset)
    numbers = sum(log.record.rows * (len(log.flags) + 1) for log in logs.values())
    factors: dict[str, int] = {}
    for key, log in logs.items():
        record = log.record
        ends = [float(record.time(row, row + 1)[0]) for row in (0, record.rows - 1)]
        if len(clocks) > 1 and ends[1] - ends[0] > LONGEST_FIT:
            message = (
                f"clocks are fitted over at most {LONGEST_FIT / 3600:g} h, and the log is "
                f"{(ends[1] - ends[0]) / 3600:.3g} h long"
            )
            remedy = "set [override.clock_offset] for the other clocks, or split the run"
            raise DataError(message, remedy, path=record.log.raw.path)
        factors[key] = -(-numbers // sizes.thinned)
        rate = 1.0 / (record.step * factors[key])
        drive = run.file.drive.frequency
        if drive is not None and run.file.windows.steady is None and rate < SLOWEST * drive:
            message = (
                f"the log is so long that its drive is looked for in means at {rate:.3g} Hz, too slow for "
                f"{drive:g} Hz"
            )
            raise DataError(message, "set [windows] steady in run.toml", path=record.log.raw.path)
    return {key: thinned(log, factors[key], sizes) for key, log in logs.items()}, factors


def _slower(run: Run, logs: Mapping[str, Flagged], factors: Mapping[str, int]) -> Run:
    """Return the run with instruments that log at the rate of the thinned copies."""
    slow = {log.record.log.entry.clock: factors[key] for key, log in logs.items()}
    instruments = tuple(replace(item, rate=item.rate / slow.get(item.name, 1)) for item in run.rig.instrument)
    return replace(run, rig=replace(run.rig, instrument=instruments))


def _kept(findings: Sequence[Finding], names: set[str], clocks: set[str]) -> list[Finding]:
    """Return what the conditioning of the thinned copy found that is no matter of its samples."""
    return [
        item
        for item in findings
        if item.subject not in names and not (item.subject in clocks and item.kind in _OF_STAMPS)
    ]


def _of_logs(pairs: Sequence[tuple[Flagged, ClockFit]]) -> list[Finding]:
    return [
        mapped_finding(item, fit) if item.subject == fit.clock else item
        for log, fit in pairs
        for item in (*log.record.findings, *log.findings)
    ]


def _told(factors: Mapping[str, int]) -> list[Finding]:
    return [
        Finding(
            key,
            "thinned",
            f"larger than memory: clocks and windows were found on means of {factor} samples",
            Severity.NOTE,
        )
        for key, factor in factors.items()
        if factor > 1
    ]
