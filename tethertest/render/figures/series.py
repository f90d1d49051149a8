"""A measured and a replayed series on one pair of axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import blended_transform_factory

from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import Event, EventKind
from tethertest.render.decimate import envelope, extreme_indices
from tethertest.render.figures.style import (
    BLUE,
    CROWDED,
    CYCLE_PIXELS,
    FLAGGED,
    MEASURED,
    REPLAYED,
    SLACK,
    cycles_blur,
    pixels,
    set_limits,
    set_span,
)
from tethertest.render.scales import scale_for
from tethertest.render.selection import Pair

Style: TypeAlias = dict[str, Any]
_FLAG_BAR = (1.02, 0.03)  #: bottom and height of the bar of flagged samples, as parts of the axes' height


def draw_detail(axes: Axes, pair: Pair, window: Window) -> None:
    """Draw both series of a sensor within a window, flagged samples marked; set both axes' limits."""
    _draw_pair(axes, pair, window, MEASURED, REPLAYED, outline=False)


def draw_overview(axes: Axes, pair: Pair, window: Window, frequency: float | None) -> None:
    """Draw the same with thin lines; where cycles become too narrow, the replayed ones as their outline."""
    outline = cycles_blur(axes, window, frequency)
    _draw_pair(axes, pair, window, {**MEASURED, **CROWDED}, {**REPLAYED, **CROWDED}, outline=outline)


def _draw_pair(axes: Axes, pair: Pair, window: Window, solid: Style, dashed: Style, *, outline: bool) -> None:
    measured = None if pair.measured is None else pair.measured.between(window.start, window.stop)
    replayed = None if pair.replayed is None else pair.replayed.between(window.start, window.stop)
    ends = [np.inf, -np.inf]
    if measured is not None:
        _widen(ends, _draw_line(axes, measured, "measured", solid))
    if replayed is not None:
        draw = _draw_outline if outline else _draw_line
        _widen(ends, draw(axes, replayed, "replayed", dashed))
    if ends[0] > ends[1]:
        axes.text(0.5, 0.5, "no usable sample here", transform=axes.transAxes, ha="center", va="center")
    set_limits(axes, *ends)
    set_span(axes, window)
    if measured is not None:
        _mark_flagged(axes, measured)


def draw_slack(axes: Axes, events: Sequence[Event], channel: str) -> None:
    """Shade the slack intervals of a channel."""
    slack = [event for event in events if event.kind == EventKind.SLACK and event.channel == channel]
    if slack:
        bars = [(event.start, event.stop - event.start) for event in slack]
        across = blended_transform_factory(axes.transData, axes.transAxes)
        axes.broken_barh(bars, (0.0, 1.0), transform=across, zorder=0.5, label="slack (measured)", **SLACK)


def _draw_line(axes: Axes, channel: Channel, label: str, style: Style) -> FloatArray:
    values = _shown(channel)
    keep = extreme_indices(channel.time, values, pixels(axes))
    axes.plot(channel.time[keep], values[keep], label=label, **style)
    return values


def _draw_outline(axes: Axes, channel: Channel, label: str, style: Style) -> FloatArray:
    values = _shown(channel)
    if values.size:
        time, least, greatest = envelope(channel.time, values, pixels(axes) // CYCLE_PIXELS)
        axes.plot(time, greatest, label=label, **{**style, "linewidth": 1.4})
        axes.plot(time, least, **{**style, "linewidth": 1.4})
    return values


def _shown(channel: Channel) -> FloatArray:
    scale = scale_for(channel.kind, channel.unit)
    return np.where(channel.usable, scale.values(channel.values), np.nan)


def _mark_flagged(axes: Axes, channel: Channel) -> None:
    flagged: BoolArray = channel.flags != 0
    if not flagged.any():
        return
    _mark_spans(axes, channel.time, flagged)
    scale = scale_for(channel.kind, channel.unit)
    unusable = ~channel.usable & np.isfinite(channel.values)
    if unusable.any():
        time = channel.time[unusable]
        shown = np.clip(scale.values(channel.values[unusable]), *axes.get_ylim())
        keep = extreme_indices(time, shown, pixels(axes) // 8)
        axes.plot(time[keep], shown[keep], label="flagged, not used", zorder=4, clip_on=False, **FLAGGED)


def _mark_spans(axes: Axes, time: FloatArray, flagged: BoolArray) -> None:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flagged.astype(np.int8), [0]))))
    begins, ends = time[edges[::2]], time[edges[1::2] - 1]
    least = 2.0 * (axes.get_xlim()[1] - axes.get_xlim()[0]) / pixels(axes)  # a single sample stays visible
    apart = np.flatnonzero(begins[1:] > ends[:-1] + least) if begins.size > 1 else np.empty(0, np.intp)
    begins = begins[np.concatenate(([0], apart + 1))]
    ends = ends[np.concatenate((apart, [ends.size - 1]))]
    across = blended_transform_factory(axes.transData, axes.transAxes)
    bars = [(float(a), float(max(b - a, least))) for a, b in zip(begins, ends, strict=True)]
    axes.broken_barh(
        bars,
        _FLAG_BAR,
        transform=across,
        facecolor=BLUE,
        edgecolor="none",
        clip_on=False,
        label="flagged (bar above)",
    )


def _widen(ends: list[float], values: FloatArray) -> None:
    finite = values[np.isfinite(values)]
    if finite.size:
        ends[0] = min(ends[0], float(finite.min()))
        ends[1] = max(ends[1], float(finite.max()))
