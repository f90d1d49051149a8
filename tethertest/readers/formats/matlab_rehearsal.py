"""The other process of `rehearse` for MATLAB files of version 7.3: reads each, and keeps nothing."""

from __future__ import annotations

import contextlib
from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.containers.mat73 import variables
from tethertest.readers.containers.matlab_items import Array, Item, Struct
from tethertest.readers.formats.hdf5 import opened
from tethertest.readers.formats.hdf5_rehearsal import main


def trouble(path: Path) -> list[str]:
    """Read each variable that any settings could ask for.

    Returns
    -------
    list of str
        What is wrong with the records of the file and what to do, or nothing; values that cannot be read are
        met again by who asks for them.
    """
    try:
        with opened(path) as file:
            for _, item in variables(path, file):
                _load(item)
    except FileFormatError as error:
        return [error.problem, error.remedy]
    except MemoryError:
        return ["the file's own records ask for more memory than it has data", "copy the whole file again"]
    return []


def _load(item: Item) -> None:
    if isinstance(item, Array):
        with contextlib.suppress(FileFormatError, MemoryError):
            item.load()
    elif isinstance(item, Struct):
        for values in item.fields.values():
            for value in values:
                _load(value)


if __name__ == "__main__":
    main(trouble)
