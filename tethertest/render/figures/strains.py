"""The strain gratings as small multiples, from the top of the cable to its bottom."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from tethertest.records.channel import Window
from tethertest.render.blocks import Picture
from tethertest.render.figures.series import draw_detail, draw_overview
from tethertest.render.figures.style import WIDE, legend_above, new_figure, picture, place, set_title
from tethertest.render.scales import axis_label
from tethertest.render.selection import Pair

_ROW = 1.12  #: [inch]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.7, 0.12, 0.44, 0.3  #: margins [inch]
_GUTTER, _BETWEEN = 0.5, 0.28  #: [inch]
_OVERVIEW_SHARE = 0.5


def strain_overlays(pairs: Sequence[Pair], whole: Window, cycles: Window, frequency: float | None) -> Picture:
    """Return one row per grating: the whole run on the left, some cycles on the right.

    Parameters
    ----------
    pairs : sequence of Pair
        Gratings of which at least one channel is there; at least one of them.
    whole, cycles : Window
        What the two columns show.
    frequency : float or None
        Drive frequency [Hz].
    """
    height = _BOTTOM + _TOP + _ROW * len(pairs)
    figure = new_figure(WIDE, height)
    across = WIDE - _LEFT - _RIGHT - _GUTTER
    lefts = (_LEFT, _LEFT + _GUTTER + across * _OVERVIEW_SHARE)
    widths = (across * _OVERVIEW_SHARE, across * (1.0 - _OVERVIEW_SHARE))
    drawn: list[Axes] = []
    for i, pair in enumerate(pairs):
        bottom = height - _TOP - _ROW * (i + 1) + 0.06
        overview, detail = (
            place(figure, left, bottom, width, _ROW - _BETWEEN)
            for left, width in zip(lefts, widths, strict=True)
        )
        draw_overview(overview, pair, whole, frequency)
        draw_detail(detail, pair, cycles)
        for axes in (overview, detail):
            axes.xaxis.set_visible(i == len(pairs) - 1)  # ticks are what matplotlib takes its time for
            axes.yaxis.set_major_locator(MaxNLocator(4))
        drawn += [detail, overview]
        channel = pair.measured or pair.replayed
        if channel is not None:
            overview.set_ylabel(axis_label(channel))
        where = "" if pair.at is None else f", at {pair.at:g} of the length"
        set_title(overview, f"{pair.name}{where}")
    for axes in drawn[-2:]:
        axes.set_xlabel("Time on the run's clock [s]")
    legend_above(figure, *drawn, left=_LEFT + 3.0)
    caption = (
        f"Strain, change from rest: left the whole run, right {cycles.start:.2f} to {cycles.stop:.2f} s."
    )
    return picture(figure, caption, f"Measured and replayed strain of {len(pairs)} gratings over time.")
