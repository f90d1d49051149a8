"""Read damaged logs with every reader and write a table of what became of them.

``python tests/fuzz/table.py -o FILE [--mutants N] [--first K] [--reader NAME]``
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import warnings
from pathlib import Path

import fuzz_judge
import fuzz_seeds

from tethertest.readers.containers import rehearsal

WHAT = """\
`python tests/fuzz/table.py --mutants {count} -o FILE`: a small log of each reader, damaged at random in its
bytes, lines, fields and numbers, and read. It is refused with a message, or read; a failure is any other
error, values under another name or lost from rows left alone, times that are none, and rows, steps or columns
that the file's own header contradicts. What takes 3 s hung the library that reads it in a process of its own,
and was refused. `make verify` runs the same."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--mutants", type=int, default=500)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--reader")
    asked = parser.parse_args()
    warnings.simplefilter("error")
    rehearsal._PATIENCE = 3.0  # the logs here have some kilobytes
    lines = [
        "# Damaged logs",
        "",
        WHAT.format(count=asked.mutants),
        "",
        "| reader | mutants | refused | read | failures | slowest [ms] |",
        "|---|---|---|---|---|---|",
    ]
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        for reader, seeds in fuzz_seeds.seeds().items():
            if asked.reader in {None, reader}:
                numbers = range(asked.first, asked.first + asked.mutants)
                tally = fuzz_judge.run(seeds, numbers, Path(folder) / "log.txt")
                failures += tally.failures
                lines.append(
                    f"| {reader} | {tally.mutants} | {tally.refused} | {tally.read} | {len(tally.failures)} "
                    f"| {tally.slowest * 1e3:.0f} |"
                )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    lines += [
        "",
        f"Peak memory of the process: {peak:.0f} MB.",
        "",
        *(f"- {failure}" for failure in failures),
    ]
    asked.output.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
