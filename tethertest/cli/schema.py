"""``tethertest schema``: JSON schemas of the files that people write."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer


class FileKind(StrEnum):
    """Kinds of files with a schema."""

    RUN = "run"
    RIG = "rig"
    PROTOTYPE = "prototype"
    SCENE = "scene"


def schema(kind: Annotated[FileKind, typer.Argument(help="Which file.")]) -> None:
    """Print the JSON schema of a run, rig, prototype or scene file, for editors that check while typing."""
    from tethertest.readers import json_schema

    typer.echo(json.dumps(json_schema(kind.value), indent=2, ensure_ascii=False))
