"""``tethertest analyze``: lines with verdicts, events and waves of a run, a run store or a log."""

from __future__ import annotations

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
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for figures, table of orders and numbers.")
    ] = None,
    across: Annotated[
        bool, typer.Option("--across", help="Analyse the runs below a folder together.")
    ] = False,
    jobs: Annotated[int | None, typer.Option(help="Processes, with --across [one per core].")] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Find the orders of the drive with verdicts, slack, snaps, load cycles and waves."""
    from tethertest.errors import TethertestError
    from tethertest.jobs.analysis_options import asked_options
    from tethertest.jobs.analyze import analyze as analyze_path
    from tethertest.render.analysis import WrittenAnalysis, analysis_summary
    from tethertest.render.as_json import as_json as values_of
    from tethertest.render.as_json import json_line
    from tethertest.render.published import taken

    if output is not None and output.resolve() == path.resolve():
        message = "the output folder is the run folder, which holds raw data only"
        raise TethertestError(message, f"choose another one, such as {path / 'analysis'}", path=output)
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
    if across:
        from tethertest.cli.across import analyze_runs

        analyze_runs(path, options, output, jobs, as_json=as_json)
        return
    made = analyze_path(path, options)
    found = analysis_summary(made)
    if output is not None:
        from tethertest.render.analysis_files import write_analysis

        written, left_out = write_analysis(made, output)
        found = taken(WrittenAnalysis, analysis_summary(made, left_out), paths=tuple(map(str, written)))
    if as_json:
        typer.echo(json_line(found))
        return
    from tethertest.cli.analysis_tables import print_analysis

    print_analysis(values_of(found))
    if isinstance(found, WrittenAnalysis):
        typer.echo(f"  {len(found.paths)} files  ->  {output}")
