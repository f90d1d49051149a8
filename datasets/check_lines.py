#!/usr/bin/env python3
"""Hold what `tethertest analyze` says about the synthetic campaign's lines and events against its truth.

Prints the tables and leaves with exit code 1 if a demand is not met. The truth stands in truth.json beside
each run; the package itself never opens it.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from checks.arrivals import ArrivalCheck
from checks.findings import TENSIONS, Complaints, table
from checks.lines import LineCheck
from checks.slack import SlackCheck
from checks.snaps import SnapCheck

from tethertest.pipeline.analysis_options import Options
from tethertest.pipeline.analyze import analyze

HERE = Path(__file__).parent


class Check:
    """All that the runs showed."""

    def __init__(self) -> None:
        self.complaints = Complaints()
        self.lines = LineCheck(self.complaints)
        self.slack = SlackCheck(self.complaints)
        self.snaps = SnapCheck(self.complaints)
        self.arrivals = ArrivalCheck(self.complaints)

    def add(self, folder: Path) -> None:
        """Analyse one run and hold it against its truth."""
        truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
        analysis = analyze(folder, Options())
        self.lines.add(folder.name, analysis, truth)
        self.arrivals.add(folder.name, analysis.waves, truth)
        for name in TENSIONS:
            item = analysis.find(name)
            if item is not None:
                self.slack.add(folder.name, item, truth)
                self.snaps.add(folder.name, item, truth)

    def report(self) -> str:
        """Return the tables."""
        parts = [
            "# Lines and events of the synthetic campaign against its truth\n\n"
            "Written by `python datasets/check_lines.py --output reports/rig3m-lines.md`. Amplitudes in N "
            "and m; the 95 % interval holds noise and the channel's stated scale uncertainty. Rows that the "
            "analysis itself does not stand by (undetermined, not resolvable) do not count for coverage.",
            "## Verdicts\n\n" + table("run|channel|1|2|3|orders p/q that are not none", self.lines.verdicts),
            *(check.text() for check in (self.slack, self.snaps, self.arrivals, self.lines)),
        ]
        demands = "\n".join(f"- {text}" for text in self.complaints.texts) or "All met."
        return "\n\n".join([*parts, "## Demands\n\n" + demands])


def main() -> int:
    """Check all runs, or those named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="*", help="run folders [all of datasets/rig3m]")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    settings = parser.parse_args()
    check = Check()
    for folder in [Path(run) for run in settings.runs] or sorted((HERE / "rig3m").glob("run*")):
        check.add(folder)
    text = check.report()
    sys.stdout.write(text + "\n")
    if settings.output:
        settings.output.write_text(text + "\n", encoding="utf-8")
    return int(bool(check.complaints.texts))


if __name__ == "__main__":
    raise SystemExit(main())
