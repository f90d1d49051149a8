"""What can go wrong because of an input; everything else is a fault of the program.

Every error says where, what was found, what was expected and what to do. The command line prints it without
a traceback and leaves with exit code 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final, Self

#: the option that stands for the log's entry in run.toml where a log belongs to no run
SET: Final = "--set"


def where_set(keys: Sequence[str], *, by_option: bool) -> str:
    """Return where a person sets keys of a log: in its run, or on the command line for a log without one."""
    if not by_option:
        return "in this log's entry in run.toml"
    words = ["units.NAME=UNIT" if key == "units" else f"{key}=VALUE" for key in keys]
    return f"{' or '.join(f'{SET} {word}' for word in words)}, or in the log's entry in run.toml"


class TethertestError(Exception):
    """A mistake in a file, a setting or a log that the user can mend.

    Parameters
    ----------
    problem : str
        What was found and what was expected.
    remedy : str
        What to do about it.
    path : Path or str, optional
        The file concerned.
    line : int, optional
        Line of the file, counted from 1.
    keys : sequence of str
        Keys of the log's entry in run.toml that mend it; the remedy then ends with where they are set.
    by_option : bool
        The log belongs to no run: the keys are set on the command line.
    """

    def __init__(
        self,
        problem: str,
        remedy: str = "",
        *,
        path: Path | str | None = None,
        line: int | None = None,
        keys: Sequence[str] = (),
        by_option: bool = False,
    ) -> None:
        self.problem = problem
        self.advice = remedy  #: the remedy without where keys are set
        self.remedy = f"{remedy} ({where_set(keys, by_option=by_option)})" if keys else remedy
        self.path = None if path is None else str(path)
        self.line = line
        self.keys = tuple(keys)
        super().__init__(str(self))

    def __str__(self) -> str:
        where = ""
        if self.path is not None:
            where = f"{self.path}:{self.line}: " if self.line is not None else f"{self.path}: "
        remedy = f"\n  fix: {self.remedy}" if self.remedy else ""
        return f"{where}{self.problem}{remedy}"

    def located(self, path: Path | str, line: int | None = None) -> Self:
        """Return the same error with a place, unless it already has one."""
        if self.path is not None:
            return self
        return self.moved(path, line)

    def moved(self, path: Path | str | None, line: int | None = None) -> Self:
        """Return the same error at another place."""
        return type(self)(self.problem, self.advice, path=path, line=line, keys=self.keys)

    def without_run(self) -> Self:
        """Return the same error of a log that belongs to no run: its keys are set on the command line."""
        return type(self)(
            self.problem, self.advice, path=self.path, line=self.line, keys=self.keys, by_option=True
        )


class QuantityError(TethertestError):
    """A quantity whose text, unit or dimension is wrong."""


class FileFormatError(TethertestError):
    """A log that is not what it claims to be, is cut, or belongs to another reader."""


class RunFileError(TethertestError):
    """A run, rig, prototype or scene file with a wrong, unknown or missing key."""


class DataError(TethertestError):
    """Data that were read right but cannot be used as asked."""
