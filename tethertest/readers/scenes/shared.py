"""Checks that several tables of a scene file share: vectors, and files beside the scene."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath, PureWindowsPath

from tethertest.readers.config.problems import NAME_SHOWN, Problem, is_file_name, suggestion
from tethertest.readers.config.toml import KeyPath


def vector_problems(key: KeyPath, vector: tuple[float, ...]) -> Iterator[Problem]:
    """Yield a vector that is neither [x, z] nor [x, y, z]."""
    if len(vector) not in {2, 3}:
        yield Problem(key, f"found {len(vector)} components, expected 2 or 3", "write [x, z] or [x, y, z]")


def file_problems(key: KeyPath, file: str, folder: Path) -> Iterator[Problem]:
    """Yield what is wrong with the name of a file that must lie in the scene's folder."""
    remedy = "copy the file into the scene's folder and give its name"
    windows = PureWindowsPath(file)
    is_outside = (
        PurePosixPath(file).is_absolute() or bool(windows.drive or windows.root) or ".." in windows.parts
    )
    if not is_file_name(file):
        yield Problem(key, f"found {file[:NAME_SHOWN]!r}, which no file can be called", remedy)
    elif is_outside or not file or not _is_inside(folder / file, folder):
        yield Problem(key, f"found {file!r}, expected a file inside the scene's folder", remedy)
    elif not (folder / file).is_file():
        nearby = sorted(
            entry.name for entry in folder.iterdir() if entry.is_file() and entry.suffix != ".toml"
        )
        text = f"found {file!r}, but there is no such file beside the scene"
        yield Problem(key, text, suggestion(file, nearby) if nearby else remedy)


def _is_inside(path: Path, folder: Path) -> bool:
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # a link that leads to itself
        return False
