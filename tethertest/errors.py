"""What can go wrong because of an input; everything else is a fault of the program.

Every error says where, what was found, what was expected and what to do. The command line prints it without
a traceback and leaves with exit code 2.
"""

from __future__ import annotations

from pathlib import Path


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
    """

    def __init__(
        self, problem: str, remedy: str = "", *, path: Path | str | None = None, line: int | None = None
    ) -> None:
        self.problem = problem
        self.remedy = remedy
        self.path = None if path is None else str(path)
        self.line = line
        super().__init__(str(self))

    def __str__(self) -> str:
        where = ""
        if self.path is not None:
            where = f"{self.path}:{self.line}: " if self.line is not None else f"{self.path}: "
        remedy = f"\n  fix: {self.remedy}" if self.remedy else ""
        return f"{where}{self.problem}{remedy}"

    def located(self, path: Path | str, line: int | None = None) -> TethertestError:
        """Return the same error with a place, unless it already has one."""
        if self.path is not None:
            return self
        return type(self)(self.problem, self.remedy, path=path, line=line)


class QuantityError(TethertestError):
    """A quantity whose text, unit or dimension is wrong."""


class FileFormatError(TethertestError):
    """A log that is not what it claims to be, is cut, or belongs to another reader."""


class RunFileError(TethertestError):
    """A run, rig, prototype or scene file with a wrong, unknown or missing key."""


class DataError(TethertestError):
    """Data that were read right but cannot be used as asked."""
