"""``tethertest solve``: the solver alone."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tethertest.cli.exit_codes import UNDECIDED

if TYPE_CHECKING:
    from tethertest.jobs.solve_summary import SolveSummary

#: meshes worth asking for
FEWEST_CELLS, MOST_CELLS = 2, 20_000


class FidelityChoice(StrEnum):
    """Models that a user can ask for."""

    AUTO = "auto"
    CATENARY = "catenary"
    LINEAR = "linear"
    NONLINEAR = "nonlinear"


class SchemeChoice(StrEnum):
    """Schemes of the linear model."""

    AUTO = "auto"
    EXACT = "exact"
    TWO_GRID = "two-grid"
    AS_PRINTED = "as-printed"


def solve(
    scene: Annotated[Path, typer.Argument(help="Scene file.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="File of the series at the gauges, .csv or .h5."),
    ] = None,
    fidelity: Annotated[
        FidelityChoice, typer.Option(help="Model; auto takes what the scene needs.")
    ] = FidelityChoice.AUTO,
    scheme: Annotated[
        SchemeChoice,
        typer.Option(
            help="Scheme of the linear model. auto never picks two-grid, a check on exact, nor as-printed, "
            "the source article's own, whose waves all run at the transverse speed."
        ),
    ] = SchemeChoice.AUTO,
    tolerance: Annotated[str | None, typer.Option(help='Relative error wanted, such as "1 %".')] = None,
    cells: Annotated[
        int | None,
        typer.Option(
            min=FEWEST_CELLS, max=MOST_CELLS, help="Solve on this mesh alone, without an error estimate."
        ),
    ] = None,
    fields: Annotated[
        str | None,
        typer.Option(help="Also write these of position,velocity,curvature; the scene's own if absent."),
    ] = None,
    native_times: Annotated[
        bool, typer.Option("--native-times", help="Write the scheme's own time levels, not t = k/rate.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Solve one scene: tension and strain at its gauges, with the estimated error."""
    from tethertest.jobs.parse_option import TOLERANCE, parse_option
    from tethertest.jobs.response_files import response_writer
    from tethertest.jobs.solve import solve_scene
    from tethertest.jobs.solve_summary import solve_summary
    from tethertest.records.response import Status
    from tethertest.render.write import write_files

    writer = None if output is None else response_writer(output)
    response = solve_scene(
        scene,
        fidelity.value,
        None if tolerance is None else parse_option("--tolerance", tolerance, TOLERANCE),
        scheme=scheme.value,
        cells=cells,
        fields=None if fields is None else [name.strip() for name in fields.split(",") if name.strip()],
        native_times=native_times,
        output=output,
    )
    is_solved = response.status is not Status.NOT_FINITE
    if output is not None and writer is not None and is_solved:
        write_files(output.parent, {output.name: writer(response)})
    found = solve_summary(response)
    if as_json:
        from tethertest.render.as_json import json_line

        typer.echo(json_line(found))
    else:
        _print_summary(found)
    if not is_solved:
        typer.echo(f"error: nothing was written. {found.advice}", err=True)
        raise typer.Exit(UNDECIDED)


def _print_summary(found: SolveSummary) -> None:
    parts = [
        f"{name} {value:.2g}"
        for name, value in (
            ("numerical", found.error.numerical),
            ("model", found.error.model),
            ("spread", found.error.spread),
            ("of the 20 ms peak", found.error.peak),
        )
        if value is not None
    ]
    error = f"error {', '.join(parts)}" if parts else "error unknown"
    mesh = f", {found.cells} cells" if found.cells else ""
    typer.echo(f"{found.scene}: {found.fidelity} ({found.scheme}){mesh}, {error}. {found.advice}")
    for gauge in found.gauges:
        if gauge.minimum is not None and gauge.maximum is not None and gauge.mean is not None:
            extremes = f"{gauge.minimum:.4f} to {gauge.maximum:.4f} N"
            steady = gauge.smoothed_maximum
            smooth = "" if steady is None else f", of the 20 ms mean {steady:.4f} N"
            typer.echo(f"  at {gauge.at:g}: {extremes}{smooth}, mean {gauge.mean:.4f} N")
    for warning in found.warnings:
        typer.echo(f"  warning: {warning}")
