"""``tethertest new``: a draft of run.toml."""

from __future__ import annotations

import json
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
    from tethertest.pipeline.draft_text import TODO, draft_text
    from tethertest.pipeline.new_run import new_run

    path, draft = new_run(run, logs or (), rigs)
    left = [
        f"{number}: {line}" for number, line in enumerate(draft_text(draft).splitlines(), 1) if TODO in line
        and number > 2
    ]  # fmt: skip
    if as_json:
        content = {
            "path": str(path),
            "rig": None if draft.rig == TODO else draft.rig,
            "logs": [
                {
                    "file": log.file,
                    "format": log.format,
                    "clock": None if log.clock == TODO else log.clock,
                    "channels": log.matched.guessed,
                    "problem": log.problem or None,
                }
                for log in draft.logs
            ],
            "left_out": [file for file, _ in draft.left_out],
            "todo": left,
        }
        typer.echo(json.dumps(content, ensure_ascii=False, allow_nan=False))
        return
    typer.echo(f"{path}: {len(draft.logs)} logs, rig {draft.rig}; to complete:")
    for line in left:
        typer.echo(f"  {line}")
