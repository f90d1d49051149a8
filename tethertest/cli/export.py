"""``tethertest export``: conditioned channels for other programs."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class ExportFormat(StrEnum):
    """Files that other programs read."""

    CSV = "csv"
    PARQUET = "parquet"
    MAT = "mat"
    SEP005 = "sep005"


def export(
    run: Annotated[Path, typer.Argument(help="Run folder, or run store as ingest writes it.")],
    to: Annotated[ExportFormat, typer.Option("--to", help="What to write.")] = ExportFormat.CSV,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The file [reports/RUN/run.*].")
    ] = None,
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Write the conditioned channels of a run, flags included, as CSV, Parquet, MATLAB or SEP005 file.

    CSV and Parquet have one table per time base: with several clocks each gets a file of its own.
    """
    from tethertest.jobs.export import export as write

    made = write(run, to.value, output, rigs)
    if as_json:
        from tethertest.render.as_json import json_line

        typer.echo(json_line(made))
        return
    typer.echo(f"{made.run}: {made.format}  ->  {', '.join(map(str, made.paths))}")
