"""The study's files: the report, its numbers and its figures."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from reports.wave_energy.cases import FIGURE_8
from reports.wave_energy.figures import crest_figure, map_figure, sweep_figure
from reports.wave_energy.maps import MODELS
from reports.wave_energy.sweep import Sweep
from reports.wave_energy.table import page


def study_files(sweep: Sweep) -> dict[str, bytes]:
    """Return the files by name."""
    maps = [
        next(one for one in sweep.maps if (one.model, one.frequency) == (model, frequency))
        for model in MODELS
        for frequency in FIGURE_8
    ]
    return {
        "README.md": page(sweep).encode("utf-8"),
        "started.csv": _started(sweep).encode("utf-8"),
        "settled.csv": _settled(sweep).encode("utf-8"),
        "waves.csv": _waves(sweep).encode("utf-8"),
        "fig8.png": map_figure(maps).png,
        "largest.png": crest_figure(maps).png,
        "sweep.png": sweep_figure(sweep).png,
    }


def _started(sweep: Sweep) -> str:
    heads = "drive_hz,model,place,time_s,phase,largest_n,middle_n,bottom_n,top_n,one_shape,instants_in_middle"
    rows = []
    for run in sweep.started:
        one = run.largest
        numbers = (one.place, one.time, one.phase, one.value, one.middle, one.bottom, one.top)
        rest = (run.share, run.in_middle)
        rows.append((f"{run.frequency:g}", run.model, *map(_short, (*numbers, *rest))))
    return _csv(heads, rows)


def _settled(sweep: Sweep) -> str:
    heads = (
        "drive_hz,case,place,phase,largest_n,middle_n,bottom_n,top_n,lowest_total_n,work_w,out_at_top_w,"
        "linear_work_w,change_between_halves"
    )
    rows = []
    for run in sweep.settled:
        one, linear = run.largest, sweep.closed[run.frequency, run.case]
        numbers = (one.place, one.phase, one.value, one.middle, one.bottom, one.top, run.lowest)
        rest = (run.work, run.arriving, linear, run.change)
        rows.append((f"{run.frequency:g}", run.case, *map(_short, (*numbers, *rest))))
    return _csv(heads, rows)


def _waves(sweep: Sweep) -> str:
    heads = (
        "drive_hz,case,section,kind,order,order_hz,up_n,up_low,up_high,down_n,down_low,down_high,"
        "energy_ratio,standing_wave_ratio,power_up_w,refused"
    )
    rows = []
    for run in sweep.settled:
        for section in run.sections:
            for kind, found in (("axial", section.along), ("transverse", section.across)):
                for waves in found:
                    numbers = (
                        waves.frequency,
                        waves.up,
                        *waves.up_interval,
                        waves.down,
                        *waves.down_interval,
                        waves.energy_ratio,
                        waves.standing_wave_ratio,
                        waves.power,
                    )
                    first = (f"{run.frequency:g}", run.case, f"{section.at:g}", kind, waves.order)
                    rows.append((*first, *map(_short, numbers), waves.refused))
    return _csv(heads, rows)


def _short(number: float) -> str:
    return f"{number:.5g}"


def _csv(heads: str, rows: Iterable[Sequence[str]]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(heads.split(","))
    writer.writerows(rows)
    return stream.getvalue()
