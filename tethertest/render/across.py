"""An analysis across runs as one JSON object, and its folder: SI, snake case, no number made here."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tethertest.records.across import Across, Curve, CurvePoint, Group, Loop, RunChannel, RunPart, Step
from tethertest.records.analysis import MEASURED
from tethertest.render.blocks import Picture
from tethertest.render.write import write_files

SUMMARY_NAME, PAGE_NAME = "across.json", "across.md"


def across_summary(across: Across) -> dict[str, Any]:
    """Return the object of ``analyze --across --json``; what JSON has no number for is null."""
    return {
        "path": across.path,
        "significance": across.significance,
        "runs": [_run(part) for part in across.runs],
        "groups": [_group(group) for group in across.groups],
        "curves": [_curve(curve) for curve in across.curves],
        "loops": [_loop(loop) for loop in across.loops],
        "notes": list(across.notes),
    }


def write_across(across: Across, folder: Path) -> tuple[Path, ...]:
    """Write page, summary and figures of runs analysed together.

    Parameters
    ----------
    across : Across
        The same runs give the same bytes.
    folder : Path
        Output folder, made if it does not exist.

    Raises
    ------
    TethertestError
        The folder cannot be made or written; nothing is left half-written.
    """
    from tethertest.render.figures.across import across_figures  # brings matplotlib

    figures = across_figures(across)
    text = json.dumps(across_summary(across), indent=1, ensure_ascii=False, allow_nan=False)
    contents = {PAGE_NAME: _page(across, figures).encode(), SUMMARY_NAME: f"{text}\n".encode()}
    contents |= {f"{name}.png": made.png for name, made in figures.items()}
    return write_files(folder, contents)


def _page(across: Across, figures: Mapping[str, Picture]) -> str:
    """Return the figures with their captions, what was left out and why, and every jump."""
    out = [f"# Runs of {Path(across.path).name}", ""]
    for name, made in figures.items():
        out += [f"![{made.alternative}]({name}.png)", "", made.caption, ""]
    steps = [
        f"- {curve.channel} ({curve.side}), order {curve.order}, {curve.direction.value}: "
        f"{step.verdict.value} between {step.interval[0]:.4g} and {step.interval[1]:.4g}: {step.reason}"
        for curve in across.curves
        for step in curve.judgement.steps
    ]
    looked = any(not curve.judgement.refused for curve in across.curves)
    none = "None was found." if looked else "No sweep has settings enough to look for one."
    out += ["## Jumps", "", *(steps or [none]), ""]
    said = [f"- {part.run}: left out: {part.refused}" for part in across.runs if part.refused]
    said += [
        f"- {part.run}, {channel.name}: shown and not judged: {channel.damage}"
        for part in across.runs
        for channel in part.channels
        if channel.damage and channel.side == MEASURED
    ]
    said += [f"- {part.run}: {remark}" for part in across.runs for remark in part.remarks]
    out += ["## Runs left out, and what was seen in others", "", *(said or ["Nothing."]), ""]
    return "\n".join([*out, *across.notes]).rstrip() + "\n"


def _run(part: RunPart) -> dict[str, Any]:
    return {
        "run": part.run,
        "path": part.path,
        "date": part.date or None,
        "rig": part.rig or None,
        "mode": part.mode or None,
        "frequency": part.frequency,
        "nominal_frequency": part.nominal_frequency,
        "amplitude": part.amplitude,
        "amplitude_measured": part.amplitude_measured,
        "nominal_amplitude": part.nominal_amplitude,
        "refused": part.refused or None,
        "remarks": list(part.remarks),
        "channels": [_channel(channel) for channel in part.channels],
    }


def _channel(channel: RunChannel) -> dict[str, Any]:
    return {
        "name": channel.name,
        "side": channel.side,
        "kind": channel.kind,
        "unit": channel.unit,
        "at": channel.at,
        "lines_found": len(channel.found),
        "orders_found": [line.order for line in channel.found],
        "no_lines": channel.no_lines or None,
        "damage": channel.damage or None,
        "largest_dynamic": channel.largest,
        "largest_raised_by_noise": channel.noise,
    }


def _group(group: Group) -> dict[str, Any]:
    return {
        "against": group.against,
        "rig": group.rig,
        "mode": group.mode,
        "fixed": group.fixed,
        "runs": list(group.runs),
        "branches": [
            {
                "direction": branch.direction.value,
                "runs": [group.runs[member] for member in branch.members],
            }
            for branch in group.branches
        ],
        "notes": list(group.notes),
    }


def _curve(curve: Curve) -> dict[str, Any]:
    judged = curve.judgement
    return {
        "group": curve.group,
        "channel": curve.channel,
        "side": curve.side,
        "unit": curve.unit,
        "order": curve.order,
        "direction": curve.direction.value,
        "points": [_point(point) for point in curve.points],
        "largest": None if curve.largest is None else _point(curve.largest),
        "steps": [_step(step) for step in judged.steps],
        "significance": judged.significance,
        "scatter": judged.scatter if math.isfinite(judged.scatter) else None,
        "no_steps": judged.refused or None,
    }


def _point(point: CurvePoint) -> dict[str, Any]:
    return {
        "run": point.run,
        "setting": point.setting,
        "amplitude": point.amplitude,
        "standard_error": point.standard_error,
        "interval": list(point.interval),
        "verdict": point.verdict,
        "found": point.found,
        "damage": point.damage or None,
    }


def _step(step: Step) -> dict[str, Any]:
    return {
        "verdict": step.verdict.value,
        "interval": list(step.interval),
        "amplitudes": list(step.amplitudes),
        "excess": step.excess if math.isfinite(step.excess) else None,
        "reason": step.reason,
    }


def _loop(loop: Loop) -> dict[str, Any]:
    found = loop.hysteresis
    return {
        "group": loop.group,
        "channel": loop.channel,
        "side": loop.side,
        "unit": loop.unit,
        "order": loop.order,
        "hysteresis": found.found,
        "differs": None if found.differs is None else list(found.differs),
        "area": found.area,
        "area_interval": list(found.interval),
        "largest": found.largest,
        "largest_at": found.largest_at,
        "significance": found.significance,
    }
