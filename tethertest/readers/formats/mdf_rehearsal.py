"""The other process of `rehearse` for MDF files: reads each, and keeps nothing."""

from __future__ import annotations

from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.readers.formats.hdf5_rehearsal import main
from tethertest.readers.formats.mdf import opened
from tethertest.readers.formats.mdf_channels import channels_of


def trouble(path: Path) -> list[str]:
    """Read each channel that any settings could ask for.

    Returns
    -------
    list of str
        What is wrong with the file and what to do, or nothing.
    """
    try:
        with opened(path, is_rehearsed=True) as file:
            channels_of(path, file, None)
    except FileFormatError as error:
        return [error.problem, error.remedy]
    except MemoryError:
        return ["the file's own records ask for more memory than it has data", "copy the whole file again"]
    return []


if __name__ == "__main__":
    main(trouble, "asammdf")
