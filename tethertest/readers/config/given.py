"""Settings of a log that a person gives on the command line: the keys of its entry in run.toml."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from tethertest.errors import RunFileError
from tethertest.readers.config.log_checks import setting_problems
from tethertest.readers.config.problems import Problem, dotted, news, suggestion
from tethertest.readers.config.structure import field_types, structure
from tethertest.records.run import DEFAULT, Log

#: keys of a log's entry that mean nothing without a run and its rig
_OF_A_RUN: Final = ("file", "clock", "channels")
#: what the entry of a log without a run has in their place
_NO_CLOCK: Final = "none"
_UNITS: Final = "units."
_EXAMPLE: Final = "write --set KEY=VALUE, such as --set date_order=dmy or --set units.F_top=kN"


def given_settings(path: Path, words: Sequence[str]) -> Log:
    """Return the entry that a log would have in run.toml, from words such as ``date_order=dmy``.

    Parameters
    ----------
    path : Path
        The log.
    words : sequence of str
        ``KEY=VALUE``: a key of a ``[[log]]`` entry and its value as text; quotes are only needed for what
        TOML would escape. The unit of one column is ``units.NAME=UNIT``; `columns` is a list with commas
        between, or an array as in TOML, and a table for `units` is also taken as in TOML.

    Returns
    -------
    Log
        It has no clock and no channels: these need a rig.

    Raises
    ------
    RunFileError
        A word has no such key or no such value, or two do not fit together: all of them in one message.
    """
    if not words:
        return DEFAULT
    data: dict[str, Any] = {"file": path.name, "clock": _NO_CLOCK}
    for word in words:
        _add(data, word)
    log, problems = structure(Log, data)
    if log is not None:
        problems += news(setting_problems((), log), problems)
    if log is None or problems:
        raise _told(problems, data)
    return log


def settings_toml(words: Sequence[str]) -> dict[str, Any]:
    """Return the keys and values that `given_settings` has read, as run.toml would hold them."""
    data: dict[str, Any] = {}
    for word in words:
        _add(data, word)
    return data


def _add(data: dict[str, Any], word: str) -> None:
    """Add one word to the entry's keys."""
    key, sign, text = word.partition("=")
    key = key.strip()
    if key.startswith(_UNITS):
        # names of columns may hold the sign ("CH=3"), units never do
        key, sign, text = word.rpartition("=")
        name = _unquoted(key.strip()[len(_UNITS) :])
        if not name:
            message = f"--set: found {word!r}, expected units.NAME=UNIT"
            raise RunFileError(message, "name a column and its unit, such as --set units.F_top=kN")
        _once(data.setdefault("units", {}), name, f"{_UNITS}{name}", text.strip())
        return
    if not sign or not key:
        message = f"--set: found {word!r}, expected KEY=VALUE"
        raise RunFileError(message, _EXAMPLE)
    known = [name for name in field_types(Log) if name not in _OF_A_RUN]
    if key.split(".")[0] in _OF_A_RUN:
        key = key.split(".")[0]
        message = f"--set {key}: a log that is read by itself has none"
        raise RunFileError(message, f"write {key} into run.toml; here, give {', '.join(known)}")
    if key not in known:
        message = f"--set {key}: unknown key"
        raise RunFileError(message, suggestion(key, known))
    value = _value(key, text)
    if key == "units":
        if not isinstance(value, dict):
            message = f"--set units: found {text!r}, which names no column"
            raise RunFileError(message, "write units.NAME=UNIT, such as --set units.F_top=kN")
        for name, unit in value.items():
            _once(data.setdefault("units", {}), name, f"{_UNITS}{name}", unit)
        return
    _once(data, key, key, value)


def _once(table: dict[str, Any], name: str, key: str, value: Any) -> None:
    if name in table:
        message = f"--set {key}: found {value!r} after {table[name]!r}"
        raise RunFileError(message, "give each key once")
    table[name] = value


def _value(key: str, text: str) -> Any:
    """Return a value as `structure` takes it from TOML."""
    bare = text.strip()
    opened = {"columns": "[", "units": "{"}.get(key, '"')
    if bare.startswith((opened, "'")):
        try:
            return tomllib.loads(f"value = {bare}")["value"]
        except tomllib.TOMLDecodeError:
            if opened != '"':
                message = f"--set {key}: found {text!r}, which is not written as in TOML"
                example = '["t", "F_top"]' if key == "columns" else '{ F_top = "kN" }'
                raise RunFileError(message, f"write {example}, in quotes against the shell") from None
    if key == "columns":
        return [name.strip() for name in text.split(",")]
    if key == "skip_rows":
        try:
            return int(bare)
        except ValueError:
            return text
    if key == "separator":
        return text if text.isspace() else bare
    return bare


def _unquoted(name: str) -> str:
    quoted = len(name) > 1 and name[0] == name[-1] and name[0] in "\"'"
    return name[1:-1] if quoted else name


def _told(problems: Sequence[Problem], data: dict[str, Any]) -> RunFileError:
    if len(problems) == 1:
        (problem,) = problems
        return RunFileError(f"--set {dotted(problem.key, data)}: {problem.text}", problem.remedy)
    texts = [
        f"\n  --set {dotted(problem.key, data)}: {problem.text}\n    fix: {problem.remedy}"
        for problem in problems
    ]
    return RunFileError(f"{len(problems)} problems{''.join(texts)}")
