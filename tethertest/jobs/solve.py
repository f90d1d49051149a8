"""The solver alone: a scene file in, a response out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast, get_args

from tethertest.errors import DataError
from tethertest.readers import load_scene
from tethertest.readers.config.problems import suggestion
from tethertest.readers.config.scene_checks import size_problems
from tethertest.readers.config.scene_series import read_motion, read_wind
from tethertest.records.response import Response
from tethertest.records.scene import FieldName, Scene
from tethertest.solver import Fidelity, LinearScheme, solve


def solve_scene(
    path: Path,
    fidelity: Fidelity = "auto",
    tolerance: float | None = None,
    *,
    scheme: LinearScheme = "auto",
    cells: int | None = None,
    fields: Sequence[str] | None = None,
    native_times: bool = False,
    output: Path | None = None,
) -> Response:
    """Solve a scene file.

    Parameters
    ----------
    path : Path
        Scene file.
    fidelity : {"auto", "catenary", "linear", "nonlinear"}
        Model wanted.
    tolerance : float, optional
        Relative error wanted; the scene's own if absent.
    scheme : {"auto", "exact", "two-grid", "as-printed"}
        Of the linear model.
    cells : int, optional
        Solve on this mesh alone, without an error estimate.
    fields : sequence of str, optional
        Of "position", "velocity" and "curvature"; the scene's own if absent.
    native_times : bool
        Answer at the scheme's own time levels in place of t = k/rate.
    output : Path, optional
        File that is to be written; it must be none that the scene reads.

    Raises
    ------
    TethertestError
        The file, a series that it names, or the scene cannot be solved.
    """
    scene = load_scene(path)
    if fields is not None:
        scene = _with_fields(scene, fields)
    if output is not None:
        _check_output(scene, output)
    return solve(
        scene,
        measured=read_motion(scene),
        wind=read_wind(scene),
        fidelity=fidelity,
        scheme=scheme,
        tolerance=tolerance,
        cells=cells,
        native_times=native_times,
    )


def _check_output(scene: Scene, output: Path) -> None:
    """Refuse to write over a series that the scene reads."""
    wind_file = None if scene.air is None else scene.air.wind_file
    for file in (scene.bottom.file, wind_file):
        if file is not None and output.resolve() == Path(file).resolve():
            message = f"--output: {output} is a file that the scene reads"
            raise DataError(message, "choose another name")


def _with_fields(scene: Scene, names: Sequence[str]) -> Scene:
    """Return the scene with other fields in its output.

    Raises
    ------
    DataError
        A name is none of a field, or so many values do not fit into memory.
    """
    known = get_args(FieldName)
    for name in names:
        if name not in known:
            message = f"--fields: found {name!r}, expected some of {', '.join(known)}"
            raise DataError(message, suggestion(name, known))
    wanted = cast("tuple[FieldName, ...]", tuple(dict.fromkeys(names)))
    output = replace(scene.output, fields=wanted)
    for problem in size_problems(output):
        message = f"--fields: {problem.text}"
        raise DataError(message, problem.remedy)
    return replace(scene, output=output)
