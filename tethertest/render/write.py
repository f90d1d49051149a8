"""Files written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from tethertest.errors import TethertestError

_REMEDY = "choose another output folder, or mend its permissions and free space"


def write_files(folder: Path, contents: Mapping[str, bytes]) -> tuple[Path, ...]:
    """Write files into a folder by way of temporary files beside them.

    Parameters
    ----------
    folder : Path
        Output folder, made with its parents if it does not exist.
    contents : mapping
        File name -> complete content.

    Returns
    -------
    tuple of Path
        The files, in the order given.

    Raises
    ------
    TethertestError
        The folder or one of the files cannot be written; older files of that name are then as they were.
    """
    _make_folder(folder)
    targets = tuple(folder / name for name in contents)
    for target in targets:
        if target.is_dir():
            problem = "a folder stands where the report's file belongs"
            raise TethertestError(problem, "remove it or choose another output folder", path=target)
    partials = tuple(folder / f".{name}.{os.getpid()}.partial" for name in contents)
    try:
        for partial, content in zip(partials, contents.values(), strict=True):
            partial.write_bytes(content)
        for partial, target in zip(partials, targets, strict=True):
            partial.replace(target)
    except OSError as error:
        problem = f"the report cannot be written here ({error.strerror})"
        raise TethertestError(problem, _REMEDY, path=folder) from error
    finally:
        _remove(partials)
    return targets


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        problem = "a file stands where the output folder belongs"
        raise TethertestError(
            problem, "remove the file or choose another output folder", path=folder
        ) from error
    except OSError as error:
        problem = f"the output folder cannot be made ({error.strerror})"
        raise TethertestError(problem, _REMEDY, path=folder) from error


def _remove(partials: tuple[Path, ...]) -> None:
    for partial in partials:
        try:
            partial.unlink(missing_ok=True)
        except OSError:  # the folder vanished or was locked; the error above says so
            continue
