"""``python -m reports.crash_safety [INSTANTS] [-o DIR]``: the table; exit 1 where anything was at fault."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.crash_safety.battery import LIMITS, SEED, Tally, run_battery
from tethertest.render.write import write_files

#: faults that the table names
_FAULTS_SHOWN = 10


def main(arguments: list[str]) -> int:
    """Run the battery, print its table, write it where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.crash_safety", description=__doc__)
    parser.add_argument("instants", nargs="?", type=int, default=200, help="of a kill [200]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    parser.add_argument("--run", type=Path, default=Path("datasets/rig3m/run05"))
    parser.add_argument("--rigs", type=Path, default=Path("rigs"))
    asked = parser.parse_args(arguments)
    tally = run_battery(asked.run, asked.rigs.resolve(), asked.instants, LIMITS)
    text = table(tally, asked.run.name)
    sys.stdout.write(text)
    if asked.output is not None:
        write_files(asked.output, {"README.md": text.encode()})
    return 1 if tally.faults else 0


def table(tally: Tally, run: str) -> str:
    """Return the tally as Markdown."""
    columns = ("old", "new", "neither", "left-over", "plain message")
    phases = dict.fromkeys(phase for phase, _ in tally.outcomes)
    lines = [
        "# Crash safety of the run store",
        "",
        f"`python -m reports.crash_safety`, run {run}, seed {SEED}. An ingest writes in "
        f"{tally.steps} steps. *Left-over*: temporary files at that instant; after a kill the next ingest "
        "takes them away.",
        "",
        f"| ended by | times | {' | '.join(columns)} |",
        f"|{'---|' * (len(columns) + 2)}",
    ]
    for phase in phases:
        counts = [tally.outcomes[phase, column] for column in columns]
        lines.append(f"| {phase} | {sum(counts[:3])} | {' | '.join(map(str, counts))} |")
    faults = tally.faults[:_FAULTS_SHOWN] or ["none"]
    return "\n".join([*lines, "", "Faults: " + "; ".join(faults), ""])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
