"""Replays with one uncertain rig parameter moved by its standard uncertainty."""

from __future__ import annotations

import re
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

from tethertest.records.channel import Channel
from tethertest.records.rig import Rig
from tethertest.records.run import Run
from tethertest.replay.channels import replayed_channels
from tethertest.replay.motion import BottomMotion
from tethertest.replay.scene import run_scene
from tethertest.solver import solve

#: one number of several, such as ``drag_area[1]``
_ITEM = re.compile(r"(\w+)\[(\d+)\]")
#: replays at a time; transforms and marches let each other run, and each holds a few dozen megabytes
_WORKERS = 2


@dataclass(frozen=True, slots=True, eq=False)
class Variation:
    """One parameter moved, and the channels that this replays to."""

    parameter: str  #: key of `Rig.uncertainty`
    standard_uncertainty: float  #: in SI
    channels: tuple[Channel, ...]


def variations(
    run: Run, motion: BottomMotion, measured: Sequence[Channel], cells: int, fidelity: str
) -> tuple[Variation, ...]:
    """Replay the run once for each uncertain parameter of cable and platform.

    The first entry moves nothing: it is the nominal replay on the same mesh, which the others are held
    against, and on a mesh coarser than the run's own it tells the mesh's share of the error.

    Parameters
    ----------
    run : Run
        Its rig's `uncertainty` says what is uncertain.
    motion : BottomMotion
        Measured bottom displacement.
    measured : sequence of Channel
        Give places and times.
    cells : int
        Mesh of all of them.
    fidelity : str
        "linear" or "nonlinear", as the run's own replay.
    """
    names = [name for name in run.rig.uncertainty if _belongs(name, run.file.platform.mode)]

    def replayed(rig: Rig) -> tuple[Channel, ...]:
        return _replay(run, rig, motion, measured, cells, fidelity)

    nominal = Variation("nominal", 0.0, replayed(run.rig))  # first and alone: the others share what it loads
    with ThreadPoolExecutor(_WORKERS) as workers:
        found = workers.map(lambda name: replayed(moved(run.rig, name)), names)
        others = [
            Variation(name, run.rig.uncertainty[name], channels)
            for name, channels in zip(names, found, strict=True)
        ]
    return (nominal, *others)


def moved(rig: Rig, name: str) -> Rig:
    """Return the rig with one parameter moved up by its standard uncertainty.

    Parameters
    ----------
    rig : Rig
        Its `uncertainty` has the parameter.
    name : str
        "cable.length", "platform.mass" or "platform.modes.hold.hover_stiffness".
    """
    step = rig.uncertainty[name]
    table, _, key = name.partition(".")
    if table == "cable":
        return replace(rig, cable=_added(rig.cable, key, step))
    if not key.startswith("modes."):
        return replace(rig, platform=_added(rig.platform, key, step))
    mode, _, field = key.removeprefix("modes.").rpartition(".")
    modes = {**rig.platform.modes, mode: _added(rig.platform.modes[mode], field, step)}
    return replace(rig, platform=replace(rig.platform, modes=modes))


def _added(record: Any, field: str, step: float) -> Any:
    item = _ITEM.fullmatch(field)
    if item is None:
        return replace(record, **{field: getattr(record, field) + step})
    values = list(getattr(record, item[1]))
    values[int(item[2]) - 1] += step
    return replace(record, **{item[1]: tuple(values)})


def _belongs(name: str, mode: str) -> bool:
    if name.startswith("platform.modes."):
        return name.startswith(f"platform.modes.{mode}.")
    return name.startswith(("cable.", "platform."))


def _replay(
    run: Run, rig: Rig, motion: BottomMotion, measured: Sequence[Channel], cells: int, fidelity: str
) -> tuple[Channel, ...]:
    scene = run_scene(run, motion.duration, rig=rig)
    response = solve(
        scene,
        measured=motion.motion,
        fidelity="nonlinear" if fidelity == "nonlinear" else "linear",
        cells=cells,
        with_field=False,
    )
    return replayed_channels(response, motion, measured)
