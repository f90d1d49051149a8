"""``tethertest schema``: JSON schemas of the files that people write, and of what commands print."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

if TYPE_CHECKING:
    from tethertest.readers.config.schema import FileKind


class SchemaKind(StrEnum):
    """What has a schema."""

    RUN = "run"
    RIG = "rig"
    PROTOTYPE = "prototype"
    SCENE = "scene"
    SOLVE = "solve"
    INSPECT = "inspect"


def schema(kind: Annotated[SchemaKind, typer.Argument(help="A kind of file, or a command.")]) -> None:
    """Print the JSON schema of run, rig, prototype or scene files, or of what a command's --json prints."""
    typer.echo(json.dumps(_schema(kind), indent=2, ensure_ascii=False))


def _schema(kind: SchemaKind) -> dict[str, Any]:
    if kind is SchemaKind.SOLVE:
        from tethertest.pipeline.solve_summary import solve_schema

        return solve_schema()
    if kind is SchemaKind.INSPECT:
        from tethertest.pipeline.inspect_schema import inspect_schema

        return inspect_schema()
    from tethertest.readers import json_schema

    return json_schema(cast("FileKind", kind.value))
