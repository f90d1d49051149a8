"""``python -m reports.line_calibration N [-o DIR]``: tables and figure; exit 1 if one misses."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from reports.line_calibration.files import calibration_files
from reports.line_calibration.kinds import KINDS
from reports.line_calibration.power import AMPLITUDES, NOISES, coverage, found_at
from reports.line_calibration.rates import Rates, rates
from reports.line_calibration.table import calibration_table, coverage_met, found_met
from tethertest.records.lines import LineVerdict
from tethertest.render.write import write_files


def _counts(number: int, records: int) -> tuple[int, int, int, int, Mapping[LineVerdict, int]]:
    """Return what became of the records of one kind; the kind itself does not pass between processes."""
    item = rates(KINDS[number], records)
    return item.records, item.false, item.quiet, item.undetermined, item.halves


def main(arguments: list[str]) -> int:
    """Analyse the records, print the tables, write them where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.line_calibration", description=__doc__)
    parser.add_argument("records", type=int, help="records of each kind")
    parser.add_argument("-o", "--output", type=Path, help="folder for the files")
    parser.add_argument("--jobs", type=int, default=1, help="processes; the tables do not depend on them")
    settings = parser.parse_args(arguments)
    with ProcessPoolExecutor(settings.jobs) as pool:
        count = settings.records
        counted = [pool.submit(_counts, number, count) for number in range(len(KINDS))]
        seen = [pool.submit(found_at, amplitude, count) for amplitude in AMPLITUDES]
        held = [pool.submit(coverage, *noise, count) for noise in NOISES]
        nulls = [Rates(kind, *item.result()) for kind, item in zip(KINDS, counted, strict=True)]
        found, covered = [item.result() for item in seen], [item.result() for item in held]
    table = calibration_table(nulls, found, covered)
    sys.stdout.write(table)
    if settings.output is not None:
        write_files(settings.output, calibration_files(table, found))
    met = [item.met for item in nulls]
    met += [found_met(item) for item in found]
    met += [coverage_met(item) for item in covered]
    return 0 if all(met) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
