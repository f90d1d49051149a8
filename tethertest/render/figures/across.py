"""Figures over many runs: number and amplitude of lines against the drive, and what stands beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from tethertest.records.across import Across, Curve, Direction, Group, RunPart, StepVerdict
from tethertest.records.analysis import MEASURED, REPLAYED
from tethertest.render.blocks import Picture
from tethertest.render.figures.across_panels import along, decades, spectra
from tethertest.render.figures.runs import (
    KINDS,
    channel_of,
    has_spectrum,
    nearest_top,
    places,
    setting_of,
    title_of,
)
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
from tethertest.render.scales import scale_for

_ORANGE, _GREEN, _PURPLE, _YELLOW = "#E69F00", "#009E73", "#CC79A7", "#F0E442"
#: the commonest orders keep their colours from figure to figure
_ORDER_COLOURS: Final = {
    "1": BLACK,
    "2": BLUE,
    "3": _GREEN,
    "4": _ORANGE,
    "5": "#8B4513",
    "1/2": VERMILLION,
    "3/2": _PURPLE,
    "1/3": SKY,
}
_BRANCH: Final[dict[Direction, dict[str, Any]]] = {
    Direction.UP: {"marker": "o", "linestyle": "-"},
    Direction.DOWN: {"marker": "s", "linestyle": (0, (4, 2))},
    Direction.UNORDERED: {"marker": "D", "linestyle": "none"},
}
_BRANCH_NAMES: Final = {
    Direction.UP: "sweep up",
    Direction.DOWN: "sweep down",
    Direction.UNORDERED: "no sweep",
}
_AXES: Final = {"frequency": "Drive frequency [Hz]", "amplitude": "Drive amplitude [m]"}
_LEFT, _RIGHT, _BOTTOM, _TOP, _BETWEEN = 0.75, 0.15, 0.5, 0.62, 0.8  #: [inch]
_COUNTS, _AMPLITUDES, _GUTTER = 0.9, 2.6, 0.3  #: heights of the two rows, and between them [inch]
_DECADES: Final = 4.5  #: below the greatest amplitude
SETTING_DIGITS: Final = 3


def across_figures(across: Across) -> dict[str, Picture]:
    """Return the figures of runs analysed together, by name.

    Parameters
    ----------
    across : Across
        Each group gives number and amplitudes of lines against its setting, spectra at every setting of the
        tension and the strain nearest the top, and the largest tension along the cable.
    """
    parts = {part.run: part for part in across.runs if not part.refused}
    made: dict[str, Picture] = {}
    with rc_context(RC):  # type: ignore[arg-type]
        for number, group in enumerate(across.groups):
            chosen = [parts[run] for run in group.runs]
            shown = _shown(chosen)
            curves = [curve for curve in across.curves if curve.group == number and curve.channel in shown]
            if curves:
                made[f"amplitudes-{number + 1}"] = _amplitudes(group, chosen, curves, shown)
            for name in (nearest_top(chosen, "tension"), nearest_top(chosen, "strain")):
                if name is not None and has_spectrum(chosen, name):
                    made[f"spectra-{number + 1}-{name}"] = spectra(group, chosen, name)
            drawn = along(group, chosen)
            if drawn is not None:
                made[f"along-{number + 1}"] = drawn
    return made


def _shown(parts: Sequence[RunPart]) -> list[str]:
    """Return the channels with a column: all tensions, the top one first, and the strain nearest the top."""
    tensions = places(parts, "tension")
    names = sorted(tensions, key=lambda name: -tensions[name])[:2]
    strain = nearest_top(parts, "strain")
    return names + ([strain] if strain else [])


def _amplitudes(
    group: Group, parts: Sequence[RunPart], curves: Sequence[Curve], names: Sequence[str]
) -> Picture:
    """Return number and amplitudes of lines against the setting, one column per channel."""
    height = _BOTTOM + _AMPLITUDES + _GUTTER + _COUNTS + _TOP
    figure = new_figure(WIDE, height)
    width = (WIDE - _LEFT - _RIGHT - (len(names) - 1) * _BETWEEN) / len(names)
    settings = [setting_of(part, group.against) for part in parts]
    margin = 0.06 * (max(settings) - min(settings))
    for column, name in enumerate(names):
        left = _LEFT + column * (width + _BETWEEN)
        counts = place(figure, left, _BOTTOM + _AMPLITUDES + _GUTTER, width, _COUNTS)
        sizes = place(figure, left, _BOTTOM, width, _AMPLITUDES)
        _draw_counts(counts, group, parts, name)
        _draw_sizes(sizes, [curve for curve in curves if curve.channel == name])
        sizes.set_xlabel(_AXES[group.against])
        counts.tick_params(labelbottom=False)
        set_title(counts, name)
        if column == 0:
            counts.set_ylabel("Lines")
        for axes in (counts, sizes):
            axes.set_xlim(min(settings) - margin, max(settings) + margin)
    orders = list(dict.fromkeys(curve.order for curve in curves))
    handles = [Line2D([], [], color=_colour(order), linewidth=2.0) for order in orders]
    labels = [f"order {order}" for order in orders]
    for direction in dict.fromkeys(curve.direction for curve in curves):
        handles.append(Line2D([], [], color=GREY, **_BRANCH[direction]))
        labels.append(_BRANCH_NAMES[direction])
    if any(curve.side == REPLAYED for curve in curves):
        handles.append(Line2D([], [], color=GREY, marker="x", linestyle=":"))
        labels.append("replayed")
    across, _ = figure.get_size_inches()
    figure.legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(_LEFT / across, 1.0),
        ncols=min(len(labels), 10),
        borderaxespad=0.2,
        columnspacing=1.2,
        handlelength=2.0,
    )
    caption = (
        f"{title_of(group)}: number of lines found and amplitude of each order. Bars: 95 %. A triangle "
        "stands at the upper limit of an order that was not found; a grey cross: damaged, not judged. "
        "Shaded red: a jump lies in the gap; grey: a jump or a flank that is not resolved."
    )
    return picture(figure, caption, f"Number and amplitude of lines against the drive's {group.against}.")


def _draw_counts(axes: Axes, group: Group, parts: Sequence[RunPart], name: str) -> None:
    highest = 1
    looks = [
        (MEASURED, BLACK, branch.members, _BRANCH[branch.direction]["marker"]) for branch in group.branches
    ]
    looks.append((REPLAYED, VERMILLION, tuple(range(len(parts))), "x"))
    for side, colour, chosen, marker in looks:
        found = [
            (parts[k], channel) for k in chosen if (channel := channel_of(parts[k], name, side)) is not None
        ]
        counts = [len(channel.found) for _, channel in found]
        highest = max(highest, *counts) if counts else highest
        settings = [setting_of(part, group.against) for part, _ in found]
        axes.plot(settings, counts, marker, color=colour, markersize=5)
    axes.set_ylim(0.0, highest + 1.0)
    axes.yaxis.set_major_locator(MaxNLocator(3, integer=True))


def _draw_sizes(axes: Axes, curves: Sequence[Curve]) -> None:
    if not curves:
        return
    scale = scale_for(curves[0].kind, curves[0].unit)
    largest = max(point.interval[1] for curve in curves for point in curve.points) * scale.factor
    lowest = largest * 10.0**-_DECADES
    decades(axes)
    for curve in curves:
        _draw_curve(axes, curve, scale.factor, lowest)
        for step in curve.judgement.steps if curve.side == MEASURED else ():
            jump = step.verdict is StepVerdict.JUMP
            axes.axvspan(*step.interval, color=VERMILLION if jump else GREY, alpha=0.25, linewidth=0)
    axes.set_ylim(lowest, 2.0 * largest)
    unit = f" [{scale.unit}]" if scale.unit else ""
    axes.set_ylabel(f"{KINDS.get(curves[0].kind, curves[0].kind)}{unit}")


def _draw_curve(axes: Axes, curve: Curve, factor: float, lowest: float) -> None:
    colour = _colour(curve.order)
    there = sorted((point for point in curve.points if point.found), key=lambda point: point.setting)
    gone = [point for point in curve.points if not point.found]
    measured = curve.side == MEASURED
    look = dict(_BRANCH[curve.direction]) if measured else {"marker": "x", "linestyle": ":"}
    if there:
        values = [max(factor * point.amplitude, lowest) for point in there]
        below = [
            max(0.0, v - max(factor * p.interval[0], lowest)) for v, p in zip(values, there, strict=True)
        ]
        above = [max(0.0, factor * p.interval[1] - v) for v, p in zip(values, there, strict=True)]
        axes.errorbar(
            [point.setting for point in there],
            values,
            yerr=(below, above),
            color=colour,
            markersize=4.5,
            linewidth=1.1,
            elinewidth=0.8,
            capsize=2,
            markerfacecolor=colour if measured else "none",
            **look,
        )
    for point in gone:
        axes.plot(
            point.setting,
            max(factor * point.interval[1], lowest),
            "v",
            color=colour,
            markersize=4,
            markerfacecolor="none",
            alpha=0.6,
        )
    for point in curve.points:
        if point.damage:
            value = point.amplitude if point.found else point.interval[1]
            axes.plot(point.setting, max(factor * value, lowest), "x", color=GREY, markersize=9)


def _colour(order: str) -> str:
    return _ORDER_COLOURS.get(order, _YELLOW if "/" in order else GREY)
