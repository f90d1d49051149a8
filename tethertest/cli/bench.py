"""``tethertest bench``: speed against error, and the stability battery."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from tethertest.render.figures.speed import SpeedPanel
    from tethertest.studies.speed import SceneSpeed


def bench(
    scenes: Annotated[
        list[Path] | None,
        typer.Argument(help="Scene files [seven of rigs/scenes, found upwards from the current directory]."),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder of speed-vs-error/ and stability/.")
    ] = Path("reports"),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object on standard output.")
    ] = False,
    peers: Annotated[
        bool, typer.Option("--peers", help="Also run three scenes by MoorDyn (extra `peers`).")
    ] = False,
    stability: Annotated[
        bool, typer.Option("--stability", help="Also run the stability battery, runs of a million steps.")
    ] = False,
) -> None:
    """Measure every model's speed against its error, by references of another kind.

    Without scenes also the stated targets. Minutes; the times are those of a machine that does nothing else.
    """
    from tethertest.render.figures.speed import speed_against_error
    from tethertest.render.write import write_files
    from tethertest.studies.bench import bench_files, bench_json, run_bench

    found = run_bench(scenes or (), with_peers=peers, with_stability=stability)
    words = ["tethertest bench", *(path.name for path in scenes or ())]
    words += [f"--{name}" for name, wanted in (("peers", peers), ("stability", stability)) if wanted]
    figure = speed_against_error([_panel(scene) for scene in found.scenes])
    for folder, files in bench_files(found, " ".join(words), figure.png).items():
        for path in write_files(output / folder, files):
            typer.echo(str(path), err=True)
    if as_json:
        typer.echo(bench_json(found))
        return
    for scene in found.scenes:
        chosen, run = scene.chosen, scene.chosen.run
        error = "no number" if run.error is None else f"{run.error:.2g}"
        typer.echo(
            f"{scene.scene}: {chosen.fidelity}, {run.cells} cells, {run.wall * 1e3:.1f} ms, error {error} "
            f"against {scene.reference}"
        )
    missed = [
        f"{target.name}: asked {target.asked}, found {target.found}"
        for target in found.targets
        if not target.met
    ]
    missed += [
        f"{check.name}: asked {check.asked}, found {check.found}" for check in found.checks if not check.met
    ]
    for line in missed:
        typer.echo(f"missed: {line}")


def _panel(scene: SceneSpeed) -> SpeedPanel:
    """Return a scene's runs as the figure takes them."""
    from tethertest.render.figures.speed import SpeedCurve, SpeedPanel

    curves: dict[str, list[tuple[float, float]]] = {}
    for run in (*scene.entries, scene.chosen.run):
        if run.error is not None:
            curves.setdefault(run.curve, []).append((run.wall, run.error))
    drawn = (
        SpeedCurve(name, tuple(wall for wall, _ in points), tuple(error for _, error in points))
        for name, points in curves.items()
    )
    return SpeedPanel(scene.scene, scene.reference_error, tuple(drawn))
