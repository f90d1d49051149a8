"""``python -m reports.clock_errors [RUNS] [OFF] [-o DIR]``: the table; exit 1 where a demand is missed."""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from reports.clock_errors.judge import judged
from reports.clock_errors.rig import KNOWN_RIG, RIG
from reports.clock_errors.table import clock_table, demands
from tethertest.render.write import write_files

#: what is known of the rig in either part
_RIGS = {
    "The rig is as its file states": KNOWN_RIG,
    "The rig is off by as much as its file leaves open": RIG,
}


def main(arguments: list[str]) -> int:
    """Judge the first runs, print the table, write it where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.clock_errors", description=__doc__)
    parser.add_argument("runs", type=int, nargs="?", default=300, help="with the rig known for certain")
    parser.add_argument(
        "off", type=int, nargs="?", default=300, help="with a rig that its file does not tell"
    )
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    parser.add_argument("--jobs", type=int, default=1, help="processes; the table does not depend on them")
    chosen = parser.parse_args(arguments)
    counts = dict(zip(_RIGS, (chosen.runs, chosen.off), strict=True))
    with ProcessPoolExecutor(chosen.jobs) as pool:
        found = {
            heading: list(pool.map(partial(judged, rig=rig), range(counts[heading]), chunksize=5))
            for heading, rig in _RIGS.items()
            if counts[heading]
        }
    table = clock_table(found, f"python -m reports.clock_errors {chosen.runs} {chosen.off}")
    sys.stdout.write(table)
    if chosen.output is not None:
        write_files(chosen.output, {"README.md": table.encode()})
    return 0 if all(demand.met for runs in found.values() for demand in demands(runs)) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
