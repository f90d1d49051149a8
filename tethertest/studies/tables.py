"""What the studies found as Markdown, CSV and JSON."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

from tethertest.studies.peers import PeerScene
from tethertest.studies.speed import Entry, SceneSpeed
from tethertest.studies.stability import Check
from tethertest.studies.targets import Target


def speed_page(scenes: Sequence[SceneSpeed], targets: Sequence[Target], command: str) -> str:
    """Return the page of speed against error.

    Parameters
    ----------
    scenes : sequence of SceneSpeed
    targets : sequence of Target
        None are listed if it is empty.
    command : str
        What made it.
    """
    parts = [
        "# Speed against error",
        f"Written by `{command}`. Wall times are medians of 5 runs after a warm-up (3 from 0.5 s on, 1 "
        "from 2.5 s on) of a shared 2-core machine: use ratios. The error is the largest gauge's RMS "
        "difference from the reference over the RMS of the largest dynamic part; peaks are those of all "
        "gauges, relative to the reference's. A reference is a closed form or another discretisation; its "
        "own error is its distance from the next coarser one of its kind; no error below it is resolved.",
        "![Error against wall time](speed.png)",
        "## What the solver chooses",
        _chosen_table(scenes),
        _remarks(scenes),
    ]
    if targets:
        parts += ["## Targets", targets_table(targets)]
    parts.append("## Every model and mesh")
    for scene in scenes:
        own = "" if scene.reference_error is None else f", own error {scene.reference_error:.1e}"
        parts += [
            f"### {scene.scene}",
            f"{scene.title}. Reference: {scene.reference} ({scene.reference_kind}{own}).",
            _entries_table((scene.chosen.run, *scene.entries)),
        ]
    return "\n\n".join(part for part in parts if part) + "\n"


def targets_table(targets: Iterable[Target]) -> str:
    """Return targets as a Markdown table."""
    rows = [
        (t.name, t.asked, t.found, "met" if t.met else "missed", "clock" if t.timed else "value")
        for t in targets
    ]
    return _table(("target", "asked", "found", "verdict", "by"), rows)


def stability_page(checks: Sequence[Check], command: str) -> str:
    """Return the page of the stability battery."""
    rows = [(check.name, check.asked, check.found, "met" if check.met else "missed") for check in checks]
    table = _table(("run", "asked", "found", "verdict"), rows)
    return f"# Stability battery\n\nWritten by `{command}`.\n\n{table}\n"


def peers_page(scenes: Sequence[PeerScene], command: str) -> str:
    """Return the page of the comparison with MoorDyn."""
    parts = [
        "# Against MoorDyn",
        f"Written by `{command}`, both codes in the same run. MoorDyn runs with rk4 at Courant number 0.61 "
        "(less where its damping asks for it) from the same discrete equilibrium; its time is that of its "
        "step loop alone, ours includes the rest state. MoorDyn's end tension belongs to the middle of its "
        "end segment. That offset is removed by the momentum balance of the half segment, "
        "F(0) = F_1/2 - (m h/2)(a - g) and F(L) = F_n-1/2 - (m h/2) g, from the positions and velocities of "
        "its end nodes. The last table of a scene divides MoorDyn's time by that of our cheapest run that is "
        "at least as accurate.",
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
            _table(("code", "cells", "wall ms", "error"), rows),
            _table(("MoorDyn segments", "time at equal error, ratio", "our run"), ratios),
        ]
    return "\n\n".join(parts) + "\n"


def speed_csv(scenes: Sequence[SceneSpeed]) -> str:
    """Return every run as one row of CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(
        ("scene", "reference", "model", "cells", "wall_s", "error", "peak_error", "mean_peak_error")
    )
    for scene in scenes:
        for run in (scene.chosen.run, *scene.entries):
            numbers = (run.wall, run.error, run.peak, run.mean_peak)
            written = ("" if number is None else f"{number:.6g}" for number in numbers)
            writer.writerow((scene.scene, scene.reference, run.curve, run.cells, *written))
    return stream.getvalue()


def as_json(content: dict[str, Sequence[Any]]) -> str:
    """Return named lists of results as one JSON object."""
    plain = {name: [asdict(result) for result in results] for name, results in content.items()}
    return json.dumps(plain, ensure_ascii=False, allow_nan=False)


def _chosen_table(scenes: Sequence[SceneSpeed]) -> str:
    headings = (
        "scene", "model", "cells", "wall ms", "stated: numerical", "model form", "spread", "status", "error",
        "peak", "20 ms peak", "reference",
    )  # fmt: skip
    rows = []
    for scene in scenes:
        chosen, run = scene.chosen, scene.chosen.run
        stated = (_small(chosen.numerical), _small(chosen.model), _small(chosen.spread))
        rows.append(
            (scene.scene, f"{chosen.fidelity}: {chosen.scheme}", str(run.cells), f"{run.wall * 1e3:.1f}",
             *stated, chosen.status, _small(run.error), _share(run.peak), _share(run.mean_peak),
             scene.reference)
        )  # fmt: skip
    return _table(headings, rows)


def _entries_table(entries: Iterable[Entry]) -> str:
    rows = [
        (
            run.curve,
            str(run.cells) if run.cells else "-",
            f"{run.wall * 1e3:.2f}",
            _small(run.error),
            _share(run.peak),
            _share(run.mean_peak),
        )
        for run in entries
    ]
    return _table(("model", "cells", "wall ms", "error", "peak", "20 ms peak"), rows)


def _remarks(scenes: Sequence[SceneSpeed]) -> str:
    lines = [f"- {scene.scene}: {scene.remark}." for scene in scenes if scene.remark]
    lines += [
        f"- {scene.scene}: the reference is the same scheme on a finer mesh; no other discretisation here "
        "knows this scene."
        for scene in scenes
        if scene.reference_kind == "same scheme"
    ]
    lines += [
        f"- {scene.scene}: the reference and its next coarser one lie {scene.reference_error:.0%} apart in "
        "RMS, so the pointwise error says little; compare the peaks."
        for scene in scenes
        if scene.reference_error is not None and scene.reference_error > 0.05
    ]
    return "\n".join(lines)


def _table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _small(number: float | None) -> str:
    return "-" if number is None else f"{number:.2g}"


def _share(number: float | None) -> str:
    if number is None:
        return "-"
    return f"{number:+.2%}" if abs(number) < 10.0 else f"{number:.1e}"
