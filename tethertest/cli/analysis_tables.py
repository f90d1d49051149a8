"""An analysis as tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import typer

from tethertest.cli.terminal import printable, table_console

#: verdicts of lines that a reader need not see one by one
_QUIET = ("none",)


def print_analysis(found: dict[str, Any]) -> None:
    """Print the object of ``analyze --json`` for a person."""
    found = printable(found)
    drive, window = found["drive"], found["window"]
    said = "no drive"
    if drive is not None:
        said = f"drive {drive['frequency']:.7g} Hz ± {drive['standard_error']:.2g} (standard error)"
    if window is not None:
        said += f", window {window[0]:.3f} to {window[1]:.3f} s ({found['window_reason']})"
    typer.echo(f"{found['name']}: {said}")
    for natural in found["natural_frequencies"]:
        typer.echo(f"  natural frequency {natural['frequency']:.4g} Hz ({natural['name']})")
    _print_lines(found)
    _print_channels(found)
    _print_waves(found["waves"])
    for note in found["notes"]:
        typer.echo(f"  note: {note}")


def _print_lines(found: dict[str, Any]) -> None:
    rows = [
        (
            _label(channel),
            line["order"],
            f"{line['frequency']:.5g}",
            f"{line['amplitude']:.4g} {_unit(channel)}",
            f"{line['interval'][0]:.4g} to {line['interval'][1]:.4g}",
            f"{line['phase']:+.3f}",
            line["verdict"],
        )
        for channel in found["channels"]
        for line in channel["lines"]
        if line["verdict"] not in _QUIET
    ]
    rows += [
        (
            _label(channel),
            "-",
            f"{peak['frequency']:.5g}",
            f"{peak['amplitude']:.4g} {_unit(channel)}",
            "",
            "",
            "blind search" if peak["significant"] else "not significant",
        )
        for channel in found["channels"]
        for peak in channel["peaks"]
    ]
    if rows:
        print_table(("channel", "order", "Hz", "amplitude", "95 %", "phase rad", "verdict"), rows)
    for channel in found["channels"]:
        if channel["no_lines"] and not channel["peaks"]:
            typer.echo(f"  {_label(channel)}: no lines: {channel['no_lines']}")


def _print_channels(found: dict[str, Any]) -> None:
    rows = []
    for channel in found["channels"]:
        ends, cycles = channel["extremes"], channel["cycles"]
        if ends is None:
            continue
        slack = [event for event in channel["events"] if event["kind"] == "slack"]
        snaps = [
            event for event in channel["events"] if event["kind"] == "snap" and event["front"] is not None
        ]
        strongest = max(snaps, key=lambda snap: float(snap["front"]), default=None)
        rows.append(
            (
                _label(channel),
                f"{ends['minimum']:.4g}",
                f"{ends['maximum']:.4g} {_unit(channel)}",
                str(len(slack)) if slack else "",
                f"{sum(event['stop'] - event['start'] for event in slack):.3g}" if slack else "",
                "" if strongest is None else f"{strongest['front']:.4g}",
                "" if strongest is None or strongest["speed"] is None else f"{strongest['speed']:.3g}",
                "" if cycles is None else f"{cycles['number']:g}",
                "" if cycles is None else f"{cycles['equivalent_range']:.4g}",
            )
        )
    if rows:
        heads = ("minimum", "maximum", "slack", "slack s", "front N", "dv m/s", "cycles", "equal range")
        print_table(("channel", *heads), rows)


def _print_waves(waves: dict[str, Any]) -> None:
    speed = waves["speed"]
    if speed is not None:
        low, high = speed["interval"]
        ends = f"{low:.4g} to {high:.4g}" if high is not None else f"{low:.4g} or more"
        middle = "unknown" if speed["speed"] is None else f"{speed['speed']:.4g}"
        typer.echo(f"  {speed['kind']} wave: {middle} m/s ({ends}), from {len(waves['fronts'])} fronts")
    rows = []
    for part in waves["parts"]:
        for order in part["orders"]:
            name = f"{part['side']} {part['section']}"
            if order["refused"]:
                rows.append((name, order["order"], "", "", "", order["refused"]))
                continue
            low, high = order["energy_ratio_interval"]
            nature = {True: "standing", False: "travelling", None: "undecided"}[order["standing"]]
            rows.append(
                (
                    name,
                    order["order"],
                    f"{order['up']:.4g}",
                    f"{order['down']:.4g}",
                    f"{order['energy_ratio']:.3g} ({low:.3g} to {high:.3g})",
                    nature,
                )
            )
    if rows:
        print_table(("waves", "order", "up N", "down N", "energy ratio", ""), rows)
    largest = waves["largest_tension"]
    if largest is not None:
        low, high = largest["at_interval"]
        typer.echo(
            f"  largest replayed tension {largest['value']:.4g} N at {largest['at']:.3g} of the length "
            f"({low:.3g} to {high:.3g}), {largest['time']:.3f} s; bottom {largest['bottom']:.4g} N, "
            f"top {largest['top']:.4g} N"
        )
        more = largest["over_rest"]
        where = f"at {more['at']:.3g} of the length, {more['time']:.3f} s"
        typer.echo(f"  most above rest: {more['value']:.4g} N {where}")
    for remark in waves["remarks"]:
        typer.echo(f"  waves: {remark}")


def print_table(headings: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    """Print rows under their headings."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in headings:
        table.add_column(heading)
    for row in rows:
        table.add_row(*row)
    table_console().print(table)


def _label(channel: dict[str, Any]) -> str:
    name = str(channel["name"])
    return name if channel["side"] == "measured" else f"{name} (replayed)"


def _unit(channel: dict[str, Any]) -> str:
    return "" if channel["unit"] == "1" else str(channel["unit"])
