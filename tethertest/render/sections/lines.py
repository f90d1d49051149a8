"""The lines of the measured channels beside those of the replay."""

from __future__ import annotations

from statistics import median

from tethertest.records.lines import ChannelLines, Line, LineVerdict
from tethertest.records.report import Report
from tethertest.render.blocks import Block, Cell, Section, Sentence, Table, columns, row
from tethertest.render.scales import Scale, channel_scale
from tethertest.render.text import ABSENT, decimals_for, fixed, number, span, words

_P_VALUE_FLOOR = 1e-12  #: smaller ones say nothing more
_QUIET = {LineVerdict.NONE}
_DOUBTFUL = {LineVerdict.NOT_RESOLVABLE, LineVerdict.UNDETERMINED, LineVerdict.ALIAS, LineVerdict.LEAKAGE}


def lines_section(report: Report) -> Section:
    """Return the lines of every channel in full."""
    blocks: list[Block] = [_full_table(report, lines) for lines in report.measured_lines]
    absent = "No lines: no drive frequency was found, or no channel could be analysed."
    return Section("lines", "Lines of every channel", tuple(blocks) or (Sentence(absent),))


def line_table(report: Report, channel: str) -> Block:
    """Return the short table of one channel for the first screen."""
    found = next((lines for lines in report.measured_lines if lines.channel == channel), None)
    if found is None:
        return Sentence(f"No lines of {channel}: it was not measured, or no drive was found in it.")
    scale = channel_scale(report, found.channel, found.unit)
    replayed, finest = _replayed(report, channel), _finest(found, scale)
    rows = tuple(
        row(
            line.order,
            _frequency(line),
            *_amplitudes(line, replayed, scale, finest),
            _verdict(line, badge=True),
        )
        for line in sorted(found.lines, key=lambda line: line.frequency)
    )
    unit = f" [{scale.unit}]" if scale.unit else ""
    return Table(
        f"Lines of {channel}",
        columns("Order", "#f [Hz]", f"#Measured{unit}", "#95 %", f"#Replayed{unit}", "Verdict"),
        rows,
        "dense",
    )


def _full_table(report: Report, lines: ChannelLines) -> Table:
    scale = channel_scale(report, lines.channel, lines.unit)
    replayed, finest = _replayed(report, lines.channel), _finest(lines, scale)
    rows = tuple(
        row(
            line.order,
            _frequency(line),
            *_amplitudes(line, replayed, scale, finest),
            fixed(line.phase, 3),
            p_value(line.p_value),
            _verdict(line),
            Cell(line.reason, tone="prose"),
        )
        for line in sorted(lines.lines, key=lambda line: line.frequency)
    )
    unit = f" [{scale.unit}]" if scale.unit else ""
    left_out = f", {lines.left_out} flagged samples left out" if lines.left_out else ""
    caption = (
        f"{lines.channel}: {span(lines.window.start, lines.window.stop)}, {lines.samples} samples{left_out}"
    )
    headings = columns(
        "Order",
        "#f [Hz]",
        f"#Measured{unit}",
        "#95 %",
        f"#Replayed{unit}",
        "#Phase [rad]",
        "#p",
        "Verdict",
        "Why",
    )
    return Table(caption, headings, rows)


def p_value(value: float) -> str:
    """Return a p-value; below 1e-12 it is only said to be below."""
    return "< 10⁻¹²" if value < _P_VALUE_FLOOR else number(value, 2)


def _replayed(report: Report, channel: str) -> ChannelLines | None:
    return next((lines for lines in report.replayed_lines if lines.channel == channel), None)


def _frequency(line: Line) -> str:
    return fixed(line.frequency, 4)


def _finest(lines: ChannelLines, scale: Scale) -> int:
    """Return the decimals that no line of the table exceeds."""
    halves = [0.5 * scale.difference(line.interval[1] - line.interval[0]) for line in lines.lines]
    return decimals_for(median(halves)) if halves else 0


def _amplitudes(line: Line, replayed: ChannelLines | None, scale: Scale, finest: int) -> tuple[str, str, str]:
    """Return measured amplitude, its interval and replayed amplitude, to the interval's second digit."""
    low, high = (scale.difference(end) for end in line.interval)
    decimals = min(decimals_for(0.5 * (high - low)), finest)
    other = None if replayed is None else replayed.line(line.order)
    return (
        fixed(scale.difference(line.amplitude), decimals),
        f"{fixed(low, decimals)} to {fixed(high, decimals)}",
        ABSENT if other is None else fixed(scale.difference(other.amplitude), decimals),
    )


def _verdict(line: Line, *, badge: bool = False) -> Cell:
    tone = "quiet" if line.verdict in _QUIET else "doubtful" if line.verdict in _DOUBTFUL else "strong"
    return Cell(words(line.verdict.value), line.reason, tone, badge)
