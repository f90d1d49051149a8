"""Hostile input is refused, or read as it stands, in bounded time and memory."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import pytest

from reports.hostile_input import process
from reports.hostile_input.case import INSPECT, Case
from reports.hostile_input.cases import CASES, MEMORY, SECONDS, faults, told

#: cases that one process can be asked together
TOGETHER: Final = [case for case in CASES if case.command == INSPECT and not case.slow]
RUNS: Final = [
    case
    for case in CASES
    if case.kind == "run" and case.command[0] == "inspect" and not case.slow and case.command[-1] != "{}"
]
#: each with a folder of rigs, a command or a time of its own
ALONE: Final = [case for case in CASES if case not in TOGETHER and case not in RUNS]


def placed(case: Case, folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / case.file
    case.make(path)
    return path


def asked_together(cases: list[Case], words: tuple[str, ...], folder: Path) -> None:
    """Ask one process of all cases, and hold what it says of each, its time and its memory."""
    paths = [placed(case, folder / str(number)) for number, case in enumerate(cases)]
    command = ("inspect", *map(str, paths), "--json", *words)
    done = process.run(command, folder, SECONDS * len(cases))
    answers = done.output.splitlines()
    assert len(answers) == len(cases), done.error
    wrong = {
        case.title: found
        for case, answer in zip(cases, answers, strict=True)
        if (found := told(case, 2 if '"refused": true' in answer else 0, answer, ""))
    }
    assert not wrong
    assert done.peak < MEMORY


def written(folder: Path) -> str:
    return "\n".join(path.read_text("utf-8") for path in folder.glob("run.csv"))


def test_no_case_is_called_as_another():
    titles = [case.title for case in CASES]
    assert len(set(titles)) == len(titles) > 100


@pytest.mark.parametrize(
    "kinds", [("HDF5",), ("MATLAB",), ("text", "JSON"), ()], ids=lambda kinds: kinds[0] if kinds else "others"
)
def test_hostile_input_is_refused_or_read_right(kinds, tmp_path):
    """A few kinds to a process: what one leaves in its memory does not count for the next."""
    others = [case for case in TOGETHER if case.kind not in {"HDF5", "MATLAB", "text", "JSON"}]
    cases = [case for case in TOGETHER if case.kind in kinds] if kinds else others
    assert cases
    asked_together(cases, (), tmp_path)


def test_hostile_run_folders_are_refused(tmp_path):
    asked_together(RUNS, ("--rigs", RUNS[0].command[-1]), tmp_path)


@pytest.mark.verify
@pytest.mark.parametrize("case", ALONE, ids=lambda case: re.sub(r"[^\x20-\x7e]", "?", case.title))
def test_the_others_each_in_a_process_of_its_own(case, tmp_path):
    placed(case, tmp_path)
    words = tuple(word.replace("{}", case.file) for word in case.command)
    assert faults(case, process.run(words, tmp_path), written(tmp_path)) == []
