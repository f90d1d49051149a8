"""``python -m reports.stability [STEPS] [-o DIR]``: the table; exit 1 where a check is missed."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from reports.stability.battery import LONG, Check, battery
from tethertest.bench.tables import markdown_table
from tethertest.render.write import write_files


def stability_page(checks: Sequence[Check], command: str) -> str:
    """Return the page in Markdown."""
    rows = [(check.name, check.asked, check.found, "met" if check.met else "missed") for check in checks]
    table = markdown_table(("run", "asked", "found", "verdict"), rows)
    return f"# Stability battery\n\nWritten by `{command}`.\n\n{table}\n"


def main(arguments: list[str]) -> int:
    """Run the battery, print its table, write it where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.stability", description=__doc__)
    parser.add_argument("steps", nargs="?", type=int, default=LONG, help=f"of the long runs [{LONG}]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    checks = battery(asked.steps)
    page = stability_page(checks, "python -m reports.stability")
    sys.stdout.write(page)
    if asked.output is not None:
        write_files(asked.output, {"README.md": page.encode()})
    return 0 if all(check.met for check in checks) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
