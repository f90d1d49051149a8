"""Records as tables of pandas and as lines on axes of matplotlib, imported when they are asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy.typing as npt

from tethertest.records.arrays import FloatArray

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas as pd

Axes: TypeAlias = "matplotlib.axes.Axes"
#: time [s], values and name of one line
Curve: TypeAlias = tuple[npt.NDArray[Any], npt.NDArray[Any], str]


def series(time: FloatArray, values: FloatArray, name: str, unit: str) -> pd.Series[float]:
    """Return values over time [s], with the unit in ``attrs["unit"]``."""
    import pandas as pd

    made = pd.Series(values, pd.Index(time, name="time_s"), name=name)
    made.attrs["unit"] = unit
    return made


def table(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> pd.DataFrame:
    """Return rows as a table that has its columns even where there are no rows."""
    import pandas as pd

    return pd.DataFrame(list(rows), columns=list(columns))


def axes_or_new(axes: Axes | None) -> Axes:
    """Return the axes, or those of a new figure of pyplot."""
    if axes is not None:
        return axes
    from matplotlib import pyplot as plt

    return plt.subplots(layout="constrained")[1]


def drawn(
    axes: Axes | None, lines: Sequence[tuple[npt.NDArray[Any], npt.NDArray[Any], str]], label: str
) -> Axes:
    """Draw lines over time [s] and label the axes.

    Parameters
    ----------
    axes : Axes or None
        To draw on; those of a new figure where absent.
    lines : sequence of tuple
        Time, values and name of each.
    label : str
        What the values are, with their unit.
    """
    used = axes_or_new(axes)
    for time, values, name in lines:
        used.plot(time, values, label=name, linewidth=1.0)
    used.set_xlabel("time [s]")
    used.set_ylabel(label)
    if lines:
        used.legend()
    return used
