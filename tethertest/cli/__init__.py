"""The command line: one file per command, no maths.

Exit codes: 0 pass, 1 fail, 2 bad input, 3 a fault of the program, 4 undecided.
"""

from __future__ import annotations

import gc
import io
import sys

import typer

from tethertest.cli.analyze import analyze
from tethertest.cli.bench import bench
from tethertest.cli.exit_codes import BAD_INPUT, INTERRUPTED, PROGRAM_FAULT
from tethertest.cli.export import export
from tethertest.cli.ingest import ingest
from tethertest.cli.inspect import inspect
from tethertest.cli.new import new
from tethertest.cli.report import report
from tethertest.cli.scale import scale
from tethertest.cli.schema import schema
from tethertest.cli.solve import solve
from tethertest.cli.terminal import printable
from tethertest.cli.version import show_version
from tethertest.errors import TethertestError

app = typer.Typer(
    rich_markup_mode=None,  # help texts speak of [[log]] and units in brackets
    name="tethertest",
    help="Experiment-data analysis and similitude for ship-borne tethered UAVs.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.callback()(show_version)
for command in (report, inspect, new, analyze, ingest, export, solve, scale, bench, schema):
    app.command()(command)

#: as Python's own, but seldom: the objects of a few imported libraries are searched for garbage in vain
_COLLECTIONS = (100_000, 20, 100)


def main() -> None:
    """Run the command line; a user's mistake is one message and exit code 2, never a traceback."""
    gc.set_threshold(*_COLLECTIONS)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a file's name may be no text in the terminal's encoding
            stream.reconfigure(errors="backslashreplace")
    try:
        app()
    except TethertestError as error:
        sys.stderr.write(f"error: {printable(str(error))}\n")
        raise SystemExit(BAD_INPUT) from None
    except (KeyboardInterrupt, BrokenPipeError):
        raise SystemExit(INTERRUPTED) from None
    except Exception:
        import traceback

        traceback.print_exc()
        sys.stderr.write(
            "\nThis is a fault of tethertest, not of your files: please report it with the lines above.\n"
        )
        raise SystemExit(PROGRAM_FAULT) from None
