"""The order of the bench: which studies run, and the files that say what they found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tethertest.studies.peers import PeerScene, peers
from tethertest.studies.scenes import Case, cases
from tethertest.studies.speed import MESHES, SceneSpeed, scene_speed, variants
from tethertest.studies.stability import Check, battery
from tethertest.studies.tables import as_json, peers_page, speed_csv, speed_page, stability_page
from tethertest.studies.targets import Target, accuracy_targets, speed_targets


@dataclass(frozen=True, slots=True)
class Bench:
    """What was measured."""

    scenes: tuple[SceneSpeed, ...]
    targets: tuple[Target, ...]
    peers: tuple[PeerScene, ...]
    checks: tuple[Check, ...]


def run_bench(
    paths: Sequence[Path] = (),
    *,
    with_peers: bool = False,
    with_stability: bool = False,
    meshes: tuple[int, ...] = MESHES,
) -> Bench:
    """Measure scenes; the targets as well where the shipped ones are measured.

    Parameters
    ----------
    paths : sequence of Path
        Scene files; the shipped ones if there are none.
    with_peers : bool
        Also run three scenes by MoorDyn.
    with_stability : bool
        Also run the stability battery.
    meshes : tuple of int
        Of the nonlinear model.

    Raises
    ------
    TethertestError
        A file is no scene, a scene has no rest, or MoorDyn is asked for and not installed.
    """
    found = [scene for case in cases(paths) for scene in _with_variants(case, meshes)]
    targets = () if paths else (*accuracy_targets(), *speed_targets())
    return Bench(tuple(found), targets, peers() if with_peers else (), battery() if with_stability else ())


def bench_files(bench: Bench, command: str, figure: bytes) -> dict[str, dict[str, bytes]]:
    """Return folder -> file name -> content.

    Parameters
    ----------
    bench : Bench
    command : str
        What made them.
    figure : bytes
        The log-log figure as PNG.
    """
    speed = {
        "README.md": speed_page(bench.scenes, bench.targets, command).encode(),
        "speed.csv": speed_csv(bench.scenes).encode(),
        "speed.json": (bench_json(bench) + "\n").encode(),
        "speed.png": figure,
    }
    if bench.peers:
        speed["moordyn.md"] = peers_page(bench.peers, command).encode()
    files = {"speed-vs-error": speed}
    if bench.checks:
        files["stability"] = {"README.md": stability_page(bench.checks, command).encode()}
    return files


def bench_json(bench: Bench) -> str:
    """Return all results as one JSON object."""
    return as_json(
        {"scenes": bench.scenes, "targets": bench.targets, "peers": bench.peers, "stability": bench.checks}
    )


def _with_variants(case: Case, meshes: tuple[int, ...]) -> Iterable[SceneSpeed]:
    measured = scene_speed(case, meshes=meshes)
    yield measured
    for variant, remark in variants(case, measured):
        yield scene_speed(variant, remark=remark, meshes=meshes)
