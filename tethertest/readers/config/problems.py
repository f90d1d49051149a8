"""What is wrong in a file, gathered, and told all at once."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from tethertest.errors import RunFileError
from tethertest.readers.config.toml import KeyPath, TomlFile

#: longest name of a file that file systems take [bytes]
_LONGEST_NAME = 255
#: of a name that is no name, a message shows this much
NAME_SHOWN = 60


@dataclass(frozen=True, slots=True)
class Problem:
    """One wrong, unknown or missing key."""

    key: KeyPath
    text: str  #: what was found and what was expected
    remedy: str


def dotted(key: KeyPath, data: Mapping[str, Any]) -> str:
    """Return a key path as people write it: ``sensor.tension_top.rated``, or ``log[2].file`` counted from 1.

    An entry of an array goes by its ``name`` where it has one.
    """
    text = ""
    here: Any = data
    for part in key:
        here = _inside(here, part)
        if isinstance(part, str):
            text += f".{part}" if text else part
            continue
        name = here.get("name") if isinstance(here, dict) else None
        text += f".{name}" if isinstance(name, str) and name else f"[{part + 1}]"
    return text


def _inside(data: Any, part: str | int) -> Any:
    try:
        return data[part]
    except (KeyError, IndexError, TypeError):
        return None


def suggestion(found: str, known: Iterable[str]) -> str:
    """Return the remedy for a name that is not known: the nearest one, else the list."""
    names = list(known)
    near = difflib.get_close_matches(found, names, n=1, cutoff=0.6)
    if near:
        return f"did you mean {near[0]!r}?"
    return f"use one of {', '.join(names)}" if names else "remove it; none is defined"


def is_file_name(text: str) -> bool:
    """Return whether a file may have this relative path: no NUL, and no part too long for a file system."""
    return "\0" not in text and all(len(part.encode()) <= _LONGEST_NAME for part in text.split("/"))


def news(found: Iterable[Problem], known: Iterable[Problem]) -> list[Problem]:
    """Return the problems found whose key, or a part of it, is not already known to be wrong."""
    told = {problem.key[:end] for problem in known for end in range(1, len(problem.key) + 1)}
    return [problem for problem in found if problem.key not in told]


def raise_problems(document: TomlFile, problems: Iterable[Problem]) -> None:
    """Raise one error about everything that is wrong in a file, in the order of its lines.

    Raises
    ------
    RunFileError
        There is at least one problem.
    """
    placed = sorted(
        ((document.line_of(problem.key), problem) for problem in dict.fromkeys(problems)),
        key=lambda pair: (pair[0] or 0, dotted(pair[1].key, document.data)),
    )
    if not placed:
        return
    if len(placed) == 1:
        line, problem = placed[0]
        message = f"{dotted(problem.key, document.data)}: {problem.text}"
        raise RunFileError(message, problem.remedy, path=document.path, line=line)
    texts = []
    for line, problem in placed:
        where = f"line {line}, " if line is not None else ""
        key = dotted(problem.key, document.data)
        texts.append(f"\n  {where}{key}: {problem.text}\n    fix: {problem.remedy}")
    message = f"{len(placed)} problems{''.join(texts)}"
    raise RunFileError(message, path=document.path)
