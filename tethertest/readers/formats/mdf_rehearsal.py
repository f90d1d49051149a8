"""The other process of `rehearse` for MDF files."""

from __future__ import annotations

from pathlib import Path

from tethertest.readers.containers.rehearsing import serve
from tethertest.readers.formats.mdf import opened
from tethertest.readers.formats.mdf_channels import channels_of


def read_all(path: Path) -> None:
    """Read each channel."""
    with opened(path, is_rehearsed=True) as file:
        channels_of(path, file, None)


if __name__ == "__main__":
    serve(read_all, "asammdf")
