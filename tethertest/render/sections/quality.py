"""The audit: findings, flags, windows, clocks, and what a person decided by hand."""

from __future__ import annotations

from tethertest.records.channel import Channel, Finding, Severity, Window
from tethertest.records.report import Report
from tethertest.render.blocks import (
    Block,
    Cell,
    Section,
    Table,
    columns,
    row,
    table_or_sentence,
    texts,
)
from tethertest.render.scales import scale_for
from tethertest.render.text import ABSENT, COVERAGE_95, fixed, number, percent, plus_minus, span, words

SPANS_SHOWN = 4
#: the weightiest first
_TONES = {Severity.FATAL: "fail", Severity.WARNING: "undecided", Severity.NOTE: "quiet"}


def quality_section(report: Report) -> Section:
    """Return the quality and clock audit."""
    measured = report.measured
    blocks: tuple[Block, ...] = (
        table_or_sentence(_findings_table(measured.findings), "The audit found nothing to report."),
        table_or_sentence(
            _clock_table(report), "No clock was fitted: all logs share one clock, or none could be."
        ),
        *texts(
            [f"{clock.clock}: {remark}" for clock in measured.clocks for remark in clock.remarks],
            "Remarks on the clocks",
        ),
        table_or_sentence(_channel_table(measured.channels), "No channel could be used."),
        _windows_table(report),
        *texts(_by_hand(report), "Decided by hand in run.toml"),
    )
    return Section("quality", "Quality and clocks", blocks)


def _findings_table(findings: tuple[Finding, ...]) -> Table:
    ordered = sorted(findings, key=lambda finding: list(_TONES).index(finding.severity))
    rows = tuple(
        row(
            Cell(finding.severity, tone=_TONES[finding.severity], badge=True),
            finding.subject,
            words(finding.kind),
            Cell(finding.text, tone="prose"),
            _spans(finding),
            str(finding.samples) if finding.samples else ABSENT,
        )
        for finding in ordered
    )
    return Table("Findings", columns("Severity", "Subject", "Kind", "What", "When", "#Samples"), rows)


def _spans(finding: Finding) -> str:
    shown = "; ".join(span(*each) for each in finding.spans[:SPANS_SHOWN])
    more = len(finding.spans) - SPANS_SHOWN
    return (f"{shown}; and {more} more" if more > 0 else shown) or ABSENT


def _clock_table(report: Report) -> Table:
    rows = tuple(
        row(
            clock.clock,
            clock.reference,
            plus_minus(1e3 * clock.offset, 1e3 * COVERAGE_95 * clock.offset_error),
            plus_minus(1e6 * clock.drift, 1e6 * COVERAGE_95 * clock.drift_error),
            Cell(clock.method, tone="prose"),
        )
        for clock in report.measured.clocks
    )
    headings = columns("Clock", "Against", "#Offset ± 95 % [ms]", "#Drift ± 95 % [ppm]", "Aligned by")
    return Table("Clocks: offset at reference time zero and drift", headings, rows)


def _channel_table(channels: tuple[Channel, ...]) -> Table:
    rows = tuple(_channel_row(channel) for channel in channels)
    headings = columns(
        "Channel",
        "Kind",
        "#Rate [Hz]",
        "#Samples",
        "When",
        "#Noise of a sample",
        "#Scale uncertainty",
        "Flags",
    )
    return Table("Channels and their flags (noise and scale: standard uncertainty)", headings, rows)


def _channel_row(channel: Channel) -> tuple[Cell, ...]:
    scale = scale_for(channel.kind, channel.unit)
    size = channel.time.size
    flags = "; ".join(
        f"{words(name)} {count} ({percent(count / size)})" for name, count in channel.flag_counts().items()
    )
    noise = f"{number(scale.difference(channel.noise), 2)} {scale.unit}" if channel.noise else ABSENT
    return row(
        channel.name,
        channel.kind,
        f"{channel.rate:.4g}",
        str(size),
        span(float(channel.time[0]), float(channel.time[-1])) if size else ABSENT,
        noise.strip(),
        percent(channel.uncertainty) if channel.uncertainty else ABSENT,
        Cell(flags or "none", tone="strong" if flags else "quiet"),
    )


def _windows_table(report: Report) -> Table:
    measured = report.measured
    rows = tuple(
        _window_row(name, window)
        for name, window in (
            ("Rest before", measured.rest_before),
            ("Steady", measured.steady),
            ("Rest after", measured.rest_after),
        )
    )
    return Table("Windows", columns("Window", "When", "#Length [s]", "Chosen"), rows)


def _window_row(name: str, window: Window | None) -> tuple[Cell, ...]:
    if window is None:
        return row(name, Cell("none was found", tone="strong"), ABSENT, ABSENT)
    return row(name, span(window.start, window.stop), fixed(window.length, 2), window.reason)


def _by_hand(report: Report) -> list[str]:
    file = report.run.file
    texts_found = [
        f"{exclude.channel}, {span(*exclude.span)} left out: {exclude.reason}" for exclude in file.exclude
    ]
    texts_found += [
        f"clock {clock} set to {number(1e3 * offset.value, 6)} ms: {offset.reason}"
        for clock, offset in sorted(file.override.clock_offset.items())
    ]
    if file.windows.reason:
        texts_found.append(f"windows: {file.windows.reason}")
    return texts_found
