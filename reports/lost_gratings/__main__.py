"""``python -m reports.lost_gratings [RUNS] [-o DIR]``: the table; exit 1 where a value is wrong."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from reports.lost_gratings.cases import LAYOUTS, LENGTH, RATE, random_case
from reports.lost_gratings.judge import Outcome, judge
from tethertest.render.write import write_files


def main(arguments: list[str]) -> int:
    """Judge as many random logs as asked for, print the page, write it where asked, return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.lost_gratings", description=__doc__)
    parser.add_argument("runs", nargs="?", type=int, default=200, help="logs that are judged [200]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    outcomes = [judge(random_case(seed)) for seed in range(asked.runs)]
    page = table(outcomes)
    sys.stdout.write(page)
    if asked.output is not None:
        write_files(asked.output, {"README.md": page.encode()})
    return 1 if any(item.wrong or item.unflagged for item in outcomes) else 0


def table(outcomes: Sequence[Outcome]) -> str:
    """Return the page in Markdown."""
    groups = [("all runs", list(outcomes))]
    plain = [item for item in outcomes if item.case.clear and not item.case.ghosts]
    groups.append(("clear: every grating stays nearer to its own place than to a neighbour's", plain))
    groups.append(
        (
            "clear, with ghosts",
            [item for item in outcomes if item.case.clear and item.case.ghosts],
        )
    )
    crowded = [item for item in outcomes if not item.case.clear]
    groups.append(
        (
            "crowded: gratings move beyond half their distance",
            [i for i in crowded if not i.case.ghosts],
        )
    )
    groups.append(("crowded, with ghosts", [item for item in crowded if item.case.ghosts]))
    groups.append(("one grating dead from the first row", [item for item in outcomes if item.case.dead]))
    groups += [(layout, [item for item in outcomes if item.case.layout == layout]) for layout in LAYOUTS]
    rows = "\n".join(_row(name, group) for name, group in groups if group)
    return (
        "# Lost gratings\n\n"
        f"`python -m reports.lost_gratings {len(outcomes)}`: random interrogator logs of "
        f"{LENGTH:g} s at {RATE:g} Hz with 3 to 10 gratings, 1.5 to 6 nm apart, strained together by up to "
        "several nanometres with snaps, warmed by up to 5 K. Gratings are lost in single rows and in long "
        "stretches, several at once and all at once; some logs hold ghosts, peaks that belong to no grating; "
        "columns slip, cross or are numbered. Counts are samples. A value is wrong when it is another "
        "grating's; a peak is kept when its own grating has it.\n\n"
        "| runs | number | lost | visible | kept | least kept of a run | wrong | ghosts taken | unflagged |\n"
        "|---|---|---|---|---|---|---|---|---|\n"
        f"{rows}\n"
    )


def _row(name: str, group: Sequence[Outcome]) -> str:
    visible = sum(item.visible for item in group)
    kept = sum(item.kept for item in group)
    least = min(item.kept / max(item.visible, 1) for item in group)
    counts = [sum(getattr(item, key) for item in group) for key in ("wrong", "ghosts_taken", "unflagged")]
    return (
        f"| {name} | {len(group)} | {sum(item.lost for item in group)} | {visible} | "
        f"{kept / max(visible, 1):.3%} | {least:.2%} | {' | '.join(map(str, counts))} |"
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
