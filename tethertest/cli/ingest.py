"""``tethertest ingest``: raw logs into one file of conditioned channels."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import typer


def ingest(
    run: Annotated[Path, typer.Argument(help="Run folder with run.toml and raw logs.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The run store [reports/RUN/run.h5].")
    ] = None,
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Condition the raw logs of a run and keep the result in one HDF5 file, with its provenance.

    The file appears whole or not at all; an older one is replaced in one step. Raw logs are only read.
    """
    from tethertest.jobs.ingest import ingest_run

    with _bar() as progress:
        made = ingest_run(run, output, rigs, progress=progress)
    if as_json:
        from tethertest.render.as_json import json_line

        typer.echo(json_line(made))
        return
    samples = sum(made.channels.values())
    found = ", ".join(f"{count} {severity}" for severity, count in made.findings.items()) or "none"
    typer.echo(
        f"{made.run}: {len(made.channels)} channels, {samples} samples, findings: {found}  ->  {made.path} "
        f"({made.size / 1e6:.2f} MB)"
    )


@contextlib.contextmanager
def _bar() -> Iterator[Callable[[str, float | None], None]]:
    """Show what is being done on a terminal, and nothing in a pipe."""
    if not sys.stderr.isatty():
        yield lambda words, share: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=None)

        def show(words: str, share: float | None) -> None:
            bar.update(task, description=words, total=None if share is None else 1.0, completed=share or 0.0)

        yield show
