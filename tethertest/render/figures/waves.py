"""Dynamic tension over time and place, its crest, and what a sweep of the drive does to both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes

from tethertest.records.arrays import FloatArray
from tethertest.render.blocks import Picture
from tethertest.render.figures.style import (
    BLACK,
    BLUE,
    COLORMAP,
    GREY,
    RC,
    SKY,
    VERMILLION,
    WIDE,
    new_figure,
    picture,
    place,
    set_title,
)

#: margins, panel and gaps of the maps [inch]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.62, 0.95, 0.5, 0.54
_PANEL, _GAP, _ROW_GAP = 1.75, 0.3, 0.68
#: periods of the drive around the largest tension
_PERIODS: Final = 3.0
#: models and cases, told apart in grey print too
_STYLES: Final[tuple[dict[str, Any], ...]] = (
    {"color": VERMILLION, "marker": "s", "linestyle": "--"},
    {"color": BLUE, "marker": "o", "linestyle": "-"},
    {"color": BLACK, "marker": "^", "linestyle": ":"},
    {"color": SKY, "marker": "D", "linestyle": "-."},
)


@dataclass(frozen=True, slots=True, eq=False)
class WaveMap:
    """Dynamic tension over time and place."""

    model: str  #: title of its row
    frequency: float  #: of the drive [Hz]
    time: FloatArray  #: (n,) [s]
    place: FloatArray  #: (m,) fraction of the length from the bottom
    tension: FloatArray  #: (n, m) [N]
    largest_place: float
    largest_time: float  #: [s]
    crest: FloatArray  #: (n,) place of the largest tension of each instant


@dataclass(frozen=True, slots=True)
class StartedCurve:
    """One model over the drive's frequency."""

    name: str
    frequency: Sequence[float]  #: [Hz]
    place: Sequence[float]  #: of the largest tension
    middle: Sequence[float]  #: largest in the middle over the largest at an end
    share: Sequence[float]  #: that one shape holds


@dataclass(frozen=True, slots=True)
class SettledCurve:
    """One kind of loss over the drive's frequency."""

    name: str
    frequency: Sequence[float]  #: [Hz]
    ratio: Sequence[float]  #: energy of the weaker wave over that of the stronger; NaN: not settled


def map_figure(maps: Sequence[WaveMap], columns: int) -> Picture:
    """Return the maps of whole records, row by row, the largest tension marked (the article's Fig. 8)."""
    return _maps(maps, columns, whole=True)


def crest_figure(maps: Sequence[WaveMap], columns: int) -> Picture:
    """Return the maps around the largest tension, with the place of the largest of each instant."""
    return _maps(maps, columns, whole=False)


def _maps(maps: Sequence[WaveMap], columns: int, *, whole: bool) -> Picture:
    rows = len(maps) // columns
    height = _BOTTOM + _TOP + rows * _PANEL + (rows - 1) * _ROW_GAP
    width = (WIDE - _LEFT - _RIGHT - (columns - 1) * _GAP) / columns
    with rc_context(RC):  # type: ignore[arg-type]
        figure = new_figure(WIDE, height)
        for number, one in enumerate(maps):
            row, column = divmod(number, columns)
            left = _LEFT + column * (width + _GAP)
            bottom = _BOTTOM + (rows - 1 - row) * (_PANEL + _ROW_GAP)
            axes = place(figure, left, bottom, width, _PANEL)
            image = _draw(axes, one, whole=whole)
            if column == 0:
                axes.set_ylabel("Place from the bottom [1]")
                figure.text(
                    _LEFT / WIDE, (bottom + _PANEL + 0.3) / height, one.model.capitalize(), fontsize=9.0
                )
            else:
                axes.set_yticklabels([])
            if row == rows - 1:
                axes.set_xlabel("Time [s]")
        bar_axes = place(figure, WIDE - _RIGHT + 0.15, _BOTTOM, 0.14, height - _BOTTOM - _TOP)
        bar = figure.colorbar(image, cax=bar_axes, ticks=[-1.0, 0.0, 1.0])
        bar.ax.set_yticklabels(["-A", "0", "A"])
        bar.set_label("Dynamic tension; A is in each title [N]")
    span = "whole record" if whole else f"{_PERIODS:g} periods of the drive around the largest tension"
    caption = f"Dynamic tension over time and place, {span}; the largest is marked by a star."
    return picture(figure, caption, "Colour maps of the tension over time and place.")


def _draw(axes: Axes, one: WaveMap, *, whole: bool) -> Any:
    first, last = float(one.time[0]), float(one.time[-1])
    if not whole:
        half = 0.5 * _PERIODS / one.frequency
        middle = min(max(one.largest_time, first + half), last - half)
        first, last = middle - half, middle + half
    inside = (one.time >= first) & (one.time <= last)
    shown = one.tension[inside]
    size = float(np.max(np.abs(shown)))
    axes.grid(visible=False)
    image = axes.pcolormesh(
        one.time[inside],
        one.place,
        shown.T / size,
        cmap=COLORMAP,
        vmin=-1.0,
        vmax=1.0,
        shading="nearest",
        rasterized=True,
    )
    if not whole:
        axes.plot(one.time[inside], one.crest[inside], ".", color="white", markersize=1.8)
    axes.plot(
        one.largest_time,
        one.largest_place,
        "*",
        color=VERMILLION,
        markeredgecolor="white",
        markersize=12,
        clip_on=False,
        zorder=5,
    )
    axes.set_xlim(first, last)
    axes.set_ylim(0.0, 1.0)
    largest = float(one.tension.max())
    _title(axes, f"{one.frequency:.2f} Hz, A = {size:.3g} N", 0.0)
    _title(axes, f"largest {largest:.3g} N", 1.0)
    return image


def _title(axes: Axes, text: str, at: float) -> None:
    """Put a title above a panel, clear of a star on its edge."""
    axes.annotate(
        text,
        (at, 1.0),
        xycoords="axes fraction",
        xytext=(0.0, 7.0),
        textcoords="offset points",
        ha="right" if at else "left",
        va="bottom",
        fontweight="bold",
    )


def sweep_figure(
    started: Sequence[StartedCurve], settled: Sequence[SettledCurve], naturals: FloatArray
) -> Picture:
    """Return place of the largest tension, its share in the middle, shapes and energies over the drive.

    Parameters
    ----------
    started : sequence of StartedCurve
        From the article's start.
    settled : sequence of SettledCurve
        After it has died away.
    naturals : (k,) float64
        Natural frequencies, drawn as lines [Hz].
    """
    panel, gap, left, right, bottom, top, width = 1.8, 0.62, 0.75, 1.2, 0.5, 0.3, 8.5
    height = bottom + top + 4 * panel + 3 * gap
    with rc_context(RC):  # type: ignore[arg-type]
        figure = new_figure(width, height)
        axes = [
            place(figure, left, bottom + number * (panel + gap), width - left - right, panel)
            for number in (3, 2, 1, 0)
        ]
        for number, curve in enumerate(started):
            style = {**_STYLES[number], "markersize": 4.0, "linewidth": 1.2, "label": curve.name}
            axes[0].plot(curve.frequency, curve.place, **style)
            axes[1].plot(curve.frequency, curve.middle, **style)
            axes[2].plot(curve.frequency, curve.share, **style)
        for number, loss in enumerate(settled):
            style = {**_STYLES[number], "markersize": 4.0, "linewidth": 1.2, "label": loss.name}
            axes[3].plot(loss.frequency, loss.ratio, **style)
        axes[1].axhline(1.0, color=GREY, linewidth=0.8, linestyle="--")
        axes[3].axhline(1.0 / 3.0, color=GREY, linewidth=0.8, linestyle="--")
        labels = (
            ("Place [1]", "From the article's start: place of the largest tension, from the bottom"),
            ("Middle over ends [1]", "From the article's start: largest in the middle over that at the ends"),
            ("Share [1]", "From the article's start: share of F(s, t) that one shape holds"),
            (
                "Energy ratio [1]",
                "Settled (gaps: not yet): axial waves at the bottom, weaker over stronger (dashed: 1/3)",
            ),
        )
        for one, (label, title) in zip(axes, labels, strict=True):
            for natural in naturals:
                one.axvline(float(natural), color=GREY, linewidth=0.8, linestyle=":")
            one.set_ylabel(label)
            set_title(one, title)
            one.set_xlim(min(started[0].frequency) - 0.005, max(started[0].frequency) + 0.005)
        axes[3].set_xlabel("Drive frequency [Hz]; dotted: natural frequencies")
        for one in (axes[0], axes[3]):
            one.set_ylim(-0.04, 1.04)
            one.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        caption = "Place of the largest tension, middle over ends, share of one shape and energy ratio."
        return picture(figure, caption, "Four panels of curves over the drive frequency.")
