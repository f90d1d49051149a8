"""``tethertest solve``: the solver alone."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class FidelityChoice(StrEnum):
    """Models that a user can ask for."""

    AUTO = "auto"
    LINEAR = "linear"
    NONLINEAR = "nonlinear"


def solve(
    scene: Annotated[Path, typer.Argument(help="Scene file.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="CSV file of tension and strain at the gauges.")
    ] = None,
    fidelity: Annotated[
        FidelityChoice, typer.Option(help="Model; auto takes what the scene needs.")
    ] = FidelityChoice.AUTO,
    tolerance: Annotated[str | None, typer.Option(help='Relative error wanted, such as "1 %".')] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Solve one scene: tension and strain at its gauges, with the estimated error."""
    from tethertest.pipeline.asked import TOLERANCE, asked
    from tethertest.pipeline.solve import response_csv, response_summary, solve_scene
    from tethertest.render.write import write_files

    wanted = None if tolerance is None else asked("--tolerance", tolerance, TOLERANCE)
    response = solve_scene(scene, fidelity.value, wanted)
    if output is not None:
        write_files(output.parent, {output.name: response_csv(response).encode("utf-8")})
    found = response_summary(response)
    if as_json:
        typer.echo(json.dumps(found, ensure_ascii=False, allow_nan=False))
        return
    numerical = found["error"]["numerical"]
    error = "error unknown" if numerical is None else f"error {numerical:.2g}"
    typer.echo(f"{found['scene']}: {found['fidelity']}, {found['cells']} cells, {error}. {found['advice']}")
    for gauge in found["gauges"]:
        extremes = f"{gauge['minimum']:.4f} to {gauge['maximum']:.4f} N"
        typer.echo(f"  at {gauge['at']:g}: {extremes}, mean {gauge['mean']:.4f} N")
    for warning in found["warnings"]:
        typer.echo(f"  warning: {warning}")
