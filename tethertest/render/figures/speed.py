"""Error against wall time, one panel per scene, one line per model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from tethertest.render.blocks import Picture
from tethertest.render.figures.style import (
    BLACK,
    BLUE,
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

#: errors at or below this are drawn on it, and those above the other are left out
_LEAST, _MOST = 1e-8, 10.0
_COLUMNS = 3
_LEFT, _RIGHT, _BOTTOM, _TOP, _BETWEEN, _HEIGHT = 0.66, 0.14, 0.5, 0.56, 0.5, 2.5  #: [inch]
_ACROSS = 0.3  #: between columns [inch]
_ORANGE: Final = "#E69F00"
_GREEN: Final = "#009E73"
_PURPLE: Final = "#CC79A7"
#: what the models look like; an unknown one is grey
_LOOKS: Final[dict[str, tuple[str, str]]] = {
    "auto": (BLACK, "*"),
    "catenary": (_PURPLE, "P"),
    "linear, exact": (_GREEN, "D"),
    "linear, two-grid": (_GREEN, "v"),
    "linear, as-printed": (_ORANGE, "x"),
    "nonlinear, plain": (BLUE, "o"),
    "nonlinear, viscous": (VERMILLION, "s"),
    "nonlinear, extrapolated": (SKY, "^"),
}


@dataclass(frozen=True, slots=True)
class SpeedCurve:
    """Runs of one model."""

    name: str
    wall: tuple[float, ...]  #: [s]
    error: tuple[float, ...]  #: relative


@dataclass(frozen=True, slots=True)
class SpeedPanel:
    """One scene."""

    title: str
    reference_error: float | None  #: below it errors are those of the reference
    curves: tuple[SpeedCurve, ...]


def speed_against_error(panels: Sequence[SpeedPanel]) -> Picture:
    """Return the figure.

    Parameters
    ----------
    panels : sequence of SpeedPanel
        At least one.
    """
    with rc_context(RC):  # type: ignore[arg-type]
        return _figure(panels)


def _figure(panels: Sequence[SpeedPanel]) -> Picture:
    columns = min(_COLUMNS, len(panels))
    rows = math.ceil(len(panels) / columns)
    height = _TOP + _BOTTOM + rows * _HEIGHT + (rows - 1) * _BETWEEN
    figure = new_figure(WIDE, height)
    width = (WIDE - _LEFT - _RIGHT - (columns - 1) * _ACROSS) / columns
    walls = [wall for panel in panels for curve in panel.curves for wall in curve.wall]
    for number, panel in enumerate(panels):
        row, column = divmod(number, columns)
        left = _LEFT + column * (width + _ACROSS)
        bottom = height - _TOP - (row + 1) * _HEIGHT - row * _BETWEEN
        axes = place(figure, left, bottom, width, _HEIGHT)
        _draw(axes, panel)
        axes.set_xlim(0.6 * min(walls), 1.6 * max(walls))
        axes.set_ylim(0.4 * _LEAST, 2.0 * _MOST)
        if column == 0:
            axes.set_ylabel("Error, RMS over the dynamic part")
        else:
            axes.tick_params(labelleft=False)
        if number + columns >= len(panels):
            axes.set_xlabel("Wall time [s]")
    _legend(figure, {curve.name for panel in panels for curve in panel.curves})
    caption = (
        "Error against wall time; stars are what the solver chose. Errors of 1e-8 and less are drawn at "
        "1e-8, those above 10 left out. Dashed: the reference's own error, below which nothing is resolved."
    )
    return picture(figure, caption, "Error over wall time of every model, one panel per scene, log-log.")


def _look(name: str) -> dict[str, Any]:
    color, marker = _LOOKS.get(name, (GREY, "."))
    chosen = name == "auto"
    return {
        "color": color,
        "marker": marker,
        "markersize": 13 if chosen else 5,
        "markerfacecolor": "none" if chosen else color,
        "markeredgewidth": 1.4 if chosen else 1.0,
        "linestyle": "none" if chosen else "-",
        "linewidth": 1.1,
        "zorder": 4 if chosen else 3,
    }


def _legend(figure: Figure, names: set[str]) -> None:
    """Put one legend for all panels above them."""
    known = [name for name in _LOOKS if name in names]
    shown = [*known, *sorted(names - set(known))]
    width, _ = figure.get_size_inches()
    figure.legend(
        [Line2D([], [], **_look(name)) for name in shown],
        shown,
        loc="upper left",
        bbox_to_anchor=(_LEFT / width, 1.0),
        ncols=len(shown),
        handlelength=1.8,
        columnspacing=1.1,
        borderaxespad=0.2,
    )


def _draw(axes: Axes, panel: SpeedPanel) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: f"1e{round(math.log10(value))}")
        axis.set_minor_formatter(NullFormatter())
    for curve in panel.curves:
        points = [
            (wall, max(error, _LEAST))
            for wall, error in zip(curve.wall, curve.error, strict=True)
            if error <= _MOST
        ]
        if not points:
            continue
        axes.plot(*zip(*points, strict=True), **_look(curve.name))
    if panel.reference_error is not None:
        axes.axhline(max(panel.reference_error, _LEAST), color=GREY, linestyle=(0, (4, 3)), linewidth=1.0)
    set_title(axes, panel.title)
