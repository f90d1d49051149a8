"""``python -m reports.wave_energy [-o DIR]``: the article's standing and travelling waves."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.wave_energy.answer import answers
from reports.wave_energy.files import study_files
from reports.wave_energy.sweep import run_sweep
from tethertest.render.write import write_files


def main(arguments: list[str]) -> None:
    """Run the sweep, print the answers and write the report where asked."""
    parser = argparse.ArgumentParser(prog="python -m reports.wave_energy", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for the report")
    settings = parser.parse_args(arguments)
    sweep = run_sweep()
    sys.stdout.write("\n\n".join(answers(sweep)) + "\n")
    if settings.output is not None:
        write_files(settings.output, study_files(sweep))


if __name__ == "__main__":
    main(sys.argv[1:])
