"""Dynamic tension over time and place, its crest, and what a sweep of the drive does to both."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes

from reports.wave_energy.cases import FIGURE_8
from reports.wave_energy.maps import MODELS, TensionMap, crest, largest
from reports.wave_energy.orders import SettledRun
from reports.wave_energy.sweep import Sweep
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


def map_figure(maps: Sequence[TensionMap]) -> Picture:
    """Return the maps of whole records, row by row, the largest tension marked (the article's Fig. 8)."""
    return _maps(maps, whole=True)


def crest_figure(maps: Sequence[TensionMap]) -> Picture:
    """Return the maps around the largest tension, with the place of the largest of each instant."""
    return _maps(maps, whole=False)


def _maps(maps: Sequence[TensionMap], *, whole: bool) -> Picture:
    """Draw one row a model, one column a frequency of Fig. 8."""
    columns = len(FIGURE_8)
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
                    _LEFT / WIDE,
                    (bottom + _PANEL + 0.3) / height,
                    MODELS[one.model].capitalize(),
                    fontsize=9.0,
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


def _draw(axes: Axes, one: TensionMap, *, whole: bool) -> Any:
    top = largest(one)
    first, last = float(one.time[0]), float(one.time[-1])
    if not whole:
        half = 0.5 * _PERIODS / one.frequency
        middle = min(max(top.time, first + half), last - half)
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
        axes.plot(one.time[inside], crest(one)[inside], ".", color="white", markersize=1.8)
    axes.plot(
        top.time,
        top.place,
        "*",
        color=VERMILLION,
        markeredgecolor="white",
        markersize=12,
        clip_on=False,
        zorder=5,
    )
    axes.set_xlim(first, last)
    axes.set_ylim(0.0, 1.0)
    _title(axes, f"{one.frequency:.2f} Hz, A = {size:.3g} N", 0.0)
    _title(axes, f"largest {float(one.tension.max()):.3g} N", 1.0)
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


def sweep_figure(sweep: Sweep) -> Picture:
    """Return place of the largest tension, its share in the middle, shapes and energies over the drive."""
    started = {model: [run for run in sweep.started if run.model == model] for model in MODELS}
    cases = dict.fromkeys(run.case for run in sweep.settled)
    drive = sorted({run.frequency for run in sweep.started})
    panel, gap, left, right, bottom, top, width = 1.8, 0.62, 0.75, 1.2, 0.5, 0.3, 8.5
    height = bottom + top + 4 * panel + 3 * gap
    with rc_context(RC):  # type: ignore[arg-type]
        figure = new_figure(width, height)
        axes = [
            place(figure, left, bottom + number * (panel + gap), width - left - right, panel)
            for number in (3, 2, 1, 0)
        ]
        for look, (model, runs) in zip(_STYLES, started.items(), strict=False):
            style = {**look, "markersize": 4.0, "linewidth": 1.2, "label": model}
            at = [run.frequency for run in runs]
            axes[0].plot(at, [run.largest.place for run in runs], **style)
            axes[1].plot(at, [run.largest.middle_over_ends for run in runs], **style)
            axes[2].plot(at, [run.share for run in runs], **style)
        for look, case in zip(_STYLES, cases, strict=False):
            style = {**look, "markersize": 4.0, "linewidth": 1.2, "label": case}
            losses = sweep.of_case(case)
            axes[3].plot([run.frequency for run in losses], [_energy_ratio(run) for run in losses], **style)
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
            for natural in sweep.naturals:
                one.axvline(float(natural), color=GREY, linewidth=0.8, linestyle=":")
            one.set_ylabel(label)
            set_title(one, title)
            one.set_xlim(drive[0] - 0.005, drive[-1] + 0.005)
        axes[3].set_xlabel("Drive frequency [Hz]; dotted: natural frequencies")
        for one in (axes[0], axes[3]):
            one.set_ylim(-0.04, 1.04)
            one.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        caption = "Place of the largest tension, middle over ends, share of one shape and energy ratio."
        return picture(figure, caption, "Four panels of curves over the drive frequency.")


def _energy_ratio(run: SettledRun) -> float:
    """Return the energy of the weaker wave at the bottom over that of the stronger; NaN: not settled."""
    waves = run.order(0.0)
    return waves.energy_ratio if waves is not None and run.is_settled else math.nan
