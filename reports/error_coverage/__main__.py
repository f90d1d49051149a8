"""``python -m reports.error_coverage [SCENES] [-o DIR]``: the table; exit 1 where a demand is missed."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.error_coverage.judge import Judged, Skipped, judge_until
from reports.error_coverage.table import coverage_table, demands
from tethertest.render.write import write_files


def main(arguments: list[str]) -> int:
    """Judge the scenes, print the table, write it where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.error_coverage", description=__doc__)
    parser.add_argument("scenes", nargs="?", type=int, default=300, help="with a verdict [300]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    verdicts = judge_until(asked.scenes)
    judged = [verdict for verdict in verdicts if isinstance(verdict, Judged)]
    skipped = [verdict for verdict in verdicts if isinstance(verdict, Skipped)]
    table = coverage_table(judged, skipped)
    sys.stdout.write(table)
    if asked.output is not None:
        write_files(asked.output, {"README.md": table.encode()})
    return 0 if all(demand.met for demand in demands(judged, skipped)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
