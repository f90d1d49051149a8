"""``tethertest analyze DIR --across``: curves over many runs on the terminal, as JSON and as figures."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from tethertest.cli.analysis_tables import print_table

if TYPE_CHECKING:
    from tethertest.jobs.analysis_options import Options

_UNITS = {"frequency": "Hz", "amplitude": "m"}


def analyze_runs(
    folder: Path, options: Options, output: Path | None, jobs: int | None, *, as_json: bool
) -> None:
    """Analyse the runs of a folder together, and print or write what they show."""
    from tethertest.errors import TethertestError
    from tethertest.jobs.across import analyze_across
    from tethertest.render.across import PrintedAcross, across_summary, write_across
    from tethertest.render.as_json import as_json as values_of
    from tethertest.render.as_json import json_line
    from tethertest.render.published import taken

    if jobs is not None and jobs < 1:
        message = f"--jobs: found {jobs}, expected 1 or more"
        raise TethertestError(message, "give a number of processes, or leave it out for one per core")
    if output is not None and (output / "run.toml").exists():
        message = "the output folder is a run folder, which holds raw data only"
        raise TethertestError(message, "choose another one", path=output)
    across = analyze_across(folder, options, jobs, _progress if sys.stderr.isatty() else None)
    paths = () if output is None else write_across(across, output)
    found = taken(PrintedAcross, across_summary(across), paths=tuple(map(str, paths)))
    if as_json:
        typer.echo(json_line(found))
        return
    _print(values_of(found))
    if paths:
        typer.echo(f"written: {len(paths)} files in {output}")


def _progress(done: int, there_are: int) -> None:
    typer.echo(f"\r{done} of {there_are} runs", nl=done == there_are, err=True)


def _print(found: dict[str, Any]) -> None:
    _print_runs(found["runs"])
    for number, group in enumerate(found["groups"]):
        against = group["against"]
        fixed = "amplitude" if against == "frequency" else "frequency"
        at = "" if group["fixed"] is None else f", {fixed} {group['fixed']:.4g} {_UNITS[fixed]}"
        typer.echo(f"against {against}: rig {group['rig']}, mode {group['mode']}{at}")
        for note in group["notes"]:
            typer.echo(f"  note: {note}")
        _print_curves([curve for curve in found["curves"] if curve["group"] == number], against)
        _print_loops([loop for loop in found["loops"] if loop["group"] == number], against)
    typer.echo(f"chance of one false jump in the folder: {found['significance']:.0%} on smooth curves")
    for note in found["notes"]:
        typer.echo(f"note: {note}")


def _print_runs(runs: list[dict[str, Any]]) -> None:
    rows = [
        (
            run["run"],
            run["mode"] or "",
            "" if run["frequency"] is None else f"{run['frequency']:.5g}",
            "" if run["amplitude"] is None else f"{run['amplitude']:.4g}",
            _most_lines(run),
            f"left out: {run['refused']}" if run["refused"] else "; ".join(_damages(run)),
        )
        for run in runs
    ]
    print_table(("run", "mode", "Hz", "m", "lines", ""), rows)


def _most_lines(run: dict[str, Any]) -> str:
    counts = [channel["lines_found"] for channel in run["channels"] if channel["side"] == "measured"]
    return str(max(counts)) if counts else ""


def _damages(run: dict[str, Any]) -> list[str]:
    """Return why channels are shown and not judged, those with one reason together."""
    reasons: dict[str, list[str]] = {}
    for channel in run["channels"]:
        if channel["damage"] and channel["side"] == "measured":
            reasons.setdefault(channel["damage"], []).append(channel["name"])
    said = [f"not judged: {', '.join(names)}: {reason}" for reason, names in reasons.items()]
    told = [remark for remark in run["remarks"] if remark.startswith(("not replayed", "run.toml:"))]
    # what keeps every channel from being judged is said above
    return said + [remark for remark in told if not any(remark.endswith(reason) for reason in reasons)]


def _print_curves(curves: list[dict[str, Any]], against: str) -> None:
    rows = []
    for curve in curves:
        points = curve["points"]
        settings = sorted({float(f"{point['setting']:.3g}") for point in points})
        unit = "" if curve["unit"] == "1" else f" {curve['unit']}"
        steps = [
            f"{step['verdict']} {step['interval'][0]:.4g} to {step['interval'][1]:.4g} {_UNITS[against]}"
            for step in curve["steps"]
        ]
        rows.append(
            (
                curve["channel"] if curve["side"] == "measured" else f"{curve['channel']} (replayed)",
                curve["order"],
                curve["direction"],
                f"{len(settings)}, {settings[0]:.3g} to {settings[-1]:.3g}",
                _largest(curve, unit),
                "; ".join(steps) or (curve["no_steps"] or "none"),
            )
        )
    print_table(("channel", "order", "sweep", f"settings {_UNITS[against]}", "largest", "jumps"), rows)
    for curve in curves:
        for step in curve["steps"]:
            typer.echo(
                f"  {curve['channel']} order {curve['order']} {curve['direction']}: {step['verdict']} "
                f"{step['amplitudes'][0]:.4g} to {step['amplitudes'][1]:.4g}: {step['reason']}"
            )


def _largest(curve: dict[str, Any], unit: str) -> str:
    point = curve["largest"]
    if point is None:
        return "none sure" if any(point["found"] for point in curve["points"]) else "no line"
    return f"{point['amplitude']:.4g}{unit} ± {point['standard_error']:.2g} at {point['setting']:.4g}"


def _print_loops(loops: list[dict[str, Any]], against: str) -> None:
    rows = []
    for loop in loops:
        differs = loop["differs"]
        where = "no" if differs is None else f"{differs[0]:.4g} to {differs[1]:.4g} {_UNITS[against]}"
        rows.append(
            (
                loop["channel"] if loop["side"] == "measured" else f"{loop['channel']} (replayed)",
                loop["order"],
                where,
                f"{loop['area']:.4g} ({loop['area_interval'][0]:.4g} to {loop['area_interval'][1]:.4g})",
                f"{loop['largest']:.4g} at {loop['largest_at']:.4g}",
            )
        )
    if rows:
        print_table(("hysteresis", "order", "up and down differ", "area", "largest, up less down"), rows)
