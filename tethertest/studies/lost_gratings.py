"""Random interrogator logs with lost, slipped, crossed and false peaks: what is attributed and kept."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tethertest.conditioning.gratings import assigned
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.cable import Cable, Platform
from tethertest.records.channel import Channel, Flag
from tethertest.records.rig import Instrument, Limits, Rig, Sensor
from tethertest.render.write import write_files

#: runs that are judged unless told otherwise
RUNS = 200
RATE, LENGTH = 100.0, 30.0
#: ways in which a logger orders the peaks that it still sees
LAYOUTS = ("own column", "slipping columns", "numbered peaks", "crossed columns")
#: a run is clear when no grating moves farther than this share of the distance to its neighbour, from where
#: the rig file expects it
CLEAR_SHARE = 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One log with what is in it."""

    seed: int
    layout: str
    true: FloatArray  #: (n, g) [m], NaN where a grating was lost
    columns: FloatArray  #: (n, p) as logged [m]
    rig: Rig
    clear: bool  #: gratings stay nearer to their own place than to a neighbour's
    ghosts: bool
    dead: bool


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a case, in samples."""

    case: Case
    visible: int
    kept: int
    wrong: int  #: values that are another grating's
    ghosts_taken: int  #: values that are no grating's
    lost: int
    unflagged: int  #: samples without a value and without a flag


def random_case(seed: int) -> Case:
    """Return a random log: 3 to 10 gratings, strain, warming, snaps, losses and ghosts."""
    random = np.random.default_rng(seed)
    count = int(random.integers(3, 11))
    time = np.arange(round(RATE * LENGTH)) / RATE
    spacing = float(random.uniform(1.5, 6.0))
    places = 1510.0 + spacing * (np.arange(count) + random.uniform(-0.15, 0.15, count))
    shift = _motion(random, time, spacing)
    true = places + shift[:, None] * random.uniform(0.88, 1.12, count)
    true += random.uniform(-5.0, 5.0) * 0.01 * (time / LENGTH)[:, None]
    true += random.normal(0.0, random.uniform(0.5e-3, 3e-3), true.shape)
    true = np.round(true, 4)
    expected = np.round(places + random.uniform(-0.08, 0.08, count) * spacing, 2)
    gap = float(np.min(np.diff(np.sort(expected))))
    reach = float(np.max(np.abs(true - expected)))
    clear = reach < CLEAR_SHARE * gap
    capture = 0.5 * gap if clear else 1.15 * reach
    dead = bool(random.random() < 0.1)
    seen = _seen(random, time.size, count, dead)
    ghosts = bool(random.random() < 0.3)
    extra = _ghosts(random, time.size, expected, capture) if ghosts else np.full((time.size, 0), np.nan)
    layout = LAYOUTS[int(random.integers(len(LAYOUTS)))]
    if extra.size and layout != "numbered peaks":
        layout = "slipping columns"
    visible = np.where(seen, true, np.nan)
    rig = _rig(expected, capture)
    columns = _laid_out(random, layout, visible, extra)
    return Case(seed, layout, 1e-9 * visible, 1e-9 * columns, rig, clear, ghosts, dead)


def judge(case: Case) -> Outcome:
    """Assign the peaks of a case and compare every value with what was put in."""
    time = np.arange(case.columns.shape[0]) / RATE
    numbered = case.layout == "numbered peaks"
    names = [
        f"CH1 peak{number + 1}" if numbered or number >= len(case.rig.sensor) else f"g{number + 1}"
        for number in range(case.columns.shape[1])
    ]
    logged = [
        Channel(name, "wavelength", "m", time, values, np.zeros(time.size, np.uint16))
        for name, values in zip(names, case.columns.T, strict=True)
    ]
    found = {channel.name: channel for channel in assigned(logged, case.rig)[0]}
    visible = np.isfinite(case.true)
    kept = wrong = ghosts = unflagged = 0
    for number, sensor in enumerate(case.rig.sensor):
        channel = found.get(sensor.name)
        if channel is None:
            continue
        given = np.isfinite(channel.values)
        right = given & (channel.values == case.true[:, number])
        others = given & ~right & (channel.values[:, None] == case.true).any(axis=1)
        kept += int(np.count_nonzero(right))
        wrong += int(np.count_nonzero(others))
        ghosts += int(np.count_nonzero(given & ~right & ~others))
        unflagged += int(np.count_nonzero(~given & ((channel.flags & np.uint16(Flag.LOST)) == 0)))
    total = int(np.count_nonzero(visible))
    return Outcome(case, total, kept, wrong, ghosts, visible.size - total, unflagged)


def table(outcomes: Sequence[Outcome]) -> str:
    """Return the study's page in Markdown."""
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
        f"`python -m tethertest.studies.lost_gratings {len(outcomes)}`: random interrogator logs of "
        f"{LENGTH:g} s at {RATE:g} Hz with 3 to 10 gratings, 1.5 to 6 nm apart, strained together by up to "
        "several nanometres with snaps, warmed by up to 5 K. Gratings are lost in single rows and in long "
        "stretches, several at once and all at once; some logs hold ghosts, peaks that belong to no grating; "
        "columns slip, cross or are numbered. Counts are samples. A value is wrong when it is another "
        "grating's; a peak is kept when its own grating has it.\n\n"
        "| runs | number | lost | visible | kept | least kept of a run | wrong | ghosts taken | unflagged |\n"
        "|---|---|---|---|---|---|---|---|---|\n"
        f"{rows}\n"
    )


def main(arguments: list[str]) -> int:
    """Judge as many random runs as asked for, print the page, write it to the file after ``-o``."""
    words = list(arguments)
    output = None
    if "-o" in words:
        at = words.index("-o")
        output = Path(words[at + 1])
        del words[at : at + 2]
    outcomes = [judge(random_case(seed)) for seed in range(int(words[0]) if words else RUNS)]
    page = table(outcomes)
    sys.stdout.write(page)
    if output is not None:
        write_files(output.parent, {output.name: page.encode()})
    return 0 if not any(item.wrong or item.unflagged for item in outcomes) else 1


def _motion(random: np.random.Generator, time: FloatArray, spacing: float) -> FloatArray:
    """Return the common shift [nm]: slow oscillation that ramps up, and snaps in a third of the runs."""
    swing = float(np.exp(random.uniform(np.log(0.03), np.log(min(3.0, 0.9 * spacing)))))
    frequency = float(random.uniform(0.1, 1.5))
    ramp = np.clip((time - 3.0) / 3.0, 0.0, 1.0)
    shift = swing * ramp * np.sin(2.0 * np.pi * frequency * time)
    if random.random() < 0.35:
        for start in np.arange(6.0, LENGTH - 1.0, 1.0 / frequency):
            width, height = random.uniform(0.01, 0.05), swing * random.uniform(0.3, 1.2)
            shift += height * np.sin(np.pi * np.clip((time - start) / width, 0.0, 1.0))
    return shift


def _seen(random: np.random.Generator, rows: int, count: int, dead: bool) -> BoolArray:
    seen = random.random((rows, count)) > float(random.choice((0.0, 0.002, 0.01)))
    for grating in range(count):
        for _ in range(int(random.integers(0, 3))):
            start = int(random.integers(0, rows))
            seen[start : start + int(random.uniform(5, 1000)), grating] = False
    for _ in range(int(random.integers(0, 3))):
        start, several = int(random.integers(0, rows)), random.random(count) < 0.6
        seen[start : start + int(random.uniform(5, 300)), several] = False
    if random.random() < 0.3:
        start = int(random.integers(0, rows))
        seen[start : start + int(random.uniform(10, 100))] = False
    if dead:
        seen[:, int(random.integers(count))] = False
    return seen


def _ghosts(random: np.random.Generator, rows: int, expected: FloatArray, capture: float) -> FloatArray:
    extra = np.full((rows, 1), np.nan)
    for _ in range(int(random.integers(1, 6))):
        start = int(random.integers(0, rows))
        stop = min(start + int(random.choice((1, 1, 20, 300))), rows)
        near = float(random.choice(expected)) + random.uniform(-0.9, 0.9) * capture
        extra[start:stop, 0] = np.round(near + random.normal(0.0, 2e-3, stop - start), 4)
    return extra


def _laid_out(random: np.random.Generator, layout: str, visible: FloatArray, extra: FloatArray) -> FloatArray:
    """Return the columns that a logger writes."""
    if layout == "own column":
        return visible
    if layout == "crossed columns":
        crossed = visible.copy()
        one, other = random.choice(visible.shape[1], 2, replace=False)
        start = int(random.integers(0, visible.shape[0]))
        crossed[start:, [one, other]] = crossed[start:, [other, one]]
        return crossed
    return np.sort(np.hstack((visible, extra)), axis=1)


def _rig(expected: FloatArray, capture: float) -> Rig:
    gratings = tuple(
        Sensor(
            f"g{number + 1}", "wavelength", at=0.5, expected=1e-9 * float(at), capture=1e-9 * capture
        )
        for number, at in enumerate(expected)
    )  # fmt: skip
    return Rig(
        "random",
        Cable(3.0, "unstretched", 0.05, 10_000.0),
        Platform(0.4, 5.0),
        gratings,
        (Instrument("interrogator", RATE),),
        Limits(),
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
    raise SystemExit(main(sys.argv[1:]))
