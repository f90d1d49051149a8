"""``tethertest report``: the main job."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tethertest.cli.exit_codes import FAILED, PASSED, UNDECIDED

EXIT_CODES = {"pass": PASSED, "fail": FAILED, "undecided": UNDECIDED}


def report(
    run: Annotated[Path, typer.Argument(help="Run folder with run.toml and raw logs.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder of the report [reports/RUN].")
    ] = None,
    rigs: Annotated[
        Path | None, typer.Option(help="Folder of rig files [found upwards from the run].")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
) -> None:
    """Replay a run and write its validation report: page, figures, summary and verdict.

    Exit code 0 pass, 1 fail, 2 bad input, 3 fault of the program, 4 undecided.
    """
    from tethertest.errors import TethertestError
    from tethertest.jobs.report import make_report
    from tethertest.render import write_report

    folder = Path("reports") / run.resolve().name if output is None else output
    if folder.resolve() == run.resolve():
        message = "the output folder is the run folder, which holds raw data only"
        raise TethertestError(message, f"choose another one, such as {run / 'report'}", path=folder)
    made = make_report(run, rigs)
    paths = write_report(made, folder)
    verdict = made.comparison.verdict.value
    if as_json:
        from tethertest.render.as_json import json_line
        from tethertest.render.published import taken
        from tethertest.render.summary import PrintedSummary, summary

        typer.echo(json_line(taken(PrintedSummary, summary(made), paths=tuple(map(str, paths)))))
    else:
        reason = made.comparison.reasons[0] if made.comparison.reasons else ""
        typer.echo(f"{verdict.upper()}  {made.run.file.id}: {reason}  ->  {paths[0]}")
    raise typer.Exit(EXIT_CODES[verdict])
