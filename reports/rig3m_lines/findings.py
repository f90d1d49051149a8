"""What a check collects, the clock that it reads by, and the table that it prints."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import binom

from tethertest.bench.tables import markdown_table

CHANNELS = ("tension_top", "tension_bottom", "heave")
TENSIONS = CHANNELS[:2]
#: half width of a 95 % interval in standard errors
HALF_WIDTH = 1.959964
#: chance that intervals which hold 95 % fail the demand all the same
CHANCE = 0.01

Spans = list[tuple[float, float]]


@dataclass
class Complaints:
    """Demands that were not met."""

    texts: list[str] = field(default_factory=list)

    def demand(self, met: bool, text: str) -> None:
        """Note a demand that is not met."""
        if not met:
            self.texts.append(text)


class Clock:
    """The data logger's clock of one run, which is the run's."""

    def __init__(self, truth: dict[str, Any]) -> None:
        each = truth["clocks"]["each"]["daq"]
        self.offset, self.pace = each["offset_s"], 1.0 + each["drift_ppm"] * 1e-6

    def shows(self, time: float) -> float:
        """Return the reading at a true time."""
        return float(time * self.pace + self.offset)

    def true(self, reading: float) -> float:
        """Return the true time of a reading."""
        return float((reading - self.offset) / self.pace)


def allowed_misses(count: int) -> int:
    """Return how many of `count` intervals of 95 % may miss before it is no chance."""
    return int(binom.ppf(1.0 - CHANCE, count, 0.05))


def table(heads: str, rows: list[list[str]]) -> str:
    """Return a Markdown table; its heads stand between bars."""
    return markdown_table(heads.split("|"), ([cell.strip() for cell in row] for row in rows))


def median_and_worst(errors: np.ndarray, digits: int = 1) -> str:
    """Return the median error, and the largest in brackets."""
    if not errors.size:
        return "-"
    return f"{np.median(errors):+.{digits}f} ({np.abs(errors).max():.{digits}f})"
