"""The orders of all channels: as CSV, and as a page in Markdown with the figures."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Final

from tethertest.records.analysis import MEASURED, Analysis, ChannelAnalysis
from tethertest.records.lines import Line
from tethertest.render.scales import scale_for
from tethertest.render.text import number, words

_HEAD: Final = (
    "channel,side,unit,order,frequency_Hz,amplitude,amplitude_low,amplitude_high,standard_error,"
    "significant_above,phase_rad,p_value,verdict,reason\n"
)


def order_rows(analysis: Analysis) -> str:
    """Return all lines of an analysis as CSV, in SI: one row per channel and order."""
    stream = io.StringIO()
    stream.write(_HEAD)
    writer = csv.writer(stream, lineterminator="\n")
    for item in analysis.channels:
        for line in () if item.lines is None else item.lines.lines:
            above = "" if line.significant_above is None else f"{line.significant_above:.7g}"
            numbers = [f"{value:.7g}" for value in (line.amplitude, *line.interval, line.standard_error)]
            writer.writerow(
                (
                    item.channel.name,
                    item.side,
                    item.channel.unit,
                    line.order,
                    f"{line.frequency:.9g}",
                    *numbers,
                    above,
                    f"{line.phase:.7g}",
                    f"{line.p_value:.7g}",
                    line.verdict.value,
                    line.reason,
                )
            )
    return stream.getvalue()


def analysis_page(
    analysis: Analysis, shown: Sequence[tuple[ChannelAnalysis, tuple[str, ...]]], left_out: Sequence[str]
) -> str:
    """Return the page: what was analysed, then each channel's orders and figures.

    Parameters
    ----------
    analysis : Analysis
        What was found.
    shown : sequence
        Each channel with the names of its figures.
    left_out : sequence of str
        Figures that could not be drawn, with the reason.
    """
    rows = [f"# Analysis of {_plain(analysis.name)}", ""]
    if analysis.drive is None:
        rows.append("- No drive.")
    else:
        frequency, error = analysis.drive.frequency, analysis.drive.standard_error
        rows.append(f"- Drive {frequency:.7g} Hz, standard error {error:.2g} Hz.")
    if analysis.window is not None:
        window = analysis.window
        rows.append(f"- Window {window.start:.3f} to {window.stop:.3f} s ({_plain(window.reason)}).")
    rows.append(f"- Chance of one false line in a channel: {analysis.significance:.2g}.")
    rows += [f"- Natural frequency {n.frequency:.4g} Hz ({n.name})." for n in analysis.natural_frequencies]
    rows += [f"- Note: {_plain(note)}" for note in (*analysis.notes, *left_out)]
    for item, figures in shown:
        rows += ["", *_channel(item), *(f"\n![{name}]({name})" for name in figures)]
    return "\n".join((*rows, ""))


def _channel(item: ChannelAnalysis) -> list[str]:
    channel = item.channel
    name = channel.name if item.side == MEASURED else f"{channel.name} ({item.side})"
    rows = [f"## {_plain(name)}", ""]
    scale = scale_for(channel.kind, channel.unit)
    unit = f" [{scale.unit}]" if scale.unit else ""
    if item.lines is not None:
        heads = ("order", "frequency [Hz]", f"amplitude{unit}", f"95 %{unit}", f"significant above{unit}")
        rows.append(f"| {' | '.join((*heads, 'phase [rad]', 'verdict', 'reason'))} |")
        rows.append(f"|{' --- |' * 8}")
        rows += [_line(line, scale.factor) for line in item.lines.lines]
    elif item.peaks:
        rows += [f"| frequency [Hz] | amplitude{unit} | p | significant |", f"|{' --- |' * 4}"]
        rows += [
            f"| {peak.frequency:.5g} | {number(scale.factor * peak.amplitude)} | {number(peak.p_value, 2)} | "
            f"{'yes' if peak.significant else 'no'} |"
            for peak in item.peaks
        ]
    else:
        rows.append(f"No lines: {_plain(item.no_lines)}.")
    return rows


def _line(line: Line, factor: float) -> str:
    low, high = (number(factor * end) for end in line.interval)
    above = number(None if line.significant_above is None else factor * line.significant_above, 3)
    cells = (
        line.order,
        f"{line.frequency:.5g}",
        number(factor * line.amplitude),
        f"{low} to {high}",
        above,
        f"{line.phase:+.3f}",
        words(line.verdict.value),
        _plain(line.reason),
    )
    return f"| {' | '.join(cells)} |"


def _plain(text: str) -> str:
    """Return a text that ends no cell and begins no markup."""
    return " ".join(text.split()).replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;")
