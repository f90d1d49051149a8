"""``python -m tethertest.studies.line_calibration N [-o DIR]``: tables and figure; exit 1 if one misses."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tethertest.render.write import write_files
from tethertest.studies.line_calibration.files import calibration_files
from tethertest.studies.line_calibration.kinds import KINDS
from tethertest.studies.line_calibration.power import AMPLITUDES, NOISES, coverage, found_at
from tethertest.studies.line_calibration.rates import rates
from tethertest.studies.line_calibration.table import calibration_table, coverage_met, found_met


def main(arguments: list[str]) -> int:
    """Analyse the records, print the tables, write them where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="line_calibration", description=__doc__)
    parser.add_argument("records", type=int, help="records of each kind")
    parser.add_argument("-o", "--output", type=Path, help="folder for the files")
    settings = parser.parse_args(arguments)
    nulls = [rates(kind, settings.records) for kind in KINDS]
    found = [found_at(amplitude, settings.records) for amplitude in AMPLITUDES]
    covered = [coverage(name, noise, allowed, settings.records) for name, noise, allowed in NOISES]
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
