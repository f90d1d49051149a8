"""Small logs written into a temporary folder."""

from __future__ import annotations

import gzip
import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tethertest.records.run import Log


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Write text in an encoding, with line ends, through a compression."""

    def writer(
        text: str | bytes,
        name: str = "log.txt",
        *,
        encoding: str = "utf-8",
        line_end: str = "\n",
        compression: str = "",
    ) -> Path:
        data = text if isinstance(text, bytes) else text.replace("\n", line_end).encode(encoding)
        if compression == "gz":
            data = gzip.compress(data)
        elif compression == "zip":
            buffer = io.BytesIO()
            with zipfile.ZipFile(buffer, "w") as archive:
                archive.writestr(name, data)
            data = buffer.getvalue()
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return writer


@pytest.fixture
def settings() -> Callable[..., Log]:
    """Make a log's entry of run.toml."""

    def maker(**keys: Any) -> Log:
        return Log(file="log.txt", clock="daq", **keys)

    return maker
