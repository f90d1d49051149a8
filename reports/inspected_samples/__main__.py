"""``python -m reports.inspected_samples FOLDER [-o DIR] [--set FILE KEY=VALUE]...``: its table."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.inspected_samples.page import BY_HAND, page
from tethertest.render.write import write_files


def main(arguments: list[str]) -> int:
    """Inspect a folder, print the page, and write it where asked; what is written by hand there is kept."""
    parser = argparse.ArgumentParser(prog="python -m reports.inspected_samples", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    parser.add_argument("--set", nargs=2, action="append", default=[], metavar=("FILE", "KEY=VALUE"))
    asked = parser.parse_args(arguments)
    by_hand = ""
    if asked.output is not None and (asked.output / "README.md").is_file():
        older = (asked.output / "README.md").read_text(encoding="utf-8")
        _, _, by_hand = older.partition(f"{BY_HAND}\n")
    text = page(asked.folder, [(file, word) for file, word in asked.set], by_hand)
    sys.stdout.write(text)
    if asked.output is not None:
        write_files(asked.output, {"README.md": text.encode()})
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
