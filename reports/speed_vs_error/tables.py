"""Targets and the comparison with MoorDyn as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from reports.speed_vs_error.peers import PeerScene
from reports.speed_vs_error.targets import Target
from tethertest.bench.tables import HOW_MOORDYN_RUNS, markdown_table


def targets_table(targets: Iterable[Target]) -> str:
    """Return targets as a Markdown table."""
    rows = [
        (t.name, t.asked, t.found, "met" if t.met else "missed", "clock" if t.timed else "value")
        for t in targets
    ]
    return markdown_table(("target", "asked", "found", "verdict", "by"), rows)


def peers_page(scenes: Sequence[PeerScene], command: str) -> str:
    """Return the page of the comparison with MoorDyn."""
    parts = [
        "# Against MoorDyn",
        f"Written by `{command}`, both codes in the same run. {HOW_MOORDYN_RUNS} The last table of a scene "
        "divides MoorDyn's time by that of our cheapest run that is at least as accurate.",
    ]
    for scene in scenes:
        rows = [
            (
                run.code,
                str(run.cells),
                f"{run.wall * 1e3:.2f}",
                f"{run.error:.2e}" + ("" if run.apart is None else f" ({run.apart:.1e})"),
            )
            for run in scene.runs
        ]
        ratios = [
            (str(cells), f"{ratio:.0f}", f"{code}, {ours}") for cells, ratio, code, ours in scene.ratios()
        ]
        parts += [
            f"## {scene.scene}",
            f"Reference: {scene.reference}.",
            markdown_table(("code", "cells", "wall ms", "error"), rows),
            markdown_table(("MoorDyn segments", "time at equal error, ratio", "our run"), ratios),
        ]
    return "\n\n".join(parts) + "\n"
