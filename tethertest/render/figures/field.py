"""Tension along the cable over time, as replayed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, Normalize

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Window
from tethertest.records.response import Field
from tethertest.render.blocks import Picture
from tethertest.render.decimate import reduced_rows
from tethertest.render.figures.style import (
    COLORMAP,
    WIDE,
    cycles_blur,
    new_figure,
    picture,
    pixels,
    place,
    set_span,
    set_title,
)

_SLACK = "white"  #: apart from every colour of the map, in grey print too
_HEIGHT = 2.9  #: [inch]
_LEFT, _BOTTOM, _TOP = 0.62, 0.44, 0.3  #: margins [inch]
_GUTTER, _BAR, _BAR_SPACE = 0.55, 0.14, 0.95  #: [inch]


def field_map(field: Field, length: float, whole: Window, cycles: Window, frequency: float | None) -> Picture:
    """Return the map of the largest tension of each time bin, the whole run and some cycles.

    Parameters
    ----------
    field : Field
        Tension along the cable.
    length : float
        Length of the cable [m].
    whole, cycles : Window
        What the two panels show.
    frequency : float or None
        Drive frequency [Hz]; where cycles are too narrow to be drawn, a bin is a whole cycle.
    """
    figure = new_figure(WIDE, _HEIGHT)
    across = WIDE - _LEFT - _GUTTER - _BAR_SPACE
    up = _HEIGHT - _BOTTOM - _TOP
    panels = (
        place(figure, _LEFT, _BOTTOM, 0.5 * across, up),
        place(figure, _LEFT + 0.5 * across + _GUTTER, _BOTTOM, 0.5 * across, up),
    )
    norm = Normalize(float(np.nanmin(field.minimum)), float(np.nanmax(field.maximum)))
    slack = False
    for axes, window, title in zip(panels, (whole, cycles), ("Whole run", "Some cycles"), strict=True):
        bins = pixels(axes)
        if frequency is not None and cycles_blur(axes, window, frequency):
            bins = max(int(frequency * window.length), 1)
        slack |= _draw_map(axes, field, length, window, norm, bins)
        set_span(axes, window)
        set_title(axes, title)
        axes.set_xlabel("Time on the run's clock [s]")
    panels[0].set_ylabel("Place from the bottom [m]")
    bar_axes = place(figure, WIDE - _BAR_SPACE + 0.2, _BOTTOM, _BAR, up)
    bar = figure.colorbar(panels[0].images[0], cax=bar_axes)
    bar.set_label("Tension [N]")
    caption = "Replayed tension along the cable: the largest of each time bin." + (
        " White: slack, the tension fell to zero within the bin." if slack else " It never goes slack."
    )
    return picture(figure, caption, "Colour map of the replayed tension over time and place along the cable.")


def _draw_map(axes: Axes, field: Field, length: float, window: Window, norm: Normalize, bins: int) -> bool:
    first = max(int(np.searchsorted(field.time, window.start, "right")) - 1, 0)
    last = max(int(np.searchsorted(field.time, window.stop, "right")), first + 1)
    largest, starts = reduced_rows(field.maximum[first:last], bins, np.fmax)
    smallest, _ = reduced_rows(field.minimum[first:last], bins, np.fmin)
    time = _time_edges(field.time, first, last, starts)
    place_edges = length * _place_edges(field.position)
    axes.grid(visible=False)
    axes.pcolorfast(time, place_edges, largest.T, cmap=COLORMAP, norm=norm)
    slack = smallest <= 0.0
    if slack.any():
        axes.pcolorfast(
            time,
            place_edges,
            np.ma.masked_where(~slack.T, np.ones(slack.T.shape)),
            cmap=ListedColormap([_SLACK]),
        )
    axes.set_ylim(place_edges[0], place_edges[-1])
    return bool(slack.any())


def _time_edges(time: FloatArray, first: int, last: int, starts: np.ndarray) -> FloatArray:
    step = float(np.median(np.diff(time))) if time.size > 1 else 1.0
    end = time[last] if last < time.size else time[-1] + step
    return np.append(time[first:last][starts], end)


def _place_edges(position: FloatArray) -> FloatArray:
    middle = 0.5 * (position[1:] + position[:-1])
    ends = (0.0, 1.0) if position.size == 1 else (position[0], position[-1])
    return np.concatenate(([ends[0]], middle, [ends[1]]))
