"""The kinds of records without a subharmonic, and what may be said of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from reports.line_calibration.records import (
    Random,
    Record,
    autoregressive,
    clock_drift,
    free,
    hum,
    missing,
    noisy,
    one_over_f,
    ramps_left_in,
    swinging,
    wandering,
    white,
)
from tethertest.records.lines import LineVerdict

#: verdicts that withhold a judgement
WITHHELD: Final = frozenset({LineVerdict.NOT_RESOLVABLE, LineVerdict.UNDETERMINED})
NOTHING: Final = frozenset({LineVerdict.NONE})


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of record in which no order p/q is the drive's."""

    name: str
    make: Callable[[Random], Record]
    #: verdicts at order 1/2 that are right or harmless; None where any but a subharmonic will do
    right: frozenset[LineVerdict] | None = None
    #: least share of records in which no order p/q is called anything
    quiet: float | None = None
    #: the record itself cannot answer, and no demand can be made; shown so that nobody expects it to
    beyond: bool = False


KINDS: Final = (
    Kind("white", noisy(white), quiet=0.98),
    Kind("AR(1) 0.9", noisy(autoregressive), quiet=0.98),
    Kind("1/f", noisy(one_over_f)),
    Kind("ramps left in", ramps_left_in),
    Kind("clock drift 80 ppm", clock_drift),
    Kind("missing 5 %", missing),
    Kind("50 Hz hum", hum),
    Kind("free natural frequency", free(decays=False, stated=True), right=WITHHELD | NOTHING),
    Kind(
        "decaying natural frequency",
        free(decays=True, stated=True),
        right=WITHHELD | NOTHING | {LineVerdict.NATURAL_TRANSIENT},
    ),
    Kind("drive wanders 1 %", wandering(measured=False)),
    Kind("drive wanders 1 %, motion measured", wandering(measured=True)),
    Kind("drive swings 2 to 3 %", swinging),
    Kind("free natural frequency, not stated", free(decays=False, stated=False), beyond=True),
    Kind("decaying natural frequency, not stated", free(decays=True, stated=False)),
)
