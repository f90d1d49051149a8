"""``tethertest inspect``: what a log or a run folder is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer


def inspect(
    path: Annotated[Path, typer.Argument(help="A log, a run folder, or a run store.")],
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Say what a log or run folder is: format, channels, units, rate, span, flags."""
    from tethertest.pipeline.inspect import inspect_path

    found = inspect_path(path, rigs)
    if as_json:
        typer.echo(json.dumps(found, ensure_ascii=False, allow_nan=False))
        return
    for log in found.get("logs", [found]):
        _print_log(log)


def _print_log(log: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False, width=None if Console().is_terminal else 120)
    console.print(f"{log['path']}: {log['format']} ({log['reason']})", markup=False, soft_wrap=True)
    console.print(
        f"  start {log['start'] or 'not stated'}, encoding {log['encoding'] or 'binary'}", markup=False
    )
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("channel", "kind", "unit", "as written"):
        table.add_column(heading)
    for heading in ("n", "rate Hz", "span s", "minimum", "mean", "maximum"):
        table.add_column(heading, justify="right")
    table.add_column("flags")
    for channel in log["channels"]:
        flags = ", ".join(f"{name} {count}" for name, count in channel["flags"].items() if count)
        numbers = [channel[key] for key in ("rate", "duration", "minimum", "mean", "maximum")]
        table.add_row(
            channel["name"],
            channel["kind"],
            channel["unit"],
            channel["unit_as_written"],
            str(channel["n"]),
            *("" if number is None else f"{number:.6g}" for number in numbers),
            flags,
        )
    console.print(table)
    for remark in log["remarks"]:
        console.print(f"  note: {remark}", markup=False, soft_wrap=True)
