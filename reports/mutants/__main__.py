"""``python -m reports.mutants``: how many faults put into the package the tests notice."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from reports.mutants.hand_made import hand_made
from reports.mutants.sites import sample, unchanged
from reports.mutants.table import table
from reports.mutants.trial import SURVIVED, preload, try_all

ROOT: Final = Path(__file__).parents[2]
#: package -> tests that state its facts
TESTS: Final = {
    "compare": ["tests/unit/compare"],
    "similitude": ["tests/unit/similitude"],
    "spectra": ["tests/unit/spectra", "tests/unit/signal"],
    "store": ["tests/store"],
    "conditioning": ["tests/unit/conditioning"],
    "signal": ["tests/unit/signal", "tests/unit/spectra", "tests/unit/conditioning"],
}
#: of `make mutants`
PACKAGES: Final = ("compare", "conditioning", "similitude", "spectra", "store")


def main(arguments: Sequence[str]) -> int:
    """Try the mutants, print the table and write it where asked."""
    parser = argparse.ArgumentParser(prog="python -m reports.mutants", description=__doc__)
    parser.add_argument("--packages", nargs="+", choices=sorted(TESTS), help="those sampled where absent")
    parser.add_argument("--count", type=int, default=40, help="mutants of each package")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=300.0, help="time for the tests of one mutant [s]")
    parser.add_argument("--hand-made", action="store_true", help="those of hand_made.toml, and no sample")
    parser.add_argument("-o", "--output", type=Path, help="folder for the table")
    given = parser.parse_args(arguments)
    os.chdir(ROOT)
    packages = tuple(given.packages or (sorted(TESTS) if given.hand_made else PACKAGES))
    if given.hand_made:
        mutants, gone = hand_made(ROOT, packages)
        print("".join(f"gone from the code: {item}\n" for item in gone), end="", file=sys.stderr)
        title, how = "Mutants by hand", "The list of hand_made.toml."
        command, name = "python -m reports.mutants --hand-made", "hand-made.md"
    else:
        mutants = [item for package in packages for item in sample(ROOT, package, given.count, given.seed)]
        title, how = "Sampled mutants", f"{given.count} places of each package, drawn with seed {given.seed}."
        command, name = f"python -m reports.mutants --count {given.count} --seed {given.seed}", "sampled.md"
    preload()
    for item in try_all([unchanged(ROOT, name) for name in packages], TESTS, given.jobs, given.limit):
        if item.killer != SURVIVED:
            print(f"{item.mutant.package}: without any fault, {item.killer}", file=sys.stderr)
            return 1
    outcomes = []
    for item in try_all(mutants, TESTS, given.jobs, given.limit):
        outcomes.append(item)
        said = item.killer or "SURVIVED"
        place = f"{item.mutant.path}:{item.mutant.line}"
        print(f"{len(outcomes)}/{len(mutants)} {item.seconds:.0f} s {place}: {said}", flush=True)
        if item.killer == SURVIVED:
            print(f"    {item.mutant.before}\n    {item.mutant.after}", flush=True)
    outcomes.sort(key=lambda item: (item.mutant.package, item.mutant.path, item.mutant.line))
    page = table(outcomes, title, how, command)
    print(page, end="")
    if given.output is not None:
        given.output.mkdir(parents=True, exist_ok=True)
        (given.output / name).write_text(page, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
