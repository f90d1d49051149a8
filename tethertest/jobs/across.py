"""Runs of a folder as curves: amplitude per order against one setting of the drive, jumps, hysteresis."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.conditioning.stated import STATED_FREQUENCY
from tethertest.errors import DataError
from tethertest.jobs.across_runs import members, run_parts
from tethertest.jobs.analysis_options import Options
from tethertest.records.across import (
    Across,
    Curve,
    CurvePoint,
    Direction,
    Group,
    Judgement,
    Loop,
    RunChannel,
    RunPart,
    StepVerdict,
    is_found,
)
from tethertest.records.arrays import FloatArray
from tethertest.spectra.curve_branches import branches, judge_loop, merged
from tethertest.spectra.curve_steps import judge_steps

#: chance of one false jump, and of one false hysteresis, in a folder, over all its curves
FALSE_JUMPS: Final = 0.01
AGAINST: Final = ("frequency", "amplitude")
#: settings that make a curve
_FEWEST_SETTINGS: Final = 2


def analyze_across(
    folder: Path,
    options: Options,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Across:
    """Analyse the runs of a folder together.

    Parameters
    ----------
    folder : Path
        Holds run folders or run stores, at any depth.
    options : Options
        As for one run; `replay` gives every curve a replayed one beside it.
    jobs : int, optional
        Processes; one per core if absent.
    progress : callable, optional
        Called with the runs done and the runs there are.

    Raises
    ------
    TethertestError
        There is no run, or not one of them can be analysed.
    """
    paths = members(folder)
    finished = 0

    def done() -> None:
        nonlocal finished
        finished += 1
        if progress is not None:
            progress(finished, len(paths))

    parts = run_parts(paths, options, os.cpu_count() or 1 if jobs is None else jobs, done)
    if all(part.refused for part in parts):
        reasons = "; ".join(dict.fromkeys(f"{part.run}: {part.refused}" for part in parts))
        message = f"not one of {len(parts)} runs can be analysed: {reasons}"
        raise DataError(message, "mend the runs, or the options", path=folder)
    return gathered(str(folder), parts)


def gathered(path: str, parts: Sequence[RunPart]) -> Across:
    """Return the curves of runs that are analysed, by the order of time."""
    groups = _groups(parts)
    by_name = {part.run: part for part in parts if not part.refused}
    bare = [curve for number, group in enumerate(groups) for curve in _curves(number, group, by_name)]
    curves = [_judged(curve, FALSE_JUMPS / len(bare)) for curve in bare]
    grouped = {run for group in groups for run in group.runs}
    lone = [part.run for part in parts if not part.refused and part.run not in grouped]
    notes = []
    if lone:
        notes.append(f"no other run differs from it in one setting only: {', '.join(lone)}")
    return Across(
        path, tuple(parts), groups, tuple(curves), _loops(groups, curves), FALSE_JUMPS, tuple(notes)
    )


def _groups(parts: Sequence[RunPart]) -> tuple[Group, ...]:
    """Return the runs that differ in one setting only, by that setting."""
    found = []
    for against in AGAINST:
        sets: dict[tuple[str, str, str], list[RunPart]] = {}
        for part in parts:
            other = _fixed(part, against)
            if not part.refused and _setting(part, against) is not None:
                # three digits: what was set to the same value, measured or stated
                key = (part.rig, part.mode, "" if other is None else f"{other:.3g}")
                sets.setdefault(key, []).append(part)
        for (rig, mode, _), chosen in sets.items():
            settings = np.array([_setting(part, against) for part in chosen], dtype=np.float64)
            if merged(settings, settings, settings)[0].size < _FEWEST_SETTINGS:
                continue
            split = branches(settings)
            names = tuple(part.run for part in chosen)
            swept = [b for b in split if b.direction is not Direction.UNORDERED]
            notes = []
            if any(chosen[member].from_rest for branch in swept for member in branch.members):
                notes.append(
                    "runs of its sweeps start from rest, and a cable at rest forgets the run before: what "
                    "differs between up and down then has another cause"
                )
            found.append(Group(against, rig, mode, _fixed(chosen[0], against), names, split, tuple(notes)))
    return tuple(found)


def _setting(part: RunPart, against: str) -> float | None:
    return part.frequency if against == "frequency" else part.amplitude


def _fixed(part: RunPart, against: str) -> float | None:
    if against == "frequency":
        return part.nominal_amplitude or part.amplitude
    stated, ran = part.nominal_frequency, part.frequency
    # a slip of the pen would put the run among others than those it was set with
    slip = stated is not None and ran is not None and abs(ran / stated - 1.0) > STATED_FREQUENCY
    return ran if slip else stated or ran


def _curves(number: int, group: Group, parts: dict[str, RunPart]) -> list[Curve]:
    """Return the curves of a group, not judged yet."""
    chosen = [parts[run] for run in group.runs]
    series: dict[tuple[str, str], list[RunChannel | None]] = {}
    for place, part in enumerate(chosen):
        for channel in part.channels:
            key = (channel.name, channel.side)
            series.setdefault(key, [None] * len(chosen))[place] = channel
    curves = []
    for channels in series.values():
        first = next(channel for channel in channels if channel is not None)
        for order in _orders(channels):
            for branch in group.branches:
                points = [
                    point
                    for member in branch.members
                    if (point := _point(chosen[member], channels[member], order, group.against)) is not None
                ]
                if points:
                    curves.append(
                        Curve(
                            number,
                            first.name,
                            first.kind,
                            first.unit,
                            first.side,
                            order,
                            branch.direction,
                            tuple(points),
                            Judgement((), 0.0, 0.0),
                        )
                    )
    return curves


def _orders(channels: Sequence[RunChannel | None]) -> list[str]:
    """Return the orders that one of the runs shows, by frequency."""
    orders = {line.order for channel in channels if channel is not None for line in channel.found}
    return sorted(orders, key=order_value)


def order_value(order: str) -> float:
    """Return an order as a number."""
    above, _, below = order.partition("/")
    return float(above) / float(below or 1)


def _point(part: RunPart, channel: RunChannel | None, order: str, against: str) -> CurvePoint | None:
    line = None if channel is None or channel.lines is None else channel.lines.line(order)
    setting = _setting(part, against)
    if channel is None or line is None or setting is None:
        return None
    return CurvePoint(
        part.run,
        setting,
        line.amplitude,
        line.standard_error,
        line.interval,
        line.verdict.value,
        is_found(line),
        channel.damage,
    )


def sound(points: Sequence[CurvePoint]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return settings, amplitudes and errors of the points that are judged, repeats merged."""
    kept = [point for point in points if not point.damage]
    columns = np.array([(p.setting, p.amplitude, p.standard_error) for p in kept]).reshape(-1, 3)
    return merged(columns[:, 0], columns[:, 1], columns[:, 2])


def _judged(curve: Curve, significance: float) -> Curve:
    return replace(curve, judgement=judge_steps(*sound(curve.points), significance))


def _loops(groups: Sequence[Group], curves: Sequence[Curve]) -> tuple[Loop, ...]:
    """Return every sweep up with the sweep down next to it in time."""
    pairs = []
    for number in range(len(groups)):
        series: dict[tuple[str, str, str], list[Curve]] = {}
        for curve in curves:
            if curve.group == number and curve.direction is not Direction.UNORDERED:
                series.setdefault((curve.channel, curve.side, curve.order), []).append(curve)
        for swept in series.values():
            pairs += [(one, other) for one, other in pairwise(swept) if one.direction is not other.direction]
    loops = []
    for one, other in pairs:
        up, down = (one, other) if one.direction is Direction.UP else (other, one)
        jumps = [
            step for curve in (up, down) for step in curve.judgement.steps if step.verdict is StepVerdict.JUMP
        ]
        found = judge_loop(_scattered(up), _scattered(down), FALSE_JUMPS / len(pairs), jumps)
        if found is not None:
            loops.append(Loop(up.group, up.channel, up.unit, up.side, up.order, found))
    return tuple(loops)


def _scattered(curve: Curve) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return a curve with errors that hold the scatter from run to run too."""
    setting, amplitude, error = sound(curve.points)
    scatter = curve.judgement.scatter
    return setting, amplitude, np.hypot(error, (scatter if np.isfinite(scatter) else 0.0) * amplitude)
