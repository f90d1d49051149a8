"""An analysis across runs for other programs, and its folder: SI, snake case, no number made here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tethertest.records.across import (
    Across,
    Curve,
    CurvePoint,
    Direction,
    Group,
    Loop,
    RunChannel,
    RunPart,
    Step,
)
from tethertest.records.analysis import MEASURED
from tethertest.records.channel import Side
from tethertest.records.described import Doc
from tethertest.render.as_json import json_text
from tethertest.render.blocks import Picture
from tethertest.render.published import Paths, Span, taken
from tethertest.render.write import write_files
from tethertest.units import Kind

SUMMARY_NAME, PAGE_NAME = "across.json", "across.md"


@dataclass(frozen=True, slots=True)
class ChannelInRun:
    """What a run contributes of one channel."""

    name: Annotated[str, Doc("sensor of the rig")]
    side: Side
    kind: Annotated[Kind, Doc("what it measures")]
    unit: Annotated[str, Doc("SI")]
    at: Annotated[float | None, Doc("fraction of the cable's length from the bottom")]
    lines_found: Annotated[int, Doc("how many lines are there")]
    orders_found: Annotated[tuple[str, ...], Doc("their orders")]
    no_lines: Annotated[str, Doc("why there are none", null="they were looked for")]
    damage: Annotated[str, Doc("why its points are shown and not judged", null="they are judged")]
    largest_dynamic: Annotated[float | None, Doc("largest value in the window less the value at rest")]
    largest_raised_by_noise: Annotated[float, Doc("by how much noise may have raised largest_dynamic")]


@dataclass(frozen=True, slots=True)
class RunFound:
    """One run of the folder."""

    run: Annotated[str, Doc("its id")]
    path: Annotated[str, Doc("its folder")]
    date: Annotated[str, Doc("ISO 8601", null="not known")]
    rig: Annotated[str, Doc("name in the rig file", null="not known")]
    mode: Annotated[str, Doc("of the platform", null="not known")]
    frequency: Annotated[float | None, Doc("of the drive, fitted [Hz]")]
    nominal_frequency: Annotated[float | None, Doc("of the drive, as run.toml has it [Hz]")]
    amplitude: Annotated[float | None, Doc("of the bottom motion at the drive [m]")]
    amplitude_measured: Annotated[bool, Doc("false: the amplitude is the nominal one")]
    nominal_amplitude: Annotated[float | None, Doc("as run.toml has it [m]")]
    refused: Annotated[str, Doc("why the run is on no curve", null="it is")]
    remarks: Annotated[tuple[str, ...], Doc("what a person should know")]
    channels: Annotated[tuple[ChannelInRun, ...], Doc("measured and replayed")]


@dataclass(frozen=True, slots=True)
class BranchFound:
    """Runs in the order of time between two turns of the setting."""

    direction: Annotated[Direction, Doc("how the setting moved from run to run")]
    runs: Annotated[tuple[str, ...], Doc("in the order of time")]


@dataclass(frozen=True, slots=True)
class GroupFound:
    """Runs that differ in one setting of the drive only."""

    against: Annotated[str, Doc("the setting: frequency or amplitude")]
    rig: Annotated[str, Doc("name in the rig file")]
    mode: Annotated[str, Doc("of the platform")]
    fixed: Annotated[float | None, Doc("the other setting: amplitude [m] or frequency [Hz]")]
    runs: Annotated[tuple[str, ...], Doc("in the order of time")]
    branches: Annotated[tuple[BranchFound, ...], Doc("in the order of time")]
    notes: Annotated[tuple[str, ...], Doc("what a person should know")]


@dataclass(frozen=True, slots=True)
class CurveFound:
    """Amplitude of one order of one channel against one setting, along one branch."""

    group: Annotated[int, Doc("place of its group, from 0")]
    channel: Annotated[str, Doc("sensor of the rig")]
    side: Side
    unit: Annotated[str, Doc("SI")]
    order: Annotated[str, Doc("multiple of the drive frequency")]
    direction: Annotated[Direction, Doc("how the setting moved from run to run")]
    points: Annotated[tuple[CurvePoint, ...], Doc("in the order of time")]
    largest: Annotated[CurvePoint | None, Doc("of those that are sure to be lines and are judged")]
    steps: Annotated[tuple[Step, ...], Doc("that the trend on both sides does not carry")]
    significance: Annotated[float, Doc("chance of one false jump in the curve")]
    scatter: Annotated[float, Doc("from run to run, relative standard deviation", null="not known")]
    no_steps: Annotated[str, Doc("why jumps were not looked for", null="they were")]


@dataclass(frozen=True, slots=True)
class LoopFound:
    """An up-sweep and a down-sweep of one order of one channel."""

    group: Annotated[int, Doc("place of its group, from 0")]
    channel: Annotated[str, Doc("sensor of the rig")]
    side: Side
    unit: Annotated[str, Doc("SI")]
    order: Annotated[str, Doc("multiple of the drive frequency")]
    hysteresis: Annotated[bool, Doc("whether up and down differ anywhere")]
    differs: Annotated[Span | None, Doc("settings between which they differ")]
    area: Annotated[float, Doc("integral of up less down over the setting both have")]
    area_interval: Annotated[Span, Doc("95 % of the area")]
    largest: Annotated[float, Doc("up less down where they differ most")]
    largest_at: Annotated[float, Doc("that setting")]
    significance: Annotated[float, Doc("chance to call two equal branches different")]


@dataclass(frozen=True, slots=True)
class AcrossFound:
    """What many runs show together: the content of across.json."""

    path: Annotated[str, Doc("the folder")]
    significance: Annotated[float, Doc("chance of one false jump in the folder")]
    runs: Annotated[tuple[RunFound, ...], Doc("all of them, in the order of time")]
    groups: Annotated[tuple[GroupFound, ...], Doc("by the setting that differs")]
    curves: Annotated[tuple[CurveFound, ...], Doc("by group, channel and order")]
    loops: Annotated[tuple[LoopFound, ...], Doc("where a sweep went up and down")]
    notes: Annotated[tuple[str, ...], Doc("what a person should know")]


@dataclass(frozen=True, slots=True)
class PrintedAcross(AcrossFound):
    """What ``analyze --across --json`` prints: the content of across.json, and where the files are."""

    paths: Paths


def across_summary(across: Across) -> AcrossFound:
    """Return runs analysed together as the record of their JSON."""
    return taken(
        AcrossFound,
        across,
        runs=tuple(_run(part) for part in across.runs),
        groups=tuple(_group(group) for group in across.groups),
        curves=tuple(_curve(curve) for curve in across.curves),
        loops=tuple(_loop(loop) for loop in across.loops),
    )


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
    text = json_text(across_summary(across), indent=1)
    contents = {PAGE_NAME: _page(across, figures).encode(), SUMMARY_NAME: text.encode()}
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


def _run(part: RunPart) -> RunFound:
    return taken(RunFound, part, channels=tuple(_channel(channel) for channel in part.channels))


def _channel(channel: RunChannel) -> ChannelInRun:
    return taken(
        ChannelInRun,
        channel,
        lines_found=len(channel.found),
        orders_found=tuple(line.order for line in channel.found),
        largest_dynamic=channel.largest,
        largest_raised_by_noise=channel.noise,
    )


def _group(group: Group) -> GroupFound:
    branches = (
        BranchFound(branch.direction, tuple(group.runs[member] for member in branch.members))
        for branch in group.branches
    )
    return taken(GroupFound, group, branches=tuple(branches))


def _curve(curve: Curve) -> CurveFound:
    judged = curve.judgement
    return taken(
        CurveFound,
        curve,
        steps=judged.steps,
        significance=judged.significance,
        scatter=judged.scatter,
        no_steps=judged.refused,
    )


def _loop(loop: Loop) -> LoopFound:
    found = loop.hysteresis
    return taken(
        LoopFound,
        loop,
        hysteresis=found.found,
        differs=found.differs,
        area=found.area,
        area_interval=found.interval,
        largest=found.largest,
        largest_at=found.largest_at,
        significance=found.significance,
    )
