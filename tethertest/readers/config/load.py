"""Rig, prototype, run and scene files: TOML in, records in SI out, every mistake told at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from tethertest.errors import RunFileError
from tethertest.readers.calibration import with_calibrations
from tethertest.readers.config.problems import (
    NAME_SHOWN,
    Problem,
    is_file_name,
    news,
    raise_problems,
    suggestion,
)
from tethertest.readers.config.rig_checks import prototype_problems, rig_problems
from tethertest.readers.config.run_checks import run_problems
from tethertest.readers.config.scene_checks import scene_problems
from tethertest.readers.config.structure import structure, uncertainties
from tethertest.readers.config.toml import TomlFile, read_document
from tethertest.records.rig import Prototype, Rig
from tethertest.records.run import Run, RunFile
from tethertest.records.scene import Scene

RUN_FILE = "run.toml"
RIGS_FOLDER = "rigs"

Record = TypeVar("Record")


def load_scene(path: Path | str) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path : Path or str
        The TOML file.

    Returns
    -------
    Scene
        In SI; ``bottom.file`` and ``air.wind_file`` are resolved against the scene's folder.

    Raises
    ------
    RunFileError
        The file is missing, is no TOML, or has wrong, unknown or missing keys: all of them in one message.
    """
    path = Path(path)
    document = read_document(path, "scene file")
    scene = _checked(Scene, document, lambda scene: scene_problems(scene, path.parent))
    if scene.bottom.file is not None:
        scene = replace(scene, bottom=replace(scene.bottom, file=str(path.parent / scene.bottom.file)))
    if scene.air is not None and scene.air.wind_file is not None:
        scene = replace(scene, air=replace(scene.air, wind_file=str(path.parent / scene.air.wind_file)))
    return scene


def load_rig(path: Path | str) -> Rig:
    """Read a rig file.

    Parameters
    ----------
    path : Path or str
        The TOML file.

    Returns
    -------
    Rig
        In SI; `Rig.uncertainty` has the standard uncertainties written as ``+/-``.

    Raises
    ------
    RunFileError
        As in `load_scene`.
    """
    document = read_document(Path(path), "rig file")
    rig = _checked(Rig, document, rig_problems)
    try:
        rig = with_calibrations(rig, Path(path).parent)
    except RunFileError as error:
        raise error.located(path) from None
    return replace(rig, uncertainty=uncertainties(Rig, document.data))


def load_prototype(path: Path | str) -> Prototype:
    """Read a prototype file.

    Parameters
    ----------
    path : Path or str
        The TOML file.

    Returns
    -------
    Prototype
        In SI; `Prototype.uncertainty` has the standard uncertainties written as ``+/-``.

    Raises
    ------
    RunFileError
        As in `load_scene`.
    """
    document = read_document(Path(path), "prototype file")
    prototype = _checked(Prototype, document, prototype_problems)
    return replace(prototype, uncertainty=uncertainties(Prototype, document.data))


def load_prototype_of(rig: Rig, rig_path: Path) -> Prototype | None:
    """Read the prototype that a rig names, from the rig file's folder; None where it names none.

    Raises
    ------
    RunFileError
        The prototype file is missing or wrong.
    """
    if rig.prototype is None:
        return None
    return load_prototype(rig_path.parent / f"{rig.prototype}.toml")


def load_run(folder: Path | str, rigs: Path | str | None = None) -> Run:
    """Read a run folder's run file and its rig; no log is opened.

    Parameters
    ----------
    folder : Path or str
        The run folder, or its run.toml.
    rigs : Path or str, optional
        Folder of the rig files; without it ``rigs/`` is looked for upwards from the run folder.

    Returns
    -------
    Run
        Folder, run file and rig.

    Raises
    ------
    RunFileError
        The run file or the rig file is missing or wrong, or a log is missing.
    """
    folder = Path(folder)
    if folder.name == RUN_FILE and not folder.is_dir():
        folder = folder.parent
    if not folder.is_dir():
        message = (
            "found a file, expected a run folder" if folder.exists() else "the run folder does not exist"
        )
        raise RunFileError(message, f"give the path of a folder with a {RUN_FILE}", path=folder)
    document = read_document(folder / RUN_FILE, "run file")
    file, problems = structure(RunFile, document.data)
    if file is None:
        raise_problems(document, problems)
        raise AssertionError(document.path)  # a record that cannot be made has problems
    rig_path = _find_rig(document, file.rig, folder, None if rigs is None else Path(rigs))
    rig = load_rig(rig_path)
    problems += news(run_problems(file, rig, folder), problems)
    raise_problems(document, problems)
    return Run(folder, file, rig, rig_path)


def _checked(kind: type[Record], document: TomlFile, checks: Callable[[Record], Iterable[Problem]]) -> Record:
    record, problems = structure(kind, document.data)
    if record is not None:
        problems += news(checks(record), problems)
    raise_problems(document, problems)
    if record is None:
        raise AssertionError(document.path)  # a record that cannot be made has problems
    return record


def _find_rig(document: TomlFile, name: str, folder: Path, rigs: Path | None) -> Path:
    if not name or Path(name).name != name or "\\" in name or not is_file_name(f"{name}.toml"):
        problem = Problem(
            ("rig",), f"found {name[:NAME_SHOWN]!r}, expected the name of a rig", 'write `rig = "rig3m"`'
        )
        raise_problems(document, [problem])
    if rigs is not None:
        folders = [rigs]
    else:
        absolute = folder.resolve()
        folders = [parent / RIGS_FOLDER for parent in (absolute, *absolute.parents)]
    for candidate in folders:
        if (candidate / f"{name}.toml").is_file():
            return candidate / f"{name}.toml"
    seen = [candidate for candidate in folders if candidate.is_dir()]
    if not seen:
        where = f"a folder {RIGS_FOLDER}/ of the run folder or above it" if rigs is None else str(rigs)
        text = f"found {name!r}, but there is no rig file in {where}"
        remedy = "give the folder of the rig files with --rigs"
    else:
        text = f"found {name!r}, but {seen[0]} has no {name}.toml"
        remedy = suggestion(name, sorted(entry.stem for entry in seen[0].glob("*.toml")))
    raise_problems(document, [Problem(("rig",), text, remedy)])
    raise AssertionError(name)  # the line above has raised
