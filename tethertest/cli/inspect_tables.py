"""What ``inspect`` found, as a page on the terminal."""

from __future__ import annotations

from typing import Any

import typer

from tethertest.cli.terminal import printable, table_console
from tethertest.jobs.remarks import grouped, some

#: separators that say nothing when they are printed as they are
_SEPARATORS = {"\t": "tab", " ": "spaces", ",": "comma", ";": "semicolon"}
_DECIMALS = {".": "decimal point", ",": "decimal comma"}


def print_log(log: dict[str, Any]) -> None:
    """Print what is known of one log; a refusal goes to standard error."""
    log = printable(log)
    if log["refused"]:
        _print_refusal(log)
        return
    typer.echo(f"{log['path']}: {log['format']}")
    typer.echo(f"  why this reader: {log['reason']}")
    if log.get("header_line") or log["encoding"]:
        typer.echo(f"  text: {', '.join(_text(log))}")
    start = log["start"]
    typer.echo(f"  start: {_start(start) if start else 'not stated in the file'}")
    bases = log.get("time_bases", [])
    for base in bases:
        whose = "" if len(bases) == 1 else f" of {some(base['channels'])}"
        typer.echo(f"  time{whose}: {base['text']}")
    if log.get("rate"):
        typer.echo(f"  rate as the file or its setting states it: {log['rate']:.6g} Hz")
    of_time = {name for base in bases for name in base["flags"]}
    _print_channels(log["channels"], of_time)
    for remark in grouped(log["remarks"]):
        typer.echo(f"  note: {remark}")
    if log.get("entry"):
        typer.echo("  for run.toml:")
        for line in log["entry"].splitlines():
            typer.echo(f"    {line}")


def _print_refusal(log: dict[str, Any]) -> None:
    where = f"{log['path']}:{log['line']}" if log["line"] is not None else log["path"]
    typer.echo(f"error: {where}: {log['message']}", err=True)
    if log["remedy"]:
        typer.echo(f"  fix: {log['remedy']}", err=True)
    if log["format"]:
        typer.echo(f"  reader: {log['format']} ({log['reason']})", err=True)


def _text(log: dict[str, Any]) -> list[str]:
    said = [log["encoding"]] if log["encoding"] else []
    if log.get("separator"):
        said.append(f"columns separated by {_SEPARATORS.get(log['separator'], repr(log['separator']))}")
    if log.get("decimal"):
        said.append(_DECIMALS.get(log["decimal"], log["decimal"]))
    if log.get("date_order"):
        said.append(f"dates as {log['date_order']}")
    if log.get("header_line"):
        said.append(f"names in line {log['header_line']}")
    return said


def _start(start: str) -> str:
    has_zone = start.endswith("Z") or start[-6] in "+-"
    return start if has_zone else f"{start}, without a time zone"


def _print_channels(channels: list[dict[str, Any]], of_time: set[str]) -> None:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("channel", overflow="fold")
    for heading in ("kind", "unit", "as written"):
        table.add_column(heading)
    for heading in ("n", "rate Hz", "span s", "minimum", "mean", "maximum"):
        table.add_column(heading, justify="right")
    table.add_column("flags")
    for channel in channels:
        flags = ", ".join(
            f"{name} {count}" for name, count in channel["flags"].items() if count and name not in of_time
        )
        numbers = [channel[key] for key in ("rate", "duration", "minimum", "mean", "maximum")]
        table.add_row(
            channel["name"],
            channel["kind"],
            channel["unit"],
            channel["unit_as_written"] or "none",
            str(channel["n"]),
            *("" if number is None else f"{number:.6g}" for number in numbers),
            flags,
        )
    table_console().print(table)
