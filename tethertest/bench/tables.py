"""What the bench found as Markdown, CSV and JSON."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from tethertest.bench.speed import Entry, SceneSpeed

#: how the peer is run, for the pages on which it stands
HOW_MOORDYN_RUNS = (
    "MoorDyn runs with rk4 at Courant number 0.61 (less where its damping asks for it) from the same "
    "discrete equilibrium; its time is that of its step loop alone, ours includes the rest state. MoorDyn's "
    "end tension belongs to the middle of its end segment. That offset is removed by the momentum balance "
    "of the half segment, F(0) = F_1/2 - (m h/2)(a - g) and F(L) = F_n-1/2 - (m h/2) g, from the positions "
    "and velocities of its end nodes."
)


def speed_page(scenes: Sequence[SceneSpeed], command: str, more: Sequence[str] = ()) -> str:
    """Return the page of speed against error.

    Parameters
    ----------
    scenes : sequence of SceneSpeed
    command : str
        What made it.
    more : sequence of str
        Paragraphs that stand before the tables of single scenes.
    """
    parts = [
        "# Speed against error",
        f"Written by `{command}`. Wall times are medians of 5 runs after a warm-up (3 from 0.5 s on, 1 "
        "from 2.5 s on); use ratios where the machine is shared. The error is the largest gauge's RMS "
        "difference from the reference over the RMS of the largest dynamic part; peaks are those of all "
        "gauges, relative to the reference's. A reference is a closed form or another discretisation; its "
        "own error is its distance from the next coarser one of its kind; no error below it is resolved.",
        "![Error against wall time](speed.png)",
        "## What the solver chooses",
        _chosen_table(scenes),
        _remarks(scenes),
        f"{HOW_MOORDYN_RUNS} It is compared at the gauges of the ends alone." if _has_peers(scenes) else "",
        *more,
        "## Every model and mesh",
    ]
    for scene in scenes:
        own = "" if scene.reference_error is None else f", own error {scene.reference_error:.1e}"
        parts += [
            f"### {scene.scene}",
            f"{scene.title}. Reference: {scene.reference} ({scene.reference_kind}{own}).",
            _entries_table((scene.chosen.run, *scene.entries)),
        ]
    return "\n\n".join(part for part in parts if part) + "\n"


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


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _has_peers(scenes: Sequence[SceneSpeed]) -> bool:
    return any(run.curve == "MoorDyn" for scene in scenes for run in scene.entries)


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
    return markdown_table(headings, rows)


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
    return markdown_table(("model", "cells", "wall ms", "error", "peak", "20 ms peak"), rows)


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


def _small(number: float | None) -> str:
    return "-" if number is None else f"{number:.2g}"


def _share(number: float | None) -> str:
    if number is None:
        return "-"
    return f"{number:+.2%}" if abs(number) < 10.0 else f"{number:.1e}"
