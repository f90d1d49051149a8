"""Figures of one analysed channel: spectrum, section and phase portrait, spectrogram in orders."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from tethertest.records.analysis import MEASURED, ChannelAnalysis
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Window
from tethertest.render.blocks import Picture
from tethertest.render.decimate import greatest_indices
from tethertest.render.figures.marks import SpectrumMarks
from tethertest.render.figures.spectra import decade_ticks, plain_number
from tethertest.render.figures.style import (
    BLACK,
    BLUE,
    COLORMAP,
    GREY,
    RC,
    VERMILLION,
    WIDE,
    legend_above,
    new_figure,
    picture,
    pixels,
    place,
    set_limits,
    set_title,
)
from tethertest.render.scales import axis_label, scale_for
from tethertest.render.text import number
from tethertest.spectra.order_spectrogram import OrderSpectrogram
from tethertest.spectra.phase_portrait import PhasePortrait
from tethertest.spectra.spectrum import Spectrum

_LEFT, _RIGHT, _BOTTOM, _TOP = 0.95, 0.25, 0.5, 0.56  #: margins [inch]
_HEIGHT, _SQUARE = 4.4, 4.6  #: [inch]
_LABELS = 1.2  #: room for the verdicts above the spectrum [inch]
_LEGEND = 3.6  #: where the legend begins [inch]
_GUTTER, _BAR = 0.95, 0.16  #: [inch]
#: least distance of two vertical labels [inch]: the height of their letters
_APART: Final = 0.13
_DECADES: Final = 5  #: of the spectrum, below its greatest amplitude; more where a level lies lower
_BELOW: Final = 0.2  #: lower end of the spectrum, as a part of its floor
_LEVEL_PIXELS: Final = 4  #: apart, points of the level of a blind search
_SHADES: Final = 3  #: decades of the spectrogram
#: part of the orbit's range that the section's axis covers at least
_SECTION_SHARE: Final = 0.2
_LONGEST_NAME: Final = 40  #: letters of a channel's name in the head


def spectrum_figure(
    item: ChannelAnalysis, found: Spectrum, window: Window, marks: SpectrumMarks, span: tuple[float, float]
) -> Picture:
    """Return the amplitude spectrum of a channel with orders, natural frequencies and significance.

    Parameters
    ----------
    item : ChannelAnalysis
        The channel.
    found : Spectrum
        Of the window.
    window : Window
        What was transformed.
    marks : SpectrumMarks
        What is marked.
    span : tuple of float
        Least and greatest frequency shown [Hz].
    """
    with rc_context(RC):  # type: ignore[arg-type]
        top = _TOP + _LABELS if marks.orders else _TOP
        height = _HEIGHT + top - _TOP
        figure = new_figure(WIDE, height)
        axes = place(figure, _LEFT, _BOTTOM, WIDE - _LEFT - _RIGHT, height - _BOTTOM - top)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(*span)
        _draw_spectrum(axes, item, found, marks, span)
        _draw_orders(axes, marks)
        _draw_naturals(axes, marks)
        for axis, steps in ((axes.xaxis, (1.0, 2.0, 5.0)), (axes.yaxis, (1.0,))):
            axis.set_major_locator(FixedLocator(decade_ticks(*axis.get_view_interval(), steps)))
            axis.set_minor_locator(NullLocator())
            axis.set_major_formatter(FuncFormatter(plain_number))
        axes.set_xlabel(f"Frequency [Hz], window {window.start:.2f} to {window.stop:.2f} s")
        axes.set_ylabel(_amplitude_label(item))
        legend_above(figure, axes, left=_LEGEND)
        _head(figure, item)
        name = item.channel.name
        return picture(figure, "Amplitude spectrum.", f"Amplitude spectrum of {name} with orders marked.")


def portrait_figure(item: ChannelAnalysis, seen: PhasePortrait) -> Picture:
    """Return the phase portrait with the section's points, and the section period by period.

    Parameters
    ----------
    item : ChannelAnalysis
        The channel.
    seen : PhasePortrait
        Its numbers.
    """
    with rc_context(RC):  # type: ignore[arg-type]
        channel = item.channel
        scale = scale_for(channel.kind, channel.unit)
        figure = new_figure(WIDE, _SQUARE)
        up = _SQUARE - _BOTTOM - _TOP
        width = 0.42 * (WIDE - _LEFT - _RIGHT - _GUTTER)
        plane = place(figure, _LEFT, _BOTTOM, width, up)
        after = _LEFT + width + _GUTTER
        series = place(figure, after, _BOTTOM, WIDE - after - _RIGHT, up)
        label = "orbit" if seen.periods >= seen.section.size else f"orbit, last {seen.periods} periods"
        orbit = scale.values(seen.values), scale.factor * seen.rates
        plane.plot(*orbit, color=GREY, linewidth=0.5, label=label)
        periods = np.arange(1, seen.section.size + 1)
        for first, color, marker, label in (
            (0, VERMILLION, "o", "periods 1, 3, 5, ..."),
            (1, BLUE, "^", "periods 2, 4, 6, ..."),
        ):
            values = scale.values(seen.section[first::2])
            style: dict[str, Any] = {"color": color, "marker": marker, "linestyle": "none", "markersize": 4.0}
            plane.plot(values, scale.factor * seen.section_rate[first::2], label=label, zorder=3, **style)
            series.plot(periods[first::2], values, **style)
        plane.set_xlabel(axis_label(channel))
        plane.yaxis.set_major_formatter(FuncFormatter(plain_number))
        plane.set_ylabel(f"Rate of change [{scale.unit}/s]" if scale.unit else "Rate of change [1/s]")
        series.set_xlabel(f"Period of the drive, the first seen at {seen.time[0]:.3f} s")
        series.set_ylabel(axis_label(channel))
        series.xaxis.set_major_locator(MaxNLocator(integer=True))
        legend_above(figure, plane, left=_LEGEND)
        _head(figure, item)
        _set_section_limits(series, scale.values(seen.section), scale.values(seen.values))
        one, two = (number(scale.difference(seen.step(periods)), 3) for periods in (1, 2))
        unit = f" {scale.unit}" if scale.unit else ""
        text = f"Once per period: {one}{unit} from one to the next, {two}{unit} over two (rms)"
        set_title(series, text, right=True)
        alternative = f"Phase portrait and stroboscopic section of {channel.name}."
        return picture(figure, "Phase portrait and stroboscopic section.", alternative)


def spectrogram_figure(item: ChannelAnalysis, found: OrderSpectrogram, window: Window) -> Picture:
    """Return the amplitude against time and order of the drive; lines frame the analysed window.

    Parameters
    ----------
    item : ChannelAnalysis
        The channel.
    found : OrderSpectrogram
        Its numbers.
    window : Window
        What was analysed.
    """
    with rc_context(RC):  # type: ignore[arg-type]
        channel = item.channel
        figure = new_figure(WIDE, _HEIGHT)
        up = _HEIGHT - _BOTTOM - _TOP
        axes = place(figure, _LEFT, _BOTTOM, WIDE - _LEFT - _RIGHT - 1.1, up)
        amplitude = scale_for(channel.kind, channel.unit).factor * found.amplitude
        greatest = float(amplitude.max()) or 1.0
        least = greatest * 10.0**-_SHADES
        norm = LogNorm(least, greatest)
        axes.grid(visible=False)
        image = axes.pcolormesh(
            _edges(found.time),
            _edges(found.order),
            np.maximum(amplitude, least),
            cmap=COLORMAP,
            norm=norm,
            rasterized=True,
        )
        axes.set_xlim(float(channel.time[0]), float(channel.time[-1]))
        for end in (window.start, window.stop):
            axes.axvline(end, color=VERMILLION, linestyle="--", linewidth=1.4)
        axes.set_yticks(range(1, int(found.order[-1]) + 1))
        axes.set_xlabel("Time [s]; dashed: the ends of the window that was analysed")
        axes.set_ylabel("Frequency over that of the drive")
        bar = figure.colorbar(image, cax=place(figure, WIDE - _RIGHT - 0.9, _BOTTOM, _BAR, up))
        bar.ax.yaxis.set_major_locator(FixedLocator(decade_ticks(least, greatest, (1.0, 3.0))))
        bar.ax.yaxis.set_minor_locator(NullLocator())
        bar.ax.yaxis.set_major_formatter(FuncFormatter(plain_number))
        bar.set_label(_amplitude_label(item))
        _head(figure, item)
        alternative = f"Amplitude of {channel.name} over time and order of the drive."
        return picture(figure, "Spectrogram in orders.", alternative)


def _set_section_limits(axes: Axes, section: FloatArray, values: FloatArray) -> None:
    """Show noise as small as it is: the axis covers a part of the orbit's range at least."""
    low, high = float(section.min()), float(section.max())
    least = _SECTION_SHARE * float(np.ptp(values))
    missing = 0.5 * max(0.0, least - (high - low))
    set_limits(axes, low - missing, high + missing)


def _draw_spectrum(
    axes: Axes, item: ChannelAnalysis, found: Spectrum, marks: SpectrumMarks, span: tuple[float, float]
) -> None:
    factor = scale_for(item.channel.kind, item.channel.unit).factor
    inside = (found.frequency >= span[0]) & (found.frequency <= span[1]) & (found.amplitude > 0.0)
    frequency, amplitude = found.frequency[inside], factor * found.amplitude[inside]
    if frequency.size:
        keep = greatest_indices(np.log(frequency), amplitude, pixels(axes))
        axes.plot(frequency[keep], amplitude[keep], color=BLACK, linewidth=0.8, label="spectrum (Hann)")
        drawn = [mark.amplitude for mark in marks.orders if mark.amplitude]
        greatest = max([float(amplitude.max()), *drawn])
        levels = marks.level[marks.level > 0.0]
        floor = max(greatest * 10.0**-_DECADES, _BELOW * float(np.percentile(amplitude[keep], 5.0)))
        above = min(float(levels.max(initial=0.0)), 10.0 * greatest)
        axes.set_ylim(min([floor, *(0.5 * levels)]), 2.0 * max(greatest, above))
    if marks.level.size:
        few = marks.level.size <= len(marks.orders)
        # of a blind search's thousands the lowest next to each other: the level dips where a line stands
        shown = greatest_indices(np.log(marks.level_frequency), -marks.level, pixels(axes) // _LEVEL_PIXELS)
        axes.plot(
            marks.level_frequency[shown],
            marks.level[shown],
            color=VERMILLION,
            linestyle="--" if few else "-",
            linewidth=1.1,
            marker="_" if few else "",
            markersize=10.0,
            label="a line is significant above",
        )


def _draw_orders(axes: Axes, marks: SpectrumMarks) -> None:
    across = axes.get_xaxis_transform()
    if marks.orders:
        axes.vlines(
            [mark.frequency for mark in marks.orders],
            0.0,
            1.0,
            transform=across,
            colors=GREY,
            linestyles=":",
            linewidths=[1.1 if mark.found else 0.6 for mark in marks.orders],
            label="order of the drive",
        )
    for mark in _apart(axes, marks.orders, lambda mark: (not mark.found, mark.frequency)):
        axes.text(
            mark.frequency,
            1.015,
            mark.label,
            transform=across,
            rotation=90.0,
            ha="center",
            va="bottom",
            fontsize=8.0,
            color=BLACK if mark.found else GREY,
        )
    drawn = [mark for mark in marks.orders if mark.amplitude is not None]
    if drawn:
        sizes = np.array([mark.amplitude for mark in drawn], dtype=np.float64)
        ends = np.array([mark.interval for mark in drawn]).T
        axes.errorbar(
            [mark.frequency for mark in drawn],
            sizes,
            yerr=np.abs(ends - sizes),
            color=BLUE,
            marker="o",
            markersize=4.5,
            linestyle="none",
            capsize=2.5,
            label="line, 95 %",
            zorder=4,
        )
    if marks.peaks:
        axes.plot(
            *zip(*marks.peaks, strict=True),
            color=BLUE,
            marker="o",
            linestyle="none",
            markersize=4.5,
            label="significant peak of a blind search",
            zorder=4,
        )


def _draw_naturals(axes: Axes, marks: SpectrumMarks) -> None:
    if not marks.naturals:
        return
    across = axes.get_xaxis_transform()
    axes.vlines(
        [natural.frequency for natural in marks.naturals],
        0.0,
        1.0,
        transform=across,
        colors=BLUE,
        linestyles="-.",
        linewidths=0.9,
        label="natural frequency",
    )
    for natural in _apart(axes, marks.naturals, lambda natural: natural.frequency):
        axes.text(
            natural.frequency,
            0.02,
            natural.name,
            transform=across,
            rotation=90.0,
            ha="right",
            va="bottom",
            fontsize=7.5,
            color=BLUE,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6},
        )


def _apart(axes: Axes, marks: Any, preference: Any) -> list[Any]:
    """Return the marks whose labels do not overlap, those of low preference value first."""
    low, high = np.log(axes.get_xlim())
    inches = axes.get_position().width * WIDE / (high - low)
    chosen: list[Any] = []
    for mark in sorted(marks, key=preference):
        if all(abs(np.log(mark.frequency / other.frequency)) * inches >= _APART for other in chosen):
            chosen.append(mark)
    return chosen


def _edges(middles: FloatArray) -> FloatArray:
    """Return the edges of cells from their middles; a single cell is one wide."""
    if middles.size == 1:
        return np.array([middles[0] - 0.5, middles[0] + 0.5])
    between = 0.5 * (middles[1:] + middles[:-1])
    return np.concatenate(([2.0 * middles[0] - between[0]], between, [2.0 * middles[-1] - between[-1]]))


def _amplitude_label(item: ChannelAnalysis) -> str:
    unit = scale_for(item.channel.kind, item.channel.unit).unit
    return f"Amplitude, peak [{unit}]" if unit else "Amplitude, peak"


def _head(figure: Figure, item: ChannelAnalysis) -> None:
    across, up = figure.get_size_inches()
    name = item.channel.name
    name = name if len(name) <= _LONGEST_NAME else name[: _LONGEST_NAME - 3] + "..."
    text = name if item.side == MEASURED else f"{name} ({item.side})"
    figure.text(0.1 / across, 1.0 - 0.1 / up, text, va="top", fontweight="bold")
