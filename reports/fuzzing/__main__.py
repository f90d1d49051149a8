"""``python -m reports.fuzzing [--mutants N] [-o DIR]``: the table; exit 1 where a damaged log was misread."""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import warnings
from pathlib import Path
from unittest.mock import patch

from reports.fuzzing import judge
from reports.fuzzing.seeds import seeds
from tethertest.readers.guards import sandboxed_read
from tethertest.render.write import write_files

WHAT = """\
`python -m reports.fuzzing --mutants {count}`: a small log of each reader, damaged at random in its
bytes, lines, fields and numbers, and read. It is refused with a message, or read; a failure is any other
error, values under another name or lost from rows left alone, times that are none, and rows, steps or columns
that the file's own header contradicts. What takes 3 s hung the library that reads it in a process of its own,
and was refused. `make verify` runs the same."""
#: time that the process which reads first is given for a log of some kilobytes [s]
PATIENCE = 3.0


def main(arguments: list[str]) -> int:
    """Read damaged logs with every reader, print the table, write it where asked, return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.fuzzing", description=__doc__)
    parser.add_argument("--mutants", type=int, default=500, help="damaged logs of each reader [500]")
    parser.add_argument("--first", type=int, default=0, help="number of the first [0]")
    parser.add_argument("--reader", help="this one alone")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    numbers = range(asked.first, asked.first + asked.mutants)
    tallies = {}
    with tempfile.TemporaryDirectory() as folder, patch.object(sandboxed_read, "_PATIENCE", PATIENCE):
        warnings.simplefilter("error")
        for reader, sound in seeds().items():
            if asked.reader in {None, reader}:
                tallies[reader] = judge.run(sound, numbers, Path(folder) / "log.txt")
    page = table(tallies, asked.mutants)
    sys.stdout.write(page)
    if asked.output is not None:
        write_files(asked.output, {"README.md": page.encode()})
    return 1 if any(tally.failures for tally in tallies.values()) else 0


def table(tallies: dict[str, judge.Tally], count: int) -> str:
    """Return the page in Markdown."""
    lines = [
        "# Damaged logs",
        "",
        WHAT.format(count=count),
        "",
        "| reader | mutants | refused | read | failures | slowest [ms] |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {reader} | {tally.mutants} | {tally.refused} | {tally.read} | {len(tally.failures)} "
        f"| {tally.slowest * 1e3:.0f} |"
        for reader, tally in tallies.items()
    ]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    lines += ["", f"Peak memory of the process: {peak:.0f} MB.", ""]
    lines += [f"- {failure}" for tally in tallies.values() for failure in tally.failures]
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
