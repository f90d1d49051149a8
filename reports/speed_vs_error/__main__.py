"""``python -m reports.speed_vs_error [--peers] [-o DIR]``: speed against error on the shipped scenes."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.scenes import SHIPPED
from reports.speed_vs_error.peers import peers
from reports.speed_vs_error.tables import peers_page, targets_table
from reports.speed_vs_error.targets import accuracy_targets, speed_targets
from tethertest.bench.case import load_cases
from tethertest.bench.files import speed_files
from tethertest.bench.speed import measure_cases
from tethertest.bench.tables import speed_page
from tethertest.render.write import write_files

#: scene files that are measured
_SCENES = (
    "taut-vertical-jump",
    "straight-free-shape",
    "paper-1.1-f018-ramp",
    "paper-1.1-f025",
    "inclined-ends-wind",
    "rig-3m-hover",
    "snap-150m",
)


def main(arguments: list[str]) -> None:
    """Measure the shipped scenes, print the page, and write it where asked.

    It shows what is missed and refuses nothing: half of the targets are the clock's, and the tests hold the
    others.
    """
    parser = argparse.ArgumentParser(prog="python -m reports.speed_vs_error", description=__doc__)
    parser.add_argument("scenes", nargs="*", default=_SCENES, help="of rigs/scenes, without .toml [seven]")
    parser.add_argument("--peers", action="store_true", help="also run three scenes by MoorDyn")
    parser.add_argument("-o", "--output", type=Path, help="folder for the files")
    asked = parser.parse_args(arguments)
    command = f"python -m reports.speed_vs_error{' --peers' if asked.peers else ''}"
    scenes = measure_cases(load_cases([SHIPPED / f"{name}.toml" for name in asked.scenes]))
    targets = (*accuracy_targets(), *speed_targets())
    compared = peers() if asked.peers else ()
    more = ("## Targets", targets_table(targets))
    sys.stdout.write(speed_page(scenes, command, more))
    if asked.output is not None:
        files = speed_files(scenes, command, page=more, more={"targets": targets, "peers": compared})
        if compared:
            files["moordyn.md"] = peers_page(compared, command).encode()
        write_files(asked.output, files)


if __name__ == "__main__":
    main(sys.argv[1:])
