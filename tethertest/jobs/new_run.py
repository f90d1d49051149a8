"""A draft of run.toml from the logs that a folder holds, for a person to complete."""

from __future__ import annotations

import datetime as dt
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tethertest.conditioning.timestamps.stamp_steps import steps_of
from tethertest.errors import TethertestError
from tethertest.jobs.draft import Draft, DraftLog
from tethertest.jobs.draft_text import TODO, draft_text
from tethertest.jobs.sensor_names import Matched, matched
from tethertest.readers import identify, load_rig, read_log
from tethertest.readers.config.load import RIGS_FOLDER, RUN_FILE
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.rig import Rig
from tethertest.signal.filters import low_passed
from tethertest.units import channel_scale

#: files of these endings are no logs
NO_LOGS = (".toml", ".md", ".pdf", ".png", ".jpg", ".py", ".html")
#: start times with and without a zone tell the laboratory's zone when they differ by a quarter of an hour
#: times a whole number, within this [s]
ZONE_STEP, ZONE_SLACK = 900.0, 60.0
#: a clock is guessed where one instrument's rate is nearer than any other's by this factor
NEARER = 1.5
#: the slowest drive looked for [Hz], and the smallest share of the motion that a drive explains
SLOWEST, DRIVEN = 0.02, 0.5


def new_run(folder: Path, logs: Sequence[Path] = (), rigs: Path | None = None) -> tuple[Path, Draft]:
    """Write a commented run.toml from the logs of a folder; an existing one is never touched.

    Parameters
    ----------
    folder : Path
        The run folder.
    logs : sequence of Path
        Its logs; all files of the folder that a reader recognises if none is named.
    rigs : Path, optional
        Folder of rig files; found upwards from the run folder if absent.

    Returns
    -------
    tuple
        The file written, and what it rests on.

    Raises
    ------
    TethertestError
        There is a run.toml already, no folder, no log, or a named log outside it.
    """
    target = folder / RUN_FILE
    if not folder.is_dir():
        message = "there is no such folder"
        raise TethertestError(message, "make it and copy the logs into it", path=folder)
    if target.exists():
        message = "the folder has a run.toml already, which is never overwritten"
        raise TethertestError(message, "move it away to have a new draft", path=target)
    draft = draft_of(folder, logs, rigs)
    try:
        with target.open("x", encoding="utf-8") as stream:
            stream.write(draft_text(draft))
    except OSError as error:
        message = f"cannot be written: {error.strerror}"
        raise TethertestError(message, "mend the folder's permissions", path=target) from None
    return target, draft


def draft_of(folder: Path, logs: Sequence[Path], rigs: Path | None) -> Draft:
    """Return the draft of a folder's run file, without writing anything.

    Parameters
    ----------
    folder, logs, rigs
        As for `new_run`.

    Raises
    ------
    TethertestError
        No log was found, or a named one is outside the folder or no log.
    """
    files = [_inside(path, folder) for path in logs] or sorted(
        entry.name
        for entry in folder.iterdir()
        if entry.is_file() and not entry.name.startswith(".") and entry.suffix.lower() not in NO_LOGS
    )
    read: dict[str, RawLog] = {}
    problems: dict[str, tuple[str, TethertestError]] = {}
    left_out: list[tuple[str, str]] = []
    for file in files:
        try:
            reader = identify(folder / file)
        except TethertestError as error:
            if logs:
                raise
            left_out.append((file, error.problem))
            continue
        try:
            read[file] = read_log(folder / file)
        except TethertestError as error:
            problems[file] = (reader.NAME, error)
    if not read and not problems:
        message = "found no file that a reader recognises as a log"
        raise TethertestError(message, "copy the raw logs into the folder", path=folder)
    candidates = _rigs(folder, rigs)
    name, rig = _best_rig(candidates, read)
    modes = tuple(rig.platform.modes) if rig is not None else ()
    date, why = _date(read)
    entries = [DraftLog(file, log.format, *_clock(log, rig), matched(log, rig)) for file, log in read.items()]
    entries = _by_exclusion(_one_log_a_guess(entries), rig)
    entries += [
        DraftLog(file, reader, TODO, "the log is not read yet", Matched(), error.problem, error.remedy)
        for file, (reader, error) in problems.items()
    ]
    return Draft(
        folder,
        name,
        tuple(candidates),
        modes[0] if len(modes) == 1 else TODO,
        modes,
        date,
        why,
        _drive(read),
        tuple(sorted(entries, key=lambda entry: entry.file)),
        tuple(left_out),
    )


def _inside(path: Path, folder: Path) -> str:
    """Return a named log's path in the folder; it may be given from here or from the folder."""
    for candidate in (path, folder / path):
        resolved = candidate.resolve()
        if resolved.is_file() and resolved.is_relative_to(folder.resolve()):
            return resolved.relative_to(folder.resolve()).as_posix()
    message = f"{path} is no file inside the run folder {folder}"
    raise TethertestError(message, "copy the log into the run folder")


def _rigs(folder: Path, rigs: Path | None) -> dict[str, Rig]:
    """Return the rig files of the nearest folder that has any."""
    absolute = folder.resolve()
    folders = [rigs] if rigs else [parent / RIGS_FOLDER for parent in (absolute, *absolute.parents)]
    for place in folders:
        found: dict[str, Rig] = {}
        for path in sorted(place.glob("*.toml")) if place.is_dir() else ():
            try:
                found[path.stem] = load_rig(path)
            except TethertestError:  # a prototype, or a rig that is not complete
                continue
        if found:
            return found
    return {}


def _best_rig(candidates: dict[str, Rig], logs: dict[str, RawLog]) -> tuple[str, Rig | None]:
    """Return the only rig, or the one whose sensors the logs name best; none where two do as well."""
    scored = sorted(
        ((sum(matched(log, rig).count for log in logs.values()), name) for name, rig in candidates.items()),
        reverse=True,
    )
    if not scored or scored[0][0] == 0 or (len(scored) > 1 and scored[0][0] == scored[1][0]):
        return TODO, None
    return scored[0][1], candidates[scored[0][1]]


def _clock(log: RawLog, rig: Rig | None) -> tuple[str, str]:
    """Return the instrument whose rate is nearest to the log's, and the words for it."""
    usual = next((_step(channel) for channel in log.channels if channel.time.size > 1), 0.0)
    if rig is None or usual <= 0.0 or not rig.instrument:
        return TODO, "no rig or no rate to guess from"
    rate = 1.0 / usual
    apart = sorted((abs(math.log(item.rate / rate)), item.name, item.rate) for item in rig.instrument)
    best = apart[0]
    if len(apart) > 1 and apart[1][0] - best[0] < math.log(NEARER) and best[0] > math.log(1.05):
        names = ", ".join(item.name for item in rig.instrument)
        return TODO, f"logged at {rate:.4g} Hz; one of {names}"
    return best[1], f"guessed: logged at {rate:.4g} Hz, the instrument at {best[2]:.4g} Hz"


def _one_log_a_guess(entries: list[DraftLog]) -> list[DraftLog]:
    """Return the logs without clocks that are guessed for more than one: their rates tell nothing then."""
    guessed = Counter(entry.clock for entry in entries)
    why = "{} by its rate, and so is another log; logs of one logger share its name, others do not"
    return [
        replace(entry, clock=TODO, why=why.format(entry.clock))
        if entry.clock != TODO and guessed[entry.clock] > 1
        else entry
        for entry in entries
    ]


def _by_exclusion(entries: list[DraftLog], rig: Rig | None) -> list[DraftLog]:
    """Return the logs with the one clock that is left for the one log without."""
    taken = {entry.clock for entry in entries}
    left = [item.name for item in rig.instrument if item.name not in taken] if rig is not None else []
    if len(left) != 1 or sum(entry.clock == TODO for entry in entries) != 1:
        return entries
    why = "guessed: the only instrument without a log"
    return [replace(entry, clock=left[0], why=why) if entry.clock == TODO else entry for entry in entries]


def _date(logs: dict[str, RawLog]) -> tuple[str, str]:
    """Return the run's date as TOML and what it rests on; without a zone where no log tells it."""
    aware = [log.start for log in logs.values() if log.start is not None and log.start.tzinfo is not None]
    naive = [log.start for log in logs.values() if log.start is not None and log.start.tzinfo is None]
    if not aware and not naive:
        return f'"{TODO}"', "date, time and zone, e.g. 2026-09-05T14:20:00+08:00; no log has a start time"
    if not naive:
        first = min(aware)
        text = "of the earliest stamp; write it in the laboratory's zone"
        return first.replace(microsecond=0).isoformat(), text
    first = min(naive).replace(microsecond=0)
    if aware:
        ahead = (min(naive) - min(aware).astimezone(dt.UTC).replace(tzinfo=None)).total_seconds()
        steps = round(ahead / ZONE_STEP)
        if abs(ahead - ZONE_STEP * steps) <= ZONE_SLACK and abs(steps * ZONE_STEP) <= 14 * 3600:
            zone = dt.timezone(dt.timedelta(seconds=ZONE_STEP * steps))
            text = "of the earliest stamp; the zone by logs with and without one: check it"
            return first.replace(tzinfo=zone).isoformat(), text
    return first.isoformat(), "TODO: add the laboratory's zone, e.g. +08:00; the earliest stamp has none"


def _step(channel: RawChannel) -> float:
    """Return the usual step between rows [s], 0 where no stamp goes forward."""
    return steps_of(channel.time[np.isfinite(channel.time)]).step


def _drive(logs: dict[str, RawLog]) -> str:
    """Return what the displacement shows of the drive, in words; empty where nothing does."""
    for log in logs.values():
        for channel in log.channels:
            try:
                scale = channel_scale(channel.unit)
            except TethertestError:
                continue
            step = _step(channel)
            if scale.kind != "displacement" or channel.time.size < 100 or step <= 0.0:
                continue
            values = scale.factor * channel.values
            values = np.where(np.isfinite(values), values, np.nanmedian(values))
            low, high = np.quantile(values, [0.01, 0.99])
            smooth = low_passed(values - values.mean(), 1.0 / step, 20.0)
            power = np.abs(np.fft.rfft(smooth * np.hanning(values.size)))
            frequency = np.fft.rfftfreq(values.size, step)
            power[frequency < SLOWEST] = 0.0
            peak = int(np.argmax(power))
            near = np.abs(frequency - frequency[peak]) <= 0.1 * frequency[peak]
            if np.sum(power[near] ** 2) < DRIVEN * np.sum(power**2):
                return ""
            return (
                f"{channel.name} of {log.path.name} moves by about +/-{500 * (high - low):.3g} mm, "
                f"mostly near {frequency[peak]:.3g} Hz"
            )
    return ""
