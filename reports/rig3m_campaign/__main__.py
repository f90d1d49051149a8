"""``python -m reports.rig3m_campaign [RUN...] [-o DIR]``: the tables; exit 1 where a demand is not met."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.rig3m_campaign.check import ORDERS, PEAK_MEAN, Check, check_run
from tethertest.bench.tables import markdown_table
from tethertest.render.write import write_files

CAMPAIGN = Path(__file__).parents[2] / "datasets" / "rig3m"


def main(arguments: list[str]) -> int:
    """Check all runs, or those named, print the tables, write them where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.rig3m_campaign", description=__doc__)
    parser.add_argument("runs", nargs="*", type=Path, help="run folders [all of datasets/rig3m]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    checks = [check_run(folder) for folder in asked.runs or sorted(CAMPAIGN.glob("run*"))]
    text = page(checks)
    sys.stdout.write(text)
    if asked.output is not None:
        write_files(asked.output, {"README.md": text.encode()})
    return 1 if any(check.complaints for check in checks) else 0


def page(checks: list[Check]) -> str:
    """Return the page in Markdown."""
    for check in checks:
        check.row["title"] = check.title
        check.row["verdict"] = check.verdict
        check.row["exit"] = str(check.exit_code)
        check.row["flaws"] = ", ".join(sorted(set(check.flaws))) or "none"
        check.row["demands"] = "; ".join(check.complaints) or "met"
    parts = [
        "# The synthetic campaign against its truth",
        "Written by `python -m reports.rig3m_campaign`. Pairs are recovered / true; clocks are error ± "
        "stated 95 % interval.",
        table(checks, ["title", "exit", "verdict", "reason"]),
        "Top tension by order of the drive [N]",
        table(checks, list(ORDERS)),
        table(checks, ["interrogator", "encoder"]),
        "Slack at the bottom cell: time in both over time in either (intervals found / true); peaks of the "
        f"{PEAK_MEAN * 1e3:.0f} ms mean in the steady window [N]",
        table(checks, ["slack", "peak tension_top", "peak tension_bottom"]),
        table(checks, ["flaws", "findings", "demands"]),
    ]
    return "\n\n".join(parts) + "\n"


def table(checks: list[Check], columns: list[str]) -> str:
    """Return what runs say in these columns."""
    rows = ([check.name, *(check.row.get(column, "-") for column in columns)] for check in checks)
    return markdown_table(("run", *columns), rows)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
