"""Columns of numbers on disk, in files that have no name and go with the process."""

from __future__ import annotations

import contextlib
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tethertest.errors import TethertestError


@dataclass(frozen=True, slots=True)
class Sizes:
    """How much is held in memory at once."""

    block: int = 1 << 18  #: rows
    whole: int = 1 << 20  #: rows of one column up to which a statistic takes it whole
    thinned: int = 1 << 20  #: numbers of the thinned copy, over all its columns


class Scratch:
    """A folder for columns, which are closed with it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._columns: list[Column] = []

    def column(self, dtype: str) -> Column:
        """Return a new column.

        Raises
        ------
        TethertestError
            The folder cannot be written.
        """
        column = Column(self.folder, dtype)
        self._columns.append(column)
        return column

    def __enter__(self) -> Scratch:
        return self

    def __exit__(self, *error: object) -> None:
        for column in self._columns:
            column.close()


class Column:
    """Numbers that are appended once and read in pieces."""

    def __init__(self, folder: Path, dtype: str) -> None:
        try:
            self._file = tempfile.TemporaryFile(dir=folder)  # noqa: SIM115 - lives as long as the column
        except OSError as error:
            raise no_scratch(folder, error) from error
        self._folder = folder
        self.dtype = dtype
        self._dtype = np.dtype(dtype)
        self.size = 0

    def close(self) -> None:
        """Give the space on the disk back."""
        with contextlib.suppress(OSError):  # what could not be written any more is not needed
            self._file.close()

    def append(self, values: npt.NDArray[Any]) -> None:
        """Add values at the end.

        Raises
        ------
        TethertestError
            The disk is full.
        """
        block = np.ascontiguousarray(values, dtype=self._dtype)
        try:
            self._file.seek(self.size * self._dtype.itemsize)
            self._file.write(block.tobytes())
        except OSError as error:
            raise no_scratch(self._folder, error) from error
        self.size += block.size

    def read(self, start: int, stop: int) -> npt.NDArray[Any]:
        """Return the values of some rows; rows before the first or after the last are left out."""
        start, stop = max(start, 0), min(stop, self.size)
        try:
            self._file.flush()
        except OSError as error:
            raise no_scratch(self._folder, error) from error
        self._file.seek(start * self._dtype.itemsize)
        content = self._file.read(max(stop - start, 0) * self._dtype.itemsize)
        return np.frombuffer(content, dtype=self._dtype)


def no_scratch(folder: Path, error: OSError) -> TethertestError:
    """Return the error about a scratch file that cannot be written."""
    what = (error.strerror or str(error)).lower()
    message = f"a log this large needs scratch space, and it cannot be written ({what})"
    remedy = "free about as much space as the log takes, or name a store on another disk with -o"
    return TethertestError(message, remedy, path=folder)
