"""``tethertest bench``: speed against error on scenes of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def bench(
    scenes: Annotated[list[Path], typer.Argument(help="Scene files.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of page, table and figure.")] = Path(
        "reports/bench"
    ),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
    peers: Annotated[
        bool,
        typer.Option("--peers", help="Also run MoorDyn (extra `peers`) where it knows all of a scene."),
    ] = False,
) -> None:
    """Measure every model's speed against its error, by references of another kind.

    Takes minutes; the times are those of a machine that does nothing else.
    """
    from tethertest.bench.case import load_cases
    from tethertest.bench.files import speed_files
    from tethertest.bench.speed import Measured, measure_cases
    from tethertest.render.as_json import json_line
    from tethertest.render.write import write_files

    found = measure_cases(load_cases(scenes), with_peers=peers)
    words = ["tethertest bench", *(path.name for path in scenes), *(["--peers"] if peers else [])]
    for path in write_files(output, speed_files(found, " ".join(words))):
        typer.echo(str(path), err=True)
    if as_json:
        typer.echo(json_line(Measured(found)))
        return
    for scene in found:
        chosen, run = scene.chosen, scene.chosen.run
        error = "no number" if run.error is None else f"{run.error:.2g}"
        typer.echo(
            f"{scene.scene}: {chosen.fidelity}, {run.cells} cells, {run.wall * 1e3:.1f} ms, error {error} "
            f"against {scene.reference}"
        )
