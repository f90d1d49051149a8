"""Spectra side by side and tension along the cable, one run for each setting of the drive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

from tethertest.records.across import Group, RunPart
from tethertest.records.analysis import MEASURED, REPLAYED
from tethertest.render.blocks import Picture
from tethertest.render.figures import style
from tethertest.render.figures.runs import (
    KINDS,
    by_setting,
    channel_of,
    named,
    nearest_top,
    setting_of,
    title_of,
)
from tethertest.render.figures.style import (
    BLACK,
    BLUE,
    GREY,
    SKY,
    VERMILLION,
    WIDE,
    new_figure,
    picture,
    place,
    set_limits,
    set_title,
)
from tethertest.render.scales import scale_for

_LEFT, _RIGHT, _BOTTOM, _TOP, _BETWEEN = 0.75, 0.15, 0.5, 0.62, 0.62  #: [inch]
_SPECTRUM, _ACROSS, _MOST = 1.5, 3, 9
#: below the greatest amplitude, and orders of the drive
_DECADES, _ORDERS = 4.5, 8.0
_ALONG, _LEGEND = 3.6, 2.6  #: [inch]
_COLOURS: Final = (BLACK, BLUE, VERMILLION, "#009E73", "#E69F00", "#CC79A7", SKY, GREY)


def decades(axes: Axes) -> None:
    """Show a logarithmic vertical axis with plain numbers."""
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def spectra(group: Group, parts: Sequence[RunPart], name: str) -> Picture:
    """Return the spectrum of one channel at every setting, the orders that were found numbered."""
    shown = by_setting(parts, group.against, name)
    left_out = len(shown) - _MOST
    if left_out > 0:  # evenly over the settings, first and last among them
        last = len(shown) - 1
        shown = [shown[round(place * last / (_MOST - 1))] for place in range(_MOST)]
    across = min(_ACROSS, len(shown))
    rows = -(-len(shown) // across)
    height = _BOTTOM + _TOP + rows * _SPECTRUM + (rows - 1) * _BETWEEN
    figure = new_figure(WIDE, height)
    width = (WIDE - _LEFT - _RIGHT - (across - 1) * _BETWEEN) / across
    for number, part in enumerate(shown):
        row, column = divmod(number, across)
        bottom = height - _TOP - (row + 1) * _SPECTRUM - row * _BETWEEN
        axes = place(figure, _LEFT + column * (width + _BETWEEN), bottom, width, _SPECTRUM)
        label = _draw_spectrum(axes, part, name)
        value = setting_of(part, group.against)
        set_title(axes, named(value, part, group.against))
        if column == 0:
            axes.set_ylabel(label)
        if number + across >= len(shown):
            axes.set_xlabel("Frequency over that of the drive")
    handles = [Line2D([], [], **style.MEASURED)]
    names = ["measured"]
    if any(channel_of(part, name, REPLAYED) for part in shown):
        handles.append(Line2D([], [], **style.REPLAYED))
        names.append("replayed")
    figure.legend(
        handles, names, loc="upper left", bbox_to_anchor=(_LEFT / WIDE, 1.0), ncols=2, borderaxespad=0.2
    )
    more = f" {left_out} settings between them are left out." if left_out > 0 else ""
    caption = (
        f"{title_of(group)}: amplitude spectrum of {name} in the steady window. Dotted and numbered: orders "
        f"that were found.{more}"
    )
    return picture(figure, caption, f"Amplitude spectra of {name}, one panel for each {group.against}.")


def _draw_spectrum(axes: Axes, part: RunPart, name: str) -> str:
    frequency, largest, label = part.frequency or 1.0, 0.0, ""
    decades(axes)
    for side, look in ((MEASURED, style.MEASURED), (REPLAYED, style.REPLAYED)):
        channel = channel_of(part, name, side)
        if channel is None or channel.spectrum is None:
            continue
        scale = scale_for(channel.kind, channel.unit)
        label = f"{KINDS.get(channel.kind, channel.kind)} [{scale.unit}]"
        at, amplitude = channel.spectrum
        # the value at zero is what is left of the mean
        axes.plot(at[1:] / frequency, scale.factor * amplitude[1:], **{**look, "linewidth": 1.0})
        largest = max(largest, scale.factor * float(amplitude[1:].max()))
        for line in channel.found if side == MEASURED else ():
            axes.axvline(line.frequency / frequency, color=GREY, linestyle=":", linewidth=0.8, zorder=1)
            axes.annotate(
                line.order,
                (line.frequency / frequency, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(2.0, -2.0),
                textcoords="offset points",
                va="top",
                fontsize=8.0,
            )
    axes.set_xlim(0.0, _ORDERS)
    if largest > 0.0:
        axes.set_ylim(largest * 10.0**-_DECADES, 4.0 * largest)
    return label


def along(group: Group, parts: Sequence[RunPart]) -> Picture | None:
    """Return the largest dynamic tension against place, one line per setting."""
    tension = nearest_top(parts, "tension")
    shown = [] if tension is None else by_setting(parts, group.against, tension)
    if not shown:
        return None
    figure = new_figure(WIDE, _ALONG)
    axes = place(figure, _LEFT, _BOTTOM, WIDE - _LEFT - _RIGHT - _LEGEND, _ALONG - _BOTTOM - 0.3)
    drawn: list[float] = []
    for number, part in enumerate(shown):
        colour = _COLOURS[number % len(_COLOURS)]
        label = named(setting_of(part, group.against), part, group.against)
        for side, line in ((MEASURED, "-"), (REPLAYED, (0, (4, 1.6)))):
            points = _largest(part, side)
            if not points:
                continue
            where = [point[0] for point in points]
            what = [point[1] for point in points]
            drawn += what
            name = label if side == MEASURED else f"{label}, replayed"
            axes.plot(where, what, linestyle=line, color=colour, linewidth=1.1, label=name)
            for kind, marker in (("tension", "s"), ("strain", "o")) if side == MEASURED else ():
                of_kind = [(at, value, noise) for at, value, noise, found in points if found == kind]
                if of_kind:
                    at, value, noise = zip(*of_kind, strict=True)
                    below = (noise, [0.0] * len(noise))
                    axes.errorbar(
                        at,
                        value,
                        yerr=below,
                        fmt=marker,
                        color=colour,
                        markersize=5,
                        elinewidth=0.9,
                        capsize=2,
                    )
                    drawn += [v - n for v, n in zip(value, noise, strict=True)]
    if not drawn:
        return None
    axes.set_xlabel("Place from the bottom [m]" if shown[0].length else "Place from the bottom")
    axes.set_ylabel("Largest dynamic tension [N]")
    set_limits(axes, min(drawn), max(drawn))
    figure.legend(
        *axes.get_legend_handles_labels(),
        loc="upper left",
        bbox_to_anchor=(1.0 - _LEGEND / WIDE, 0.95),
        fontsize=8.0,
    )
    caption = (
        f"{title_of(group)}: largest tension in the steady window less the tension at rest. Squares: load "
        "cells; dots: gratings, axial stiffness times strain; bars: what the samples' noise may have added. "
        "Damaged channels are left out."
    )
    return picture(figure, caption, "Largest dynamic tension against place along the cable.")


def _largest(part: RunPart, side: str) -> list[tuple[float, float, float, str]]:
    """Return place, largest dynamic tension, what noise may add and kind of the sound channels."""
    found = []
    for channel in part.channels:
        if channel.side != side or channel.at is None or channel.largest is None or channel.damage:
            continue
        factor = 1.0 if channel.kind == "tension" else part.axial_stiffness
        if factor is not None:
            at = channel.at * (part.length or 1.0)
            found.append((at, factor * channel.largest, factor * channel.noise, channel.kind))
    return sorted(found)
