"""``tethertest scale``: pi groups, scale ratios and distortion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tethertest.cli.terminal import table_console


def scale(
    rig: Annotated[Path, typer.Argument(help="Rig file.")],
    to: Annotated[
        Path | None, typer.Option("--to", help="Prototype file [the one that the rig names].")
    ] = None,
    frequency: Annotated[str, typer.Option(help="Drive frequency on the rig.")] = "0.3 Hz",
    amplitude: Annotated[str, typer.Option(help="Drive amplitude on the rig.")] = "0.1 m",
    mode: Annotated[str, typer.Option(help="Platform mode of the rig.")] = "free",
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Compare a rig with its prototype: dimensionless groups, ratios and how distorted the model is."""
    from tethertest.jobs.scale import scale_rig
    from tethertest.render.as_json import json_line

    found = scale_rig(rig, to, frequency, amplitude, mode)
    if as_json:
        typer.echo(json_line(found))
        return
    from rich.table import Table

    console = table_console()
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("group", "product"):
        table.add_column(heading)
    for heading in ("model", "prototype", "model/prototype"):
        table.add_column(heading, justify="right")
    for heading in ("level", "meaning"):
        table.add_column(heading)
    for group in found.groups:
        product = " ".join(
            name if power == 1 else f"{name}^{power}" for name, power in group.exponents.items()
        )
        numbers = (group.model, group.prototype, group.ratio)
        table.add_row(
            group.name,
            product,
            *("" if number is None else f"{number:.4g}" for number in numbers),
            group.level,
            group.meaning,
        )
    console.print(table)
    for name, value in found.ratios.items():
        console.print(f"prototype/model {name}: {value:.5g}")
    for conflict in found.conflicts:
        console.print(f"cannot hold together: {', '.join(conflict)}")
