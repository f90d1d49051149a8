"""Measured against replayed, number by number, and the events."""

from __future__ import annotations

from tethertest.records.comparison import Metric, Verdict
from tethertest.records.lines import Event
from tethertest.records.report import Report
from tethertest.render.blocks import (
    Block,
    Cell,
    Facts,
    Section,
    Sentence,
    Table,
    columns,
    row,
    table_or_sentence,
    texts,
)
from tethertest.render.scales import channel_scale
from tethertest.render.text import ABSENT, fixed, number, percent, words

EVENTS_SHOWN = 24
#: heading -> metric of the table of strains
_STRAIN_COLUMNS = (
    ("Amplitude of order 1", "order_amplitude 1"),
    ("Amplitude of order 2", "order_amplitude 2"),
    ("Phase of order 1", "order_phase 1"),
    ("Sprague-Geers", "sprague_geers"),
)
_NAMES = {"sprague_geers": "Sprague-Geers"}


def metrics_section(report: Report) -> Section:
    """Return the metrics and all reasons of the verdict."""
    table = Table(
        "Measured against replayed",
        columns(
            "Metric",
            "Channel",
            "#Measured",
            "#Replayed",
            "#Error",
            "#Standard uncertainty",
            "#Limit",
            "Verdict",
            "Why",
        ),
        tuple(
            _metric_row(report, metric)
            for metric in report.comparison.metrics
            if not _is_strain(report, metric)
        ),
    )
    absent = "No metrics: there was nothing to compare, for want of a measured or a replayed channel."
    blocks: list[Block] = [table_or_sentence(table, absent)]
    strains = tuple(dict.fromkeys(m.channel for m in report.comparison.metrics if _is_strain(report, m)))
    if strains:
        rows = tuple(_strain_row(report, channel) for channel in strains)
        headings = columns("Channel", *(f"#{heading}" for heading, _ in _STRAIN_COLUMNS))
        blocks.append(
            Table("Strains, for information: error of the replay ± standard uncertainty", headings, rows)
        )
    blocks += texts(report.comparison.reasons, "Reasons of the verdict")
    return Section("metrics", "Metrics", tuple(blocks))


def _is_strain(report: Report, metric: Metric) -> bool:
    channel = report.measured.channel(metric.channel)
    return channel is not None and channel.kind == "strain"


def _strain_row(report: Report, channel: str) -> tuple[Cell, ...]:
    metrics = {metric.name: metric for metric in report.comparison.metrics if metric.channel == channel}
    cells: list[str | Cell] = [channel]
    for _, name in _STRAIN_COLUMNS:
        metric = metrics.get(name)
        if metric is None or not metric.uncertainty:
            cells.append(ABSENT)
        elif metric.unit == "rad":
            cells.append(f"{metric.error:+.4f} ± {metric.uncertainty:.4f} rad")
        else:
            cells.append(f"{percent(metric.error, signed=True)} ± {percent(metric.uncertainty)}")
    return row(*cells)


def _metric_row(report: Report, metric: Metric) -> tuple[Cell, ...]:
    scale = channel_scale(report, metric.channel, metric.unit)
    relative = metric.unit != "rad"

    def value(found: float | None) -> str:
        if found is None:
            return ABSENT
        return f"{number(scale.difference(found))} {scale.unit}".strip()

    def error(found: float | None, *, signed: bool = False) -> str:
        if found is None or relative:
            return percent(found, signed=signed)
        return f"{fixed(found, 4)} rad" if number(found) != ABSENT else ABSENT

    tone = "quiet" if metric.verdict is Verdict.INFORMATIVE else metric.verdict.value
    return row(
        metric_name(metric.name),
        metric.channel,
        value(metric.measured),
        value(metric.replayed),
        error(metric.error, signed=True),
        error(metric.uncertainty),
        error(metric.limit),
        Cell(metric.verdict.value, metric.reason, tone, badge=True),
        Cell(metric.reason, tone="prose"),
    )


def metric_name(key: str) -> str:
    """Return a metric's name for people: ``order_amplitude 1/2`` is "Amplitude of order 1/2"."""
    base, _, order = key.partition(" ")
    if base.startswith("order_") and order:
        return f"{words(base.removeprefix('order_')).capitalize()} of order {order}"
    name = _NAMES.get(base, words(base).capitalize())
    return f"{name} {order}".strip()


def events_section(report: Report) -> Section:
    """Return slack intervals and snaps, measured and replayed."""
    events = [*((event, "measured") for event in report.events)]
    events += [(event, "replayed") for event in report.replayed_events]
    if not events:
        absent = "No events: the cable was taut throughout, in the test and in the replay."
        if report.response is None:
            absent = "No events were found in the test; nothing was replayed."
        return Section("events", "Events", (Sentence(absent),))
    events.sort(key=lambda pair: (pair[0].start, pair[0].channel, pair[1]))
    rows = tuple(
        row(
            event.kind,
            event.channel,
            side,
            fixed(event.start, 3),
            fixed(event.stop, 3),
            fixed(1e3 * (event.stop - event.start), 0),
            number(event.value),
        )
        for event, side in events[:EVENTS_SHOWN]
    )
    headings = columns(
        "Kind",
        "Channel",
        "Side",
        "#From [s]",
        "#To [s]",
        "#Lasts [ms]",
        "#Lowest or peak tension [N]",
    )
    blocks: list[Block] = [_event_counts(report), Table("Slack intervals and snaps", headings, rows)]
    if len(events) > EVENTS_SHOWN:
        text = f"{len(events) - EVENTS_SHOWN} more events are in summary.json."
        blocks.append(Sentence(text, "plain"))
    return Section("events", "Events", tuple(blocks))


def _event_counts(report: Report) -> Facts:
    return Facts(
        "How many",
        tuple(
            (side, _counted(events) or "none")
            for side, events in (("measured", report.events), ("replayed", report.replayed_events))
        ),
    )


def _counted(events: tuple[Event, ...]) -> str:
    counts: dict[tuple[str, str], int] = {}
    for event in events:
        key = (event.kind, event.channel)
        counts[key] = counts.get(key, 0) + 1
    return "; ".join(f"{count} {kind} at {channel}" for (kind, channel), count in sorted(counts.items()))
