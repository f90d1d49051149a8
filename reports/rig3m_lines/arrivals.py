"""Fronts of the knocks at rest, and the wave speed they imply, against the statement's cable."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from reports.rig3m_lines.findings import TENSIONS, Clock, Complaints, allowed_misses, table
from tethertest.records.analysis import WaveFindings
from tethertest.records.events import Front, Interval

#: a front belongs to the knock that arrives nearest to it, within half a knock [s]
NEAR = 0.03
#: runs whose knock may stay without a speed
WITHOUT = 2
#: worst error and median width of an interval [s], of the load cells at 500 Hz or 1 kHz and of the gratings
#: at 100 Hz: an interval that holds everything says nothing
CELLS, GRATINGS = (2e-3, 12e-3), (10e-3, 20e-3)


class ArrivalCheck:
    """Axial arrivals of all runs."""

    def __init__(self, complaints: Complaints) -> None:
        self.complaints = complaints
        self.errors: dict[str, list[tuple[float, Interval]]] = {}
        self.speeds: list[list[str]] = []
        self.missed = 0
        self.runs = 0

    def add(self, run: str, waves: WaveFindings, truth: dict[str, Any]) -> None:
        """Compare one run: each front with the knock's way up to it, the speed with that of the cable."""
        cable, clock = truth["settings"]["cable"], Clock(truth)
        stiffness, mass = cable["axial_stiffness_N"], cable["mass_per_length_kg_per_m"]
        speed = math.sqrt(stiffness / mass)
        knocks = [time for time in truth["windows"]["taps"] if time < truth["windows"]["rest_before"][1]]
        self.runs += 1
        for front in waves.fronts:
            self._front(run, front, [clock.shows(t + front.at * cable["length_m"] / speed) for t in knocks])
        found = waves.speed
        if found is None:
            self.missed += 1
            self.speeds.append([run, str(len(waves.fronts)), "-", "-", "; ".join(waves.remarks)])
            return
        holds = found.interval[0] <= speed <= found.interval[1]
        stiff = found.value_interval[0] <= stiffness <= found.value_interval[1]
        self.complaints.demand(
            holds and stiff, f"{run}: wave speed {_range(found.interval)} m/s, true {speed:.1f} m/s"
        )
        self.speeds.append(
            [
                run, str(len(waves.fronts)), f"{_range(found.interval)} {'yes' if holds else '**no**'}",
                f"{_range(found.value_interval)} {'yes' if stiff else '**no**'}", "",
            ]
        )  # fmt: skip

    def _front(self, run: str, front: Front, true: list[float]) -> None:
        arrival = min(true, key=lambda time: abs(time - front.time))
        if abs(arrival - front.time) > NEAR:
            self.complaints.demand(
                False, f"{run} {front.channel}: a front at {front.time:.4f} s is no knock's"
            )
            return
        around = (front.interval[0] - arrival, front.interval[1] - arrival)
        self.errors.setdefault(front.channel, []).append((front.time - arrival, around))

    def text(self) -> str:
        """Return the tables, and complain of what is wrong."""
        rows, held, count = [], 0, 0
        for channel, errors in self.errors.items():
            inside = sum(low <= 0.0 <= high for _, (low, high) in errors)
            times = np.array([error for error, _ in errors]) * 1e3
            widths = np.array([high - low for _, (low, high) in errors]) * 1e3
            held, count = held + inside, count + len(errors)
            worst, widest = CELLS if channel in TENSIONS else GRATINGS
            self.complaints.demand(
                bool(np.abs(times).max() <= worst * 1e3 and np.median(widths) <= widest * 1e3),
                f"{channel}: fronts off by up to {np.abs(times).max():.2f} ms, in intervals of "
                f"{np.median(widths):.1f} ms",
            )
            rows.append(
                [
                    channel, f"{len(errors)} / {self.runs}", f"{inside} / {len(errors)}",
                    f"{np.median(times):+.2f} ({np.abs(times).max():.2f})", f"{np.median(widths):.2f}",
                ]
            )  # fmt: skip
        self.complaints.demand(
            count - held <= allowed_misses(count),
            f"{count - held} of {count} intervals do not hold the front, 5 % may",
        )
        self.complaints.demand(self.missed <= WITHOUT, f"{self.missed} runs without a wave speed")
        return (
            "## Axial arrivals\n\nThe knock on the base plate at rest, on its way up: true arrivals are the "
            "knock's start and the way to the sensor at sqrt(EA/m). The knock sets in as a parabola. "
            f"Intervals hold the arrival in {held} of {count}: they allow for a jump, a ramp and a parabola, "
            "which is more than 95 %.\n\n"
            + table("channel|fronts / runs|holds|error [ms] median (worst)|width [ms]", rows)
            + "\n\nThe speed that the first knock implies, 95 %, and the stiffness. True: 455.0 m/s and "
            "10020 N.\n\n"
            + table("run|fronts|speed [m/s] holds|stiffness [N] holds|why not", self.speeds)
            + "\n\nNo transverse arrival is in the campaign: the base moves along the cable, and a knock of "
            "half a millimetre sends nothing sideways that a sensor of tension could see. The kink that a "
            "transverse front leaves in the tension is tested in `tests/unit/spectra/test_arrivals.py`."
        )


def _range(interval: Interval) -> str:
    low, high = interval
    return f"{low:.0f} to {high:.0f}" if math.isfinite(high) else f"{low:.0f} or more"
