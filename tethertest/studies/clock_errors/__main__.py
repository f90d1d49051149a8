"""``python -m tethertest.studies.clock_errors [RUNS] [-o FILE]``: the table; exit 1 where one is missed."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tethertest.studies.clock_errors.judge import judged
from tethertest.studies.clock_errors.table import clock_table, demands

#: runs that are judged unless told otherwise
_RUNS = 300


def main(arguments: list[str]) -> int:
    """Judge the first runs, print the table, write it where a file is named, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tethertest.studies.clock_errors")
    parser.add_argument("runs", type=int, nargs="?", default=_RUNS)
    parser.add_argument("-o", "--output", type=Path)
    chosen = parser.parse_args(arguments)
    runs = [judged(number) for number in range(chosen.runs)]
    table = clock_table(runs)
    sys.stdout.write(table)
    if chosen.output is not None:
        chosen.output.write_text(table, encoding="utf-8")
    return 0 if all(demand.met for demand in demands(runs)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
