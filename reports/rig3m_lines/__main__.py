"""``python -m reports.rig3m_lines [RUN...] [-o DIR]``: the tables; exit 1 where a demand is not met.

The truth stands in truth.json beside each run; the package itself never opens it.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from reports.rig3m_lines.arrivals import ArrivalCheck
from reports.rig3m_lines.findings import TENSIONS, Complaints, table
from reports.rig3m_lines.lines import LineCheck
from reports.rig3m_lines.slack import SlackCheck
from reports.rig3m_lines.snaps import SnapCheck
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.analyze import analyze
from tethertest.render.write import write_files

CAMPAIGN = Path(__file__).parents[2] / "datasets" / "rig3m"


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
            "Written by `python -m reports.rig3m_lines`. Amplitudes in N "
            "and m; the 95 % interval holds noise and the channel's stated scale uncertainty. Rows that the "
            "analysis itself does not stand by (undetermined, not resolvable) do not count for coverage.",
            "## Verdicts\n\n" + table("run|channel|1|2|3|orders p/q that are not none", self.lines.verdicts),
            *(check.text() for check in (self.slack, self.snaps, self.arrivals, self.lines)),
        ]
        demands = "\n".join(f"- {text}" for text in self.complaints.texts) or "All met."
        return "\n\n".join([*parts, "## Demands\n\n" + demands])


def main(arguments: list[str]) -> int:
    """Check all runs, or those named, print the tables, write them where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.rig3m_lines", description=__doc__)
    parser.add_argument("runs", nargs="*", type=Path, help="run folders [all of datasets/rig3m]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    check = Check()
    for folder in asked.runs or sorted(CAMPAIGN.glob("run*")):
        check.add(folder)
    page = check.report() + "\n"
    sys.stdout.write(page)
    if asked.output is not None:
        write_files(asked.output, {"README.md": page.encode()})
    return 1 if check.complaints.texts else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
