"""The calibration's files: the tables, the power in numbers, and its figure."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from reports.line_calibration.figure import power_figure
from reports.line_calibration.power import Found


def calibration_files(table: str, found: Sequence[Found]) -> dict[str, bytes]:
    """Return the files by name: ``README.md``, ``power.csv`` and ``power.png``.

    Parameters
    ----------
    table : str
        The tables in Markdown.
    found : sequence of Found
        What became of locked lines, by rising amplitude.
    """
    return {
        "README.md": table.encode("utf-8"),
        "power.csv": power_table(found).encode("utf-8"),
        "power.png": power_figure(found).png,
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
