"""Share of lines found against their amplitude, beside what the test alone could find."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib import rc_context
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from reports.line_calibration.power import Found, theoretical_power
from tethertest.render.blocks import Picture
from tethertest.render.figures.style import BLUE, RC, VERMILLION, legend_above, new_figure, picture, place

_WIDTH, _HEIGHT = 7.2, 4.4  #: [inch]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.8, 0.25, 0.55, 0.42  #: margins [inch]
_MARGIN: Final = 1.12  #: of the logarithmic axis
_POINTS: Final = 200  #: of the curve that the theory gives


def power_figure(found: Sequence[Found]) -> Picture:
    """Return the figure.

    Parameters
    ----------
    found : sequence of Found
        What became of locked lines, by rising amplitude.
    """
    place_of = np.array([item.amplitude for item in found])
    share = np.array([item.power for item in found])
    ends = np.array([item.interval for item in found])
    amplitudes = np.geomspace(place_of[0], place_of[-1], _POINTS)
    theory = np.array([theoretical_power(float(amplitude)) for amplitude in amplitudes])
    with rc_context(RC):  # type: ignore[arg-type]
        figure = new_figure(_WIDTH, _HEIGHT)
        axes = place(figure, _LEFT, _BOTTOM, _WIDTH - _LEFT - _RIGHT, _HEIGHT - _BOTTOM - _TOP)
        axes.set_xscale("log")
        axes.plot(
            amplitudes,
            100.0 * theory,
            color=VERMILLION,
            linestyle="--",
            label="F test alone, Holm's level",
        )
        axes.errorbar(
            place_of,
            100.0 * share,
            yerr=100.0 * np.abs(ends.T - share),
            color=BLUE,
            marker="o",
            markersize=4.5,
            linestyle="none",
            capsize=3.0,
            label=f"called subharmonic, of {found[0].records} records (95 %)",
        )
        axes.set_xlim(place_of[0] / _MARGIN, place_of[-1] * _MARGIN)
        axes.set_ylim(-2.0, 103.0)
        axes.xaxis.set_major_locator(FixedLocator([float(amplitude) for amplitude in place_of]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.set_xlabel("Amplitude at half the drive frequency [standard errors]")
        axes.set_ylabel("Share of records [%]")
        legend_above(figure, axes, left=_LEFT)
        caption = "Share of locked half orders found against their amplitude, with 95 % binomial intervals."
        return picture(
            figure, caption, "Share found over amplitude, with the power of the F test as a curve."
        )
