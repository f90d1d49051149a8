"""``tethertest new``: a draft of run.toml."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def new(
    run: Annotated[Path, typer.Argument(help="Run folder with raw logs and no run.toml.")],
    logs: Annotated[
        list[Path] | None, typer.Argument(help="Logs of the folder [all that a reader recognises].")
    ] = None,
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Look at the logs of a folder and write a commented run.toml to complete."""
    from tethertest.jobs.draft_text import written_draft
    from tethertest.jobs.new_run import new_run
    from tethertest.render.as_json import json_line

    path, draft = new_run(run, logs or (), rigs)
    written = written_draft(path, draft)
    if as_json:
        typer.echo(json_line(written))
        return
    typer.echo(f"{path}: {len(draft.logs)} logs, rig {draft.rig}; to complete:")
    for line in written.todo:
        typer.echo(f"  {line}")
