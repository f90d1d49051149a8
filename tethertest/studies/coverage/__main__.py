"""``python -m tethertest.studies.coverage [SCENES [FILE]]``: the table; exit 1 where a demand is missed."""

from __future__ import annotations

import sys
from pathlib import Path

from tethertest.studies.coverage.coverage import Judged, Skipped, judge_until
from tethertest.studies.coverage.table import coverage_table, demands

#: scenes that are judged unless told otherwise
_SCENES = 300


def main(arguments: list[str]) -> int:
    """Judge the scenes, print the table, write it to a file where one is named, and return the exit code."""
    verdicts = judge_until(int(arguments[0]) if arguments else _SCENES)
    judged = [verdict for verdict in verdicts if isinstance(verdict, Judged)]
    skipped = [verdict for verdict in verdicts if isinstance(verdict, Skipped)]
    table = coverage_table(judged, skipped)
    sys.stdout.write(table)
    if len(arguments) > 1:
        Path(arguments[1]).write_text(table, encoding="utf-8")
    return 0 if all(demand.met for demand in demands(judged, skipped)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
