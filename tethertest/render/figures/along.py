"""Largest and smallest tension along the cable: replayed curves, measured points (the paper's Fig. 15)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.response import Response
from tethertest.render.blocks import Picture
from tethertest.render.figures.style import (
    BLACK,
    REPLAYED,
    WIDE,
    legend_above,
    new_figure,
    picture,
    place,
)
from tethertest.render.selection import Pair
from tethertest.render.text import COVERAGE_95

_HEIGHT = 3.2  #: [inch]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.62, 0.12, 0.44, 0.3  #: margins [inch]


@dataclass(frozen=True, slots=True)
class _Point:
    place: float  #: fraction of the length
    smallest: float  #: [N]
    largest: float  #: [N]
    spread: float  #: relative half width of the 95 % interval


def along_figure(
    cells: Sequence[Pair], gratings: Sequence[Pair], response: Response, window: Window
) -> Picture:
    """Return the figure; gratings enter as axial stiffness times strain on top of the tension at rest.

    Parameters
    ----------
    cells, gratings : sequence of Pair
        Load cells and gratings; those without a measured channel or a place are left out.
    response : Response
        Its field gives the curves, its first sample the tension at rest.
    window : Window
        Where the extremes are taken.
    """
    cable = response.scene.cable
    points = [_cell_point(pair.measured, window) for pair in cells if pair.measured]
    strained = []
    if cable.axial_stiffness is not None:
        strained = [
            _grating_point(pair.measured, window, response, cable.axial_stiffness)
            for pair in gratings
            if pair.measured
        ]
    figure = new_figure(WIDE, _HEIGHT)
    axes = place(figure, _LEFT, _BOTTOM, WIDE - _LEFT - _RIGHT, _HEIGHT - _BOTTOM - _TOP)
    _draw_curves(axes, response, window, cable.length)
    _draw_points(axes, [point for point in points if point], cable.length, "s", "load cell")
    _draw_points(axes, [point for point in strained if point], cable.length, "o", "grating, EA × strain")
    axes.set_xlabel("Place from the bottom [m]")
    axes.set_ylabel("Tension [N]")
    legend_above(figure, axes, left=_LEFT)
    caption = (
        f"Largest (filled) and smallest (open) tension from {window.start:.2f} to {window.stop:.2f} s. "
        "Bars: 95 % of the calibration. Gratings: axial stiffness times strain, "
        "on top of the replayed tension at rest."
    )
    return picture(figure, caption, "Largest and smallest tension against place along the cable.")


def _draw_curves(axes: Axes, response: Response, window: Window, length: float) -> None:
    field = response.field
    inside = (field.time >= window.start) & (field.time <= window.stop)
    if not inside.any():
        inside = np.ones(field.time.shape, dtype=np.bool_)
    where = length * field.position
    axes.plot(where, field.maximum[inside].max(axis=0), label="replayed, largest", **REPLAYED)
    lower = {**REPLAYED, "linestyle": ":"}
    axes.plot(where, field.minimum[inside].min(axis=0), label="replayed, smallest", **lower)


def _draw_points(axes: Axes, points: list[_Point], length: float, marker: str, label: str) -> None:
    if not points:
        return
    where = np.array([point.place for point in points]) * length
    spread = np.array([point.spread for point in points])
    for values, fill, name in (
        (np.array([point.largest for point in points]), BLACK, f"measured, {label}"),
        (np.array([point.smallest for point in points]), "white", None),
    ):
        axes.errorbar(
            where,
            values,
            yerr=np.abs(values) * spread,
            linestyle="none",
            marker=marker,
            markersize=6,
            color=BLACK,
            markerfacecolor=fill,
            elinewidth=1.0,
            capsize=3,
            label=name,
        )


def _cell_point(channel: Channel, window: Window) -> _Point | None:
    return _point(channel, window, 0.0, 1.0)


def _grating_point(
    channel: Channel, window: Window, response: Response, axial_stiffness: float
) -> _Point | None:
    if channel.at is None or response.time.size == 0:
        return None
    at_rest = float(np.interp(channel.at, response.gauges, response.tension[0]))
    return _point(channel, window, at_rest, axial_stiffness)


def _point(channel: Channel, window: Window, base: float, factor: float) -> _Point | None:
    inside = channel.between(window.start, window.stop)
    values: FloatArray = base + factor * inside.values[inside.usable]
    if channel.at is None or values.size == 0:
        return None
    return _Point(channel.at, float(values.min()), float(values.max()), COVERAGE_95 * channel.uncertainty)
