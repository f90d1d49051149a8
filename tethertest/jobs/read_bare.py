"""Reading a log that belongs to no run: what run.toml would hold is given by ``--set``, and errors say so."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError, TethertestError
from tethertest.readers import read_log
from tethertest.readers.config.given import given_settings
from tethertest.readers.config.structure import field_types
from tethertest.readers.streaming import stream_log
from tethertest.records.channel import RawLog
from tethertest.records.run import Log

#: the option that stands for the log's entry in run.toml
SET: Final = "--set"
_RUN_FILE: Final = "run.toml"
_HERE: Final = f"in {_RUN_FILE}"
#: how a remedy names a key; some keys are plain words, too
_ASKED: Final = r"\b{key} = |\b(?:set|correct|remove|check) (?:\w+(?:,| or| and) )*{key}\b"


def read_bare(path: Path, words: Sequence[str] = ()) -> RawLog:
    """Read a log without a run.

    Parameters
    ----------
    path : Path
        The log.
    words : sequence of str
        Settings as ``KEY=VALUE``; see `tethertest.readers.config.given.given_settings`.

    Raises
    ------
    TethertestError
        A setting is wrong, or the log cannot be read; what a setting would mend names ``--set``.
    """
    (log,) = _bare(path, words, lambda settings: [read_log(path, settings)])
    return log


def stream_bare(path: Path, words: Sequence[str], rows: int) -> Iterator[RawLog]:
    """Yield a log without a run in consecutive parts of so many rows.

    Raises
    ------
    TethertestError
        As `read_bare`.
    """
    return _bare(path, words, lambda settings: stream_log(path, settings, rows=rows))


def _bare(path: Path, words: Sequence[str], read: Callable[[Log], Iterable[RawLog]]) -> Iterator[RawLog]:
    settings = given_settings(path, words)
    check_no_pipe(path)
    try:
        for log in read(settings):
            remarks = tuple(remark.replace(_HERE, f"in {SET}") for remark in log.remarks)
            told = replace(log, remarks=remarks, reason=log.reason.replace(_RUN_FILE, SET))
            yield told if words else log
    except FileFormatError as error:
        raise bare_error(error, given=bool(words)) from error


def bare_error(error: FileFormatError, *, given: bool) -> TethertestError:
    """Return a reader's error in the words of the command line.

    Parameters
    ----------
    error : FileFormatError
        It speaks of the log's entry in run.toml.
    given : bool
        Whether settings were given: then it is these that it speaks of.
    """
    if error.keys:
        return error.without_run()
    problem = error.problem.replace(_RUN_FILE, SET) if given else error.problem
    remedy = error.remedy
    if _HERE in remedy:
        keys = [key for key in field_types(Log) if re.search(_ASKED.format(key=key), remedy)]
        word = _word(keys[0]) if len(keys) == 1 else "KEY=VALUE"
        remedy = f"{remedy} (or here: {SET} {word})"
    return FileFormatError(problem, remedy, path=error.path, line=error.line)


def check_no_pipe(path: Path) -> None:
    """Refuse what can be read only once: a log is read several times.

    Raises
    ------
    FileFormatError
        The path is a pipe, a socket or a device.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        message = "found a pipe or a device, expected a file"
        raise FileFormatError(message, "save the log as a file and name that", path=path)


def settings_of_a_run(path: Path) -> TethertestError:
    """Return the error about settings beside something that is no bare log."""
    message = f"{SET} is for a log that belongs to no run"
    return TethertestError(message, "write the keys into [[log]] of the run's run.toml", path=path)


def _word(key: str) -> str:
    return "units.NAME=UNIT" if key == "units" else f"{key}=VALUE"
