"""Every hostile input, and what may come of it."""

from __future__ import annotations

import json
import re
from typing import Final

from reports.hostile_input import binary, hdf5, matlab, packed, runs, text
from reports.hostile_input.case import Case
from reports.hostile_input.process import Done

CASES: Final[tuple[Case, ...]] = (
    *hdf5.CASES,
    *matlab.CASES,
    *packed.CASES,
    *text.CASES,
    *binary.CASES,
    *runs.CASES,
)
#: what any case may take, on a busy machine [s], and of memory [bytes]
SECONDS: Final = 20.0
MEMORY: Final = 600e6
BAD_INPUT: Final = 2
_FAULT: Final = re.compile(r"Traceback|fault of tethertest")


def faults(case: Case, done: Done, written: str = "") -> list[str]:
    """Return what is wrong with what came of a case; `written` is the text of files that it made."""
    found = told(case, done.code, done.output, done.error)
    if done.seconds > SECONDS:
        found.append(f"took {done.seconds:.0f} s")
    if done.peak > MEMORY:
        found.append(f"took {done.peak / 1e6:.0f} MB")
    if case.never and re.search(case.never, written, re.MULTILINE):
        found.append(f"wrote {case.never}")
    return found


def told(case: Case, code: int, output: str, error: str) -> list[str]:
    """Return what is wrong with an exit code and what was said."""
    said = output + error
    wanted = BAD_INPUT if case.refused else 0
    found = [] if code == wanted else [f"exit code {code}, expected {wanted}"]
    if _FAULT.search(said):
        found.append("a traceback")
    if not re.search(case.said, said):
        found.append(f"did not say {case.said!r}")
    if case.never and re.search(case.never, said, re.MULTILINE):
        found.append(f"said {case.never!r}")
    if case.refused and case.file not in said:
        found.append("did not name the file")
    if case.refused and not _remedy(said):
        found.append("did not say what to do")
    return found


def refusal(said: str) -> str:
    """Return the message of a refusal, as JSON or as text, without its remedy."""
    try:
        return str(json.loads(said.splitlines()[0])["message"])
    except (ValueError, KeyError, IndexError):
        return said.removeprefix("error: ").split("\n  fix: ")[0]


def _remedy(said: str) -> str:
    try:
        answer = json.loads(said.splitlines()[0])
        return str(answer["remedy"]) or str(answer["message"]).partition("fix: ")[2]
    except (ValueError, KeyError, IndexError):
        return said.partition("fix: ")[2]
