"""Measured and replayed tension: some cycles, and the whole run below."""

from __future__ import annotations

from collections.abc import Sequence

from tethertest.records.channel import Window
from tethertest.records.lines import Event
from tethertest.render.blocks import Picture
from tethertest.render.figures.series import draw_detail, draw_overview, draw_slack
from tethertest.render.figures.style import (
    GREY,
    WIDE,
    legend_above,
    new_figure,
    picture,
    place,
)
from tethertest.render.scales import axis_label
from tethertest.render.selection import Pair

FIRST_SCREEN = (7.0, 4.0)  #: [inch]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.62, 0.12, 0.44, 0.36  #: margins [inch]
_BETWEEN = 0.36  #: [inch]
_OVERVIEW_SHARE = 0.34


def tension_overlay(
    pair: Pair,
    whole: Window,
    cycles: Window,
    slack: Sequence[Event],
    frequency: float | None,
    *,
    first_screen: bool = False,
) -> Picture:
    """Return the overlay of one load cell.

    Parameters
    ----------
    pair : Pair
        At least one of its channels must be there.
    whole, cycles : Window
        What the overview and the detail show.
    slack : sequence of Event
        Measured slack intervals; those of other channels are passed over.
    frequency : float or None
        Drive frequency [Hz].
    first_screen : bool
        Smaller, for the column beside the table of lines.
    """
    width, height = FIRST_SCREEN if first_screen else (WIDE, 3.6)
    figure = new_figure(width, height)
    across = width - _LEFT - _RIGHT
    up = height - _BOTTOM - _TOP - _BETWEEN
    low = place(figure, _LEFT, _BOTTOM, across, up * _OVERVIEW_SHARE)
    detail_height = up * (1.0 - _OVERVIEW_SHARE)
    high = place(figure, _LEFT, height - _TOP - detail_height, across, detail_height)
    draw_detail(high, pair, cycles)
    draw_overview(low, pair, whole, frequency)
    for axes in (high, low):
        draw_slack(axes, slack, pair.name)
        channel = pair.measured or pair.replayed
        if channel is not None:
            axes.set_ylabel(axis_label(channel))
    low.axvspan(cycles.start, cycles.stop, facecolor="none", edgecolor=GREY, linewidth=1.0)
    low.set_xlabel("Time on the run's clock [s]")
    legend_above(figure, high, low, left=_LEFT)
    caption = (
        f"{pair.name}: above, {cycles.start:.2f} to {cycles.stop:.2f} s; below, the whole run, "
        "with that span framed."
    )
    shown = " and ".join(
        word for word, channel in (("measured", pair.measured), ("replayed", pair.replayed)) if channel
    )
    return picture(figure, caption, f"Time series of {shown} tension at {pair.name}, detail and whole run.")
