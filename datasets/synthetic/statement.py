"""What `truth.json` states of a run: orders, slack, peaks, windows, clocks, convergence."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .campaign import REST, Plan
from .instruments import Record
from .motion import TAP_WIDTH
from .noise import Clock
from .rig import MODES, Rig
from .tether import COURANT, RECORD_RATE, Truth, time_step

Floats = NDArray[np.float64]

ORDERS = {"1/2": 0.5, "1": 1.0, "3/2": 1.5, "2": 2.0, "3": 3.0}
SLACK_BELOW = 0.15
SLACK_JOIN = 0.020
SLACK_SHORTEST = 0.010
MEAN_OVER = 0.020


def steady_window(plan: Plan) -> tuple[float, float] | None:
    """Return the last even number of crank turns at full speed, in true time."""
    drive = plan.drive
    if drive.frequency == 0.0:
        return None
    longest = drive.stop - (drive.start + drive.ramp_up + plan.settling)
    turns = 2 * math.floor(longest * drive.frequency / 2.0 + 1e-9)
    return drive.stop - turns / drive.frequency, drive.stop


def windows(plan: Plan) -> dict[str, Any]:
    """Return the run's stretches in true time."""
    begin = REST if plan.frequency else plan.driven_until
    steady = steady_window(plan)
    return {
        "rest_before": [0.0, begin],
        "ramp_up": [REST, REST + plan.drive.ramp_up] if plan.frequency else None,
        "steady": list(steady) if steady else None,
        "ramp_down": [plan.drive.stop, plan.driven_until] if plan.frequency else None,
        "rest_after": [plan.driven_until, plan.duration],
        "taps": [tap.start for tap in plan.taps],
        "tap_width": TAP_WIDTH,
        "tap_heights_mm": [1e3 * tap.height for tap in plan.taps],
    }


def orders(plan: Plan, truth: Truth) -> dict[str, Any] | None:
    """Return amplitude and phase at p/q of the crank's frequency, by least squares.

    A line of amplitude a and phase p is a cos(2 pi p/q f t + p), t in true time.
    """
    steady = steady_window(plan)
    if steady is None:
        return None
    inside = (truth.time >= steady[0]) & (truth.time < steady[1])
    time = truth.time[inside]
    angle = 2.0 * np.pi * plan.frequency * time
    columns = [np.ones_like(time)]
    for multiple in ORDERS.values():
        columns += [np.cos(multiple * angle), np.sin(multiple * angle)]
    basis = np.column_stack(columns)
    found: dict[str, Any] = {}
    for name in ("tension_top", "tension_bottom", "heave"):
        values = getattr(truth, name)[inside]
        weights = np.linalg.lstsq(basis, values, rcond=None)[0]
        cosine, sine = weights[1::2], weights[2::2]
        found[name] = {
            "mean": weights[0],
            **{
                order: {"amplitude": np.hypot(c, s), "phase": np.arctan2(-s, c)}
                for order, c, s in zip(ORDERS, cosine, sine, strict=True)
            },
        }
    return found


def slack_intervals(time: Floats, tension: Floats, joined: float = SLACK_JOIN) -> list[list[float]]:
    """Return when a tension is at zero: gaps shorter than `joined` (s) are, short intervals dropped."""
    below = np.concatenate(([0], (tension < SLACK_BELOW).astype(np.int8), [0]))
    edges = np.flatnonzero(np.diff(below))
    found: list[list[float]] = []
    for first, last in zip(edges[0::2], edges[1::2] - 1, strict=True):
        if found and time[first] - found[-1][1] < joined:
            found[-1][1] = float(time[last])
        else:
            found.append([float(time[first]), float(time[last])])
    return [span for span in found if span[1] - span[0] >= SLACK_SHORTEST]


def slack(plan: Plan, truth: Truth) -> dict[str, Any]:
    """Return slack intervals of both ends and their part of the steady window."""
    result: dict[str, Any] = {
        "below_N": SLACK_BELOW,
        "joined_s": SLACK_JOIN,
        "shortest_s": SLACK_SHORTEST,
    }
    steady = steady_window(plan)
    for name in ("tension_bottom", "tension_top"):
        spans = slack_intervals(truth.time, getattr(truth, name))
        result[name] = spans
        if steady:
            inside = [min(b, steady[1]) - max(a, steady[0]) for a, b in spans]
            part = sum(length for length in inside if length > 0.0) / (steady[1] - steady[0])
            result[name + "_fraction"] = part
    return result


def peaks(plan: Plan, truth: Truth) -> dict[str, Any]:
    """Return the largest and smallest tensions over the steady window and the run."""
    steady = steady_window(plan)
    width = round(MEAN_OVER * RECORD_RATE)
    result: dict[str, Any] = {"mean_over_s": MEAN_OVER}
    for label, span in (("steady", steady), ("run", (0.0, plan.duration))):
        if span is None:
            continue
        inside = (truth.time >= span[0]) & (truth.time <= span[1])
        part: dict[str, Any] = {}
        for name in ("tension_top", "tension_bottom"):
            values = getattr(truth, name)[inside]
            smooth = np.convolve(values, np.full(width, 1.0 / width), "valid")
            part[name] = {
                "max": values.max(),
                "min": values.min(),
                "max_of_mean": smooth.max(),
            }
        result[label] = part
    return result


def clocks(records: dict[str, Record]) -> dict[str, Any]:
    """Return every clock, and what a perfect alignment to the data logger would report."""
    own: dict[str, Any] = {}
    relative: dict[str, Any] = {}
    daq = records["daq"].clock
    for name, record in records.items():
        clock = record.clock
        own[name] = {
            "offset_s": clock.offset,
            "drift_ppm": clock.drift,
            "first_reading_s": float(record.reading[0]),
            "first_true_s": float(record.true_time[0]),
            "rate_Hz": record.rate,
            "samples": record.reading.size,
        }
        if name != "daq":
            relative[name] = relative_clock(clock, daq)
    return {
        "convention": "reading = true_time (1 + drift_ppm 1e-6) + offset_s, both in s since date",
        "each": own,
        "relative_convention": "reading = daq_reading (1 + drift_ppm 1e-6) + offset_s",
        "relative_to_daq": relative,
    }


def relative_clock(clock: Clock, daq: Clock) -> dict[str, float]:
    """Return a clock's offset and drift against another."""
    ratio = clock.rate / daq.rate
    return {
        "offset_s": round(clock.offset - daq.offset * ratio, 7),
        "drift_ppm": round((ratio - 1.0) * 1e6, 4),
    }


def convergence(plan: Plan, truth: Truth, other: Truth) -> dict[str, Any]:
    """Return what changes between the truth and the same run with other cells."""
    pair = [truth, other]
    result: dict[str, Any] = {"cells": [plan.cells, plan.other_cells], "truth_cells": plan.cells}
    where = "steady" if plan.frequency else "run"
    for name in ("tension_top", "tension_bottom"):
        for key in ("max", "max_of_mean"):
            values = [float(peaks(plan, run)[where][name][key]) for run in pair]
            label = f"peak_{name}" if key == "max" else f"peak_of_mean_{name}"
            result[label] = {"values": values, "relative": _spread(values)}
        fractions = [slack(plan, run).get(name + "_fraction", 0.0) for run in pair]
        result[f"slack_fraction_{name}"] = {"values": fractions}
    found = [orders(plan, run) for run in pair]
    for order in ORDERS:
        for name in ("tension_top", "tension_bottom"):
            if found[0] and found[1]:
                values = [float(lines[name][order]["amplitude"]) for lines in found if lines]
                result[f"order_{order}_{name}"] = {"values": values, "relative": _spread(values)}
    return result


def settings(plan: Plan, rig: Rig) -> dict[str, Any]:
    """Return the integration's settings and the rig's numbers."""
    return {
        "scheme": "rk4",
        "courant": COURANT,
        "time_step_s": time_step(rig, plan.cells),
        "cells": plan.cells,
        "record_rate_Hz": RECORD_RATE,
        "initial_state": "exact rest state of the lumped chain",
        "cable": {
            "length_m": rig.length,
            "mass_per_length_kg_per_m": rig.mass_per_length,
            "axial_stiffness_N": rig.axial_stiffness,
            "diameter_m": rig.diameter,
            "axial_damping_N_s": rig.axial_damping,
            "axial_damping_time_s": rig.axial_damping / rig.axial_stiffness,
            "damping_when_slack": "also acts: MoorDyn's damper pushes",
        },
        "air": {
            "density_kg_per_m3": rig.air_density,
            "normal_drag": rig.normal_drag,
            "tangential_drag": rig.tangential_drag,
        },
        "sideways_offset_of_top_m": plan.offset,
        "offset_meaning": "the rig is nominally vertical; a small lean lets slack cable fold",
    }


def platform(plan: Plan, rig: Rig) -> dict[str, Any]:
    """Return the UAV's mode and numbers."""
    hover = MODES[plan.mode]
    return {
        "mode": plan.mode,
        "mass_kg": rig.uav_mass,
        "static_tension_N": rig.static_tension,
        "hover_stiffness_N_per_m": hover.stiffness,
        "hover_damping_N_s_per_m": hover.damping,
    }


def drive(plan: Plan) -> dict[str, Any]:
    """Return the crank's motion."""
    if plan.frequency == 0.0:
        return {"kind": "none"}
    motion = plan.drive
    return {
        "kind": "crank-slider",
        "frequency_Hz": motion.frequency,
        "radius_m": motion.radius,
        "rod_ratio": 0.25,
        "rest_angle_deg": -90.0,
        "start_s": motion.start,
        "ramp_up_s": motion.ramp_up,
        "stop_s": motion.stop,
        "ramp_down_s": motion.ramp_down,
        "turns": plan.turns,
        "gear_error_m": motion.gear_error,
        "gear_error_form": "gear_error sin(turned angle / 2), added to the height",
    }


def _spread(values: list[float]) -> float | None:
    """Return the difference over the first value, where that means anything."""
    first, second = values
    return abs(second - first) / abs(first) if abs(first) > 1e-3 else None
