"""``tethertest analyze``: lines with verdicts, events and waves of a run, a run store or a log."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer


def analyze(
    path: Annotated[Path, typer.Argument(help="A run folder, a run store, or any log.")],
    channel: Annotated[
        list[str] | None, typer.Option("--channel", help="Channel to analyse; may be repeated [all].")
    ] = None,
    drive_frequency: Annotated[
        str | None, typer.Option(help="Nominal frequency of the drive, in Hz or with its unit [run.toml's].")
    ] = None,
    window: Annotated[
        str | None, typer.Option(help="Seconds to analyse, START:STOP [the steady window, found].")
    ] = None,
    natural: Annotated[
        list[str] | None, typer.Option(help="A natural frequency that is known; may be repeated.")
    ] = None,
    mains: Annotated[str, typer.Option(help="Frequency of the mains.")] = "50 Hz",
    replay: Annotated[bool, typer.Option("--replay", help="Analyse the replayed channels too.")] = False,
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", help="KEY=VALUE of a [[log]] entry, for a bare log; may be repeated."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Find the orders of the drive with verdicts, slack, snaps, load cycles and waves."""
    from tethertest.pipeline.analysis_options import asked_options
    from tethertest.pipeline.analyze import analyze as analyze_path
    from tethertest.render.analysis import analysis_summary

    options = asked_options(
        channels=tuple(channel or ()),
        drive_frequency=drive_frequency,
        window=window,
        naturals=tuple(natural or ()),
        mains=mains,
        replay=replay,
        rigs=rigs,
        settings=tuple(settings or ()),
    )
    found = analysis_summary(analyze_path(path, options))
    if as_json:
        typer.echo(json.dumps(found, ensure_ascii=False, allow_nan=False))
        return
    from tethertest.cli.analysis_tables import print_analysis

    print_analysis(found)
