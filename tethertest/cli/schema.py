"""``tethertest schema``: JSON schemas of the files that people write, and of what commands print."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer


class SchemaKind(StrEnum):
    """What has a schema: a kind of file, or the JSON of a command."""

    RUN = "run"
    RIG = "rig"
    PROTOTYPE = "prototype"
    SCENE = "scene"
    REPORT = "report"
    ANALYZE = "analyze"
    ACROSS = "across"
    INSPECT = "inspect"
    SOLVE = "solve"
    SCALE = "scale"
    INGEST = "ingest"
    EXPORT = "export"
    NEW = "new"
    BENCH = "bench"


def schema(kind: Annotated[SchemaKind, typer.Argument(help="A kind of file, or a command.")]) -> None:
    """Print the JSON schema of run, rig, prototype or scene files, or of what a command's --json prints."""
    from tethertest.cli.schemas import schema_of

    typer.echo(json.dumps(schema_of(kind.value), indent=2, ensure_ascii=False))
