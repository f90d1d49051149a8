"""The calibration's files: the tables, the power in numbers, and its figure."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Final

import numpy as np

from tethertest.studies.line_calibration.power import Found, theoretical_power

#: points of the curve that the theory gives
_POINTS: Final = 200


def calibration_files(table: str, found: Sequence[Found]) -> dict[str, bytes]:
    """Return the files by name: ``calibration.md``, ``power.csv`` and ``power.png``.

    Parameters
    ----------
    table : str
        The tables in Markdown.
    found : sequence of Found
        What became of locked lines, by rising amplitude.
    """
    return {
        "calibration.md": table.encode("utf-8"),
        "power.csv": power_table(found).encode("utf-8"),
        "power.png": power_png(found),
    }


def power_table(found: Sequence[Found]) -> str:
    """Return counts, shares, intervals and the theory as CSV; amplitudes in standard errors."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    heads = "amplitude,records,found,share,share_low,share_high,significant,undetermined,f_test,bias,raw_bias"
    writer.writerow(heads.split(","))
    for item in found:
        shares = (item.power, *item.interval)
        rest = (item.theory, item.bias, item.raw_bias)
        counts = (item.significant, item.undetermined)
        writer.writerow(
            (
                f"{item.amplitude:g}",
                item.records,
                item.found,
                *(f"{share:.6g}" for share in shares),
                *counts,
                *(f"{number:.6g}" for number in rest),
            )
        )
    return stream.getvalue()


def power_png(found: Sequence[Found]) -> bytes:
    """Return the figure of power against amplitude."""
    from tethertest.render.figures.power import PowerPoint, power_figure

    points = tuple(PowerPoint(item.amplitude, item.power, item.interval) for item in found)
    amplitudes = np.geomspace(points[0].amplitude, points[-1].amplitude, _POINTS)
    curve = np.array([theoretical_power(float(amplitude)) for amplitude in amplitudes])
    return power_figure(points, amplitudes, curve, found[0].records).png
