"""How every figure looks, and how it becomes an image."""

from __future__ import annotations

import io
import warnings
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from tethertest.records.channel import Window
from tethertest.render.blocks import Picture

#: Okabe and Ito's colours, told apart by the colour-blind; line style and width tell them apart in grey
BLACK: Final = "#000000"
VERMILLION: Final = "#D55E00"
BLUE: Final = "#0072B2"
SKY: Final = "#56B4E9"
GREY: Final = "#8C8C8C"

MEASURED: Final[dict[str, Any]] = {"color": BLACK, "linestyle": "-", "linewidth": 1.5}
REPLAYED: Final[dict[str, Any]] = {"color": VERMILLION, "linestyle": (0, (4, 1.6)), "linewidth": 1.5}
#: in an overview the lines are crowded: thinner, and the replayed one unbroken
CROWDED: Final[dict[str, Any]] = {"linestyle": "-", "linewidth": 0.6}
FLAGGED: Final[dict[str, Any]] = {
    "color": BLUE,
    "linestyle": "none",
    "marker": "x",
    "markersize": 5,
    "markeredgewidth": 1.2,
}
SLACK: Final[dict[str, Any]] = {"facecolor": SKY, "alpha": 0.35, "edgecolor": "none"}
COLORMAP: Final = "cividis"

DOTS_PER_INCH: Final = 120
PAGE_PIXELS_PER_INCH: Final = 106  #: as shown, so that text is as large in all figures
CYCLE_PIXELS: Final = 8  #: where a cycle has fewer, its ups and downs can no longer be drawn
WIDE: Final = 12.6  #: [inch], the page's whole width
COMPRESSION: Final = 1  #: without the alpha channel smaller than at level 4 with it, and faster

RC: Final[dict[str, Any]] = {
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": "#D9D9D9",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.frameon": False,
    "legend.fontsize": 9.0,
    "legend.handlelength": 2.6,
    "legend.borderpad": 0.1,
    "text.parse_math": False,  # a dollar sign in a sensor's name is a dollar sign
}


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of that size [inch]."""
    figure = Figure(figsize=(width, height), dpi=DOTS_PER_INCH, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def place(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Return axes placed in inches from the figure's lower left corner."""
    across, up = figure.get_size_inches()
    return figure.add_axes((left / across, bottom / up, width / across, height / up))


def pixels(axes: Axes) -> int:
    """Return the columns of pixels of the axes."""
    return int(axes.get_position().width * axes.get_figure(root=True).get_size_inches()[0] * DOTS_PER_INCH)  # type: ignore[union-attr]


def cycles_blur(axes: Axes, window: Window, frequency: float | None) -> bool:
    """Return whether the cycles of the drive are too narrow to be drawn in that window."""
    return frequency is not None and frequency * window.length * CYCLE_PIXELS > pixels(axes)


def legend_above(figure: Figure, axes: Axes, *others: Axes, left: float = 0.6) -> None:
    """Put one legend for all axes above the data, from `left` [inch] on."""
    found: dict[str, Any] = {}
    for part in (axes, *others):
        for handle, label in zip(*part.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    if not found:
        return
    across = figure.get_size_inches()[0]
    legend = figure.legend(
        list(found.values()),
        list(found),
        loc="upper left",
        bbox_to_anchor=(left / across, 1.0),
        ncols=len(found),
        borderaxespad=0.2,
    )
    for line in legend.get_lines():
        line.set_linewidth(max(line.get_linewidth(), 1.4))


def set_title(axes: Axes, text: str, *, right: bool = False) -> None:
    """Put a title above the axes; matplotlib's own search for a free place is slow."""
    axes.annotate(
        text,
        (1.0 if right else 0.0, 1.0),
        xycoords="axes fraction",
        xytext=(0.0, 3.0),
        textcoords="offset points",
        ha="right" if right else "left",
        va="bottom",
        fontweight="bold",
    )


def set_span(axes: Axes, window: Window) -> None:
    """Show a window on the time axis."""
    if window.stop > window.start:
        axes.set_xlim(window.start, window.stop)


def set_limits(axes: Axes, low: float, high: float) -> None:
    """Show values from low to high with a margin; equal or unknown ends are widened."""
    if not (np.isfinite(low) and np.isfinite(high)):
        low, high = 0.0, 1.0
    margin = 0.06 * (high - low) or 0.06 * abs(high) or 1.0
    axes.set_ylim(low - margin, high + margin)


def picture(figure: Figure, caption: str, alternative: str) -> Picture:
    """Return the figure as an image; the same figure gives the same bytes."""
    stream = io.BytesIO()
    canvas: Any = figure.canvas  # its methods have no types
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")  # the table has the name
        canvas.draw()
    opaque = np.asarray(canvas.buffer_rgba())[..., :3]
    resolution = (DOTS_PER_INCH, DOTS_PER_INCH)
    Image.fromarray(opaque).save(stream, format="png", compress_level=COMPRESSION, dpi=resolution)
    width, height = figure.get_size_inches() * PAGE_PIXELS_PER_INCH
    return Picture(stream.getvalue(), round(width), round(height), caption, alternative)
