"""Amplitude spectra of measured and replayed channels, with the orders of the drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import ChannelLines, LineVerdict
from tethertest.render.blocks import Picture
from tethertest.render.decimate import greatest_indices
from tethertest.render.figures.style import (
    GREY,
    MEASURED,
    REPLAYED,
    WIDE,
    legend_above,
    new_figure,
    picture,
    pixels,
    place,
    set_title,
)
from tethertest.render.scales import axis_label, scale_for
from tethertest.render.selection import Pair
from tethertest.spectra.spectrum import Spectrum, spectrum

DECADES_SHOWN = 5  #: below the greatest amplitude
LOWEST_ORDER = 0.25  #: left end of the frequency axis, in drive frequencies
_ROW = 1.9  #: [inch]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.7, 0.12, 0.44, 0.3  #: margins [inch]
_GUTTER, _BETWEEN = 0.75, 0.46  #: [inch]
_COLUMNS = 2
_LABELLED_APART = 1.09  #: least ratio of two orders' frequencies that both get a label


@dataclass(frozen=True, slots=True)
class Panel:
    """What one panel shows; at least one of the spectra is there."""

    name: str
    label: str  #: of the vertical axis
    factor: float  #: from SI to what is shown
    measured: Spectrum | None
    replayed: Spectrum | None


def spectra_panels(pairs: Sequence[Pair], window: Window) -> tuple[Panel, ...]:
    """Return the panels of those sensors that have a spectrum in the window."""
    panels = []
    for pair in pairs:
        found = [_spectrum(channel, window) for channel in (pair.measured, pair.replayed)]
        channel = pair.measured or pair.replayed
        if channel is not None and any(found):
            scale = scale_for(channel.kind, channel.unit)
            panels.append(Panel(pair.name, axis_label(channel), scale.factor, *found))
    return tuple(panels)


def spectra_figure(
    panels: Sequence[Panel], lines: Mapping[str, ChannelLines], window: Window, frequency: float | None
) -> Picture:
    """Return one panel per sensor.

    Parameters
    ----------
    panels : sequence of Panel
        At least one.
    lines : mapping
        Sensor -> its measured lines, whose orders are marked.
    window : Window
        What is analysed.
    frequency : float or None
        Drive frequency [Hz].
    """
    rows = -(-len(panels) // _COLUMNS)
    height = _BOTTOM + _TOP + _ROW * rows
    figure = new_figure(WIDE, height)
    width = (WIDE - _LEFT - _RIGHT - _GUTTER * (_COLUMNS - 1)) / _COLUMNS
    lowest = LOWEST_ORDER * frequency if frequency else 1.0 / max(window.length, 1e-9)
    drawn = []
    for i, panel in enumerate(panels):
        left = _LEFT + (i % _COLUMNS) * (width + _GUTTER)
        bottom = height - _TOP - _ROW * (i // _COLUMNS + 1) + _BETWEEN - 0.2
        axes = place(figure, left, bottom, width, _ROW - _BETWEEN)
        _draw_panel(axes, panel, lowest)
        if panel.name in lines:
            _mark_orders(axes, lines[panel.name])
        set_title(axes, panel.name, right=True)
        if i + _COLUMNS >= len(panels):
            axes.set_xlabel("Frequency [Hz]")
        drawn.append(axes)
    legend_above(figure, *drawn, left=_LEFT)
    caption = (
        f"Amplitude spectra of {window.start:.2f} to {window.stop:.2f} s. Dotted: the orders that were "
        "looked for, numbered where a line was found."
    )
    return picture(figure, caption, f"Amplitude spectra of {len(panels)} channels on logarithmic axes.")


def _spectrum(channel: Channel | None, window: Window) -> Spectrum | None:
    if channel is None:
        return None
    try:
        return spectrum(channel, window)
    except DataError:  # too few samples: the page says that there is none
        return None


def _draw_panel(axes: Axes, panel: Panel, lowest: float) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    greatest, highest = 0.0, lowest
    both = ((panel.measured, "measured", MEASURED), (panel.replayed, "replayed", REPLAYED))
    for found, label, style in both:
        if found is None:
            continue
        inside = (found.frequency >= lowest) & (found.amplitude > 0.0)
        frequency, amplitude = found.frequency[inside], panel.factor * found.amplitude[inside]
        if frequency.size:
            keep = greatest_indices(np.log(frequency), amplitude, pixels(axes) // 2)
            axes.plot(frequency[keep], amplitude[keep], label=label, **{**style, "linewidth": 0.9})
            greatest, highest = max(greatest, float(amplitude.max())), max(highest, float(frequency[-1]))
    axes.set_ylabel(panel.label)
    if greatest > 0.0:
        axes.set_ylim(greatest * 10.0**-DECADES_SHOWN, greatest * 2.0)
    if highest > lowest:
        axes.set_xlim(lowest, highest)
    for axis, steps in ((axes.xaxis, (1.0, 3.0)), (axes.yaxis, (1.0,))):
        axis.set_major_locator(FixedLocator(decade_ticks(*axis.get_view_interval(), steps)))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(plain_number))


def decade_ticks(low: float, high: float, steps: tuple[float, ...]) -> list[float]:
    """Return the ticks within a span, no others: ticks are what matplotlib takes its time for."""
    first, last = int(np.floor(np.log10(low))), int(np.ceil(np.log10(high)))
    ticks = [step * 10.0**decade for decade in range(first, last + 1) for step in steps]
    return [tick for tick in ticks if low <= tick <= high]


def _mark_orders(axes: Axes, lines: ChannelLines) -> None:
    """Mark every order that was looked for, and number those that were found."""
    across = axes.get_xaxis_transform()
    ordered = sorted(lines.lines, key=lambda line: line.frequency)
    axes.vlines(
        [line.frequency for line in ordered],
        0.0,
        1.0,
        transform=across,
        colors=GREY,
        linewidths=[0.6 if line.verdict is LineVerdict.NONE else 1.1 for line in ordered],
        linestyles=":",
        zorder=0.8,
    )
    labelled, (left, right) = 0.0, axes.get_xlim()
    for line in ordered:
        if not left <= line.frequency <= right or line.verdict is LineVerdict.NONE:
            continue
        if line.frequency > labelled * _LABELLED_APART:
            labelled = line.frequency
            axes.text(
                line.frequency, 1.02, line.order, transform=across, ha="center", va="bottom", fontsize=8.0
            )


def plain_number(value: float, _position: int) -> str:
    """Return a tick's label without a power of ten."""
    return f"{value:g}"
