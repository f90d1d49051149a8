"""What must hold between the keys of a run file, its rig and its folder."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath, PureWindowsPath

from tethertest.readers.config.log_checks import setting_problems
from tethertest.readers.config.problems import NAME_SHOWN, Problem, is_file_name, suggestion
from tethertest.records.rig import Rig
from tethertest.records.run import Drive, Log, RunFile, Windows

#: kind of drive -> keys it needs; the others it must not have
DRIVE_KEYS = {
    "crank-slider": {"frequency", "radius"},
    "harmonic": {"frequency", "amplitude"},
    "measured": set[str](),
    "none": set[str](),
}
#: keys that a kind of drive may have besides
OPTIONAL_DRIVE_KEYS = {"measured": {"frequency"}}
_DRIVE_EXAMPLES = {"frequency": '"0.3 Hz"', "radius": '"0.1 m"', "amplitude": '"0.1 m"'}
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


def run_problems(file: RunFile, rig: Rig, folder: Path) -> Iterator[Problem]:
    """Yield everything that is wrong between a run file, its rig and the files in its folder."""
    if file.date.tzinfo is None:
        text = f"found {file.date}, expected a zone beside date and time"
        yield Problem(("date",), text, f"add the laboratory's zone: {file.date.isoformat()}+08:00")
    if not file.id.strip():
        yield Problem(("id",), "found an empty name", "name the run, for instance after its folder")
    elif _CONTROL.search(file.id):
        text = f"found {file.id!r}, expected a name on one line"
        yield Problem(("id",), text, "name the run, for instance after its folder")
    if file.platform.mode not in rig.platform.modes:
        text = f"found {file.platform.mode!r}, expected one of the platform modes of {rig.name!r}"
        yield Problem(("platform", "mode"), text, suggestion(file.platform.mode, rig.platform.modes))
    yield from _drive_problems(file.drive)
    yield from _amplitude_problems(file.drive, rig)
    if not file.log:
        yield Problem(("log",), "found no log, expected at least one", "add a [[log]] table for each raw log")
    for index, log in enumerate(file.log):
        yield from _log_problems(index, log, rig, folder)
    yield from _repeated(file.log)
    yield from _window_problems(file.windows)
    sensors = [sensor.name for sensor in rig.sensor]
    for index, exclude in enumerate(file.exclude):
        key = ("exclude", index)
        if exclude.channel not in sensors:
            text = f"found {exclude.channel!r}, expected a sensor of {rig.name!r}"
            yield Problem((*key, "channel"), text, suggestion(exclude.channel, sensors))
        yield from _span_problems((*key, "span"), exclude.span)
        if not exclude.reason.strip():
            yield Problem((*key, "reason"), "found no reason", "say why the span is left out")
    clocks = sorted({log.clock for log in file.log})
    for clock, offset in file.override.clock_offset.items():
        if not offset.reason.strip():
            text = "found no reason"
            yield Problem(("override", "clock_offset", clock, "reason"), text, "say where the offset is from")
        if clock not in clocks:
            text = f"found {clock!r}, expected the clock of one of the run's logs"
            yield Problem(("override", "clock_offset", clock), text, suggestion(clock, clocks))


def _drive_problems(drive: Drive) -> Iterator[Problem]:
    needed = DRIVE_KEYS[drive.kind]
    optional = OPTIONAL_DRIVE_KEYS.get(drive.kind, set())
    for key in ("frequency", "radius", "amplitude"):
        is_there = getattr(drive, key) is not None
        if key in needed and not is_there:
            text = f"is missing; a {drive.kind} drive needs it"
            yield Problem(("drive", key), text, f"add `{key} = {_DRIVE_EXAMPLES[key]}`")
        elif is_there and key not in needed | optional:
            text = f"does not belong to a drive of kind {drive.kind!r}"
            yield Problem(("drive", key), text, f"remove {key}, or correct the kind")


def _amplitude_problems(drive: Drive, rig: Rig) -> Iterator[Problem]:
    for key in ("radius", "amplitude"):
        value = getattr(drive, key)
        if value is not None and value >= rig.cable.length:
            text = f"found {value:g} m, expected less than the cable's length of {rig.cable.length:g} m"
            yield Problem(("drive", key), text, f"correct {key}, or the cable's length in the rig file")


def _log_problems(index: int, log: Log, rig: Rig, folder: Path) -> Iterator[Problem]:
    key = ("log", index)
    yield from _path_problems((*key, "file"), log.file, folder)
    clocks = [instrument.name for instrument in rig.instrument]
    if log.clock not in clocks:
        text = f"found {log.clock!r}, expected an instrument of {rig.name!r}"
        yield Problem((*key, "clock"), text, suggestion(log.clock, clocks))
    sensors = [sensor.name for sensor in rig.sensor]
    for name, sensor in log.channels.items():
        if sensor not in sensors:
            text = f"found {sensor!r}, expected a sensor of {rig.name!r}"
            yield Problem((*key, "channels", name), text, suggestion(sensor, sensors))
    yield from setting_problems(key, log)


def _path_problems(key: tuple[str | int, ...], file: str, folder: Path) -> Iterator[Problem]:
    windows = PureWindowsPath(file)
    is_outside = (
        PurePosixPath(file).is_absolute() or bool(windows.drive or windows.root) or ".." in windows.parts
    )
    if not is_file_name(file):
        text = f"found {file[:NAME_SHOWN]!r}, which no file can be called"
        yield Problem(key, text, "copy the log into the run folder and give its name")
    elif is_outside or not file or not _is_inside(folder / file, folder):
        text = f"found {file!r}, expected a file inside the run folder"
        yield Problem(key, text, "copy the log into the run folder and give its name")
    elif not (folder / file).is_file():
        logs = sorted(entry.name for entry in folder.iterdir() if entry.is_file() and entry.suffix != ".toml")
        text = f"found {file!r}, but the run folder has no such file"
        yield Problem(key, text, suggestion(file, logs) if logs else "copy the log into the run folder")


def _is_inside(path: Path, folder: Path) -> bool:
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # a link that leads to itself
        return False


def _repeated(logs: tuple[Log, ...]) -> Iterator[Problem]:
    seen: set[str] = set()
    tables: dict[str, str | None] = {}
    sensors: dict[str, str] = {}
    for index, log in enumerate(logs):
        if log.key in seen:
            text = f"found {log.file!r} a second time"
            yield Problem(("log", index, "file"), text, "name every log once, with all its channels")
        elif log.file in tables and None in {log.table, tables[log.file]}:
            text = f"found {log.file!r} a second time, and not each with the table to read in it"
            yield Problem(("log", index, "file"), text, "give every entry of the file its own table")
        seen.add(log.key)
        tables.setdefault(log.file, log.table)
        for name, sensor in log.channels.items():
            if sensor in sensors:
                text = f"found {sensor!r}, which channel {sensors[sensor]!r} already gives"
                remedy = "give each sensor one channel of one log"
                yield Problem(("log", index, "channels", name), text, remedy)
            sensors.setdefault(sensor, name)


def _window_problems(windows: Windows) -> Iterator[Problem]:
    previous = None
    for name in ("rest_before", "steady", "rest_after"):
        span = getattr(windows, name)
        if span is None:
            continue
        yield from _span_problems(("windows", name), span)
        if previous is not None and span[0] < getattr(windows, previous)[1]:
            text = f"starts at {span[0]:g} s, before {previous} ends at {getattr(windows, previous)[1]:g} s"
            yield Problem(("windows", name), text, "order them: rest_before, steady, rest_after")
        previous = name
    if previous is not None and not (windows.reason or "").strip():
        text = "is missing; windows set by hand need it"
        yield Problem(("windows", "reason"), text, 'add reason = "why the windows found do not do"')


def _span_problems(key: tuple[str | int, ...], span: tuple[float, float]) -> Iterator[Problem]:
    if not span[0] < span[1]:
        text = f"found a span from {span[0]:g} s to {span[1]:g} s, expected the start first"
        yield Problem(key, text, "correct the two times")
