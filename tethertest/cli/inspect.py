"""``tethertest inspect``: what a log or a run folder is."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tethertest.cli.exit_codes import BAD_INPUT


def inspect(
    path: Annotated[list[Path], typer.Argument(help="Logs, run folders or run stores.")],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", help="KEY=VALUE of a [[log]] entry, for bare logs; may be repeated."),
    ] = None,
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object a path, each on its own line.")
    ] = False,
) -> None:
    """Say what a log or run folder is and why it is read so: format, channels, units, rate, span, flags."""
    from tethertest.jobs.inspect import inspected
    from tethertest.render.as_json import as_json as values_of
    from tethertest.render.as_json import json_line

    refused = False
    for item in path:
        found = inspected(item, rigs, settings or ())
        refused |= found.refused
        if as_json:
            typer.echo(json_line(found))
            continue
        from tethertest.cli.inspect_tables import print_log

        values = values_of(found)
        for log in values.get("logs", [values]):
            print_log(log)
    if refused:
        raise typer.Exit(BAD_INPUT)
